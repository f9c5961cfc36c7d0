// Listens on the ports whose values are to be judged. One thread at a time; samples come in the ORB's threads.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "base/guarded.h"
#include "run/expectations.h"
#include "system/session.h"
#include "system/tap.h"

namespace tools {

class PortValues {
 public:
  // `expectations` must live until end(). Others than those of values are left alone, and values that are listened to already. One with an
  // empty member is about all numbers of a sample.
  Result<void> listen(CORBA::ORB_ptr orb, const Session& session, const std::vector<Expectation>& expectations);
  // Processes of these components were killed: what they sent last is no value of their ports any more.
  void forget(const std::set<std::string>& instances);
  // They are there again.
  Result<void> listen_again(CORBA::ORB_ptr orb, const Session& session, const std::set<std::string>& instances);
  // What was seen so far of a port's member; nothing when no sample came, or none since its component was killed.
  std::optional<SeenValue> so_far(const std::string& port, const std::string& member) const;
  // What was seen, by "port member". Listens no more.
  std::map<std::string, SeenValue> end();

 private:
  struct Listening {
    const Expectation* expectation;
    std::string instance;  // of the component
    std::unique_ptr<Tap> tap;
  };
  Result<Listening> attach(CORBA::ORB_ptr orb, const Session& session, const Expectation& expectation);
  void take(CORBA::TypeCode_ptr type, const Expectation& expectation, const std::vector<std::string>& path,
            std::span<const unsigned char> payload, bool little);

  struct Collected {
    std::map<std::string, SeenValue> values;                        // by "port member"
    std::map<std::string, std::vector<const Expectation*>> limits;  // on them
  };
  base::Guarded<Collected, base::Rank::samples> seen_;
  std::vector<Listening> listening_;
};

}  // namespace tools
