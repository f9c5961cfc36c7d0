// The entries of a name server, read in parallel. A process that hangs or has exited is shown as such and delays no other entry. Snapshot
// values; any thread.
#pragma once

#include <chrono>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "rtm/idl/ManagerStub.h"
#include "system/address.h"
#include "system/remote.h"

namespace tools {

enum class EntryKind { context, component, manager, other };
enum class Health { alive, hung, zombie };  // zombie: bound, but the object or its process is gone

struct Entry {
  EntryKind kind = EntryKind::other;
  Health health = Health::alive;
  std::string id;
  std::string kind_text;              // "rtc", "mgr", "host_cxt", ...
  std::vector<std::string> segments;  // from the name server on, escaped
  std::string problem;                // why it is not alive
  CORBA::Object_var object;
  std::vector<Entry> children;

  std::string path() const;  // "/localhost/a.host_cxt/B0.rtc"
  std::string name() const;  // "B0.rtc"
};

// What a tree is read for; neither: for all that there is. All names are listed, but no more objects are resolved and asked for their
// health than those that are meant: others cost next to nothing, also when they hang.
struct Wanted {
  const Address* address = nullptr;
  const std::set<std::string>* ids = nullptr;  // of names, in any place; others are left out
};

class NamingTree {
 public:
  // `server` as HOST or HOST:PORT. Fails when it cannot be reached or is no naming service.
  static Result<NamingTree> read(CORBA::ORB_ptr orb, const std::string& server, std::chrono::milliseconds limit, const Wanted& wanted = {});

  const Entry& root() const { return root_; }
  const std::string& server() const { return root_.segments.front(); }
  // Every component, manager or other object, depth first.
  std::vector<const Entry*> objects() const;
  // The one thing that the address names; the error lists what comes near.
  Result<const Entry*> find(const Address& address) const;
  Result<const Entry*> find_component(const Address& address) const;
  // All that it may name, alive or not. Fails when it is on another name server.
  Result<std::vector<const Entry*>> candidates(const Address& address) const;

 private:
  Entry root_;
};

// Removes a binding; the object need not answer.
Result<void> unbind(CORBA::ORB_ptr orb, const Entry& entry);

}  // namespace tools
