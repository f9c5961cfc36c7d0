// Names in CORBA name servers: their text form, look-ups with a timeout, and Bindings, which keeps objects bound. Any thread.
#pragma once

#include <omniORB4/CORBA.h>

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace corba {

// `id.kind/id.kind`: a backslash before /, . and \ makes them part of an id or kind; without a dot the kind is empty, the last dot counts.
base::Result<CosNaming::Name> parse_name(std::string_view text);
std::string to_text(const CosNaming::Name& name);

// "host", "host:port", "" (localhost) or a corbaloc/IOR text as the text that string_to_object takes; the port is 2809 if missing.
std::string naming_url(std::string_view address);

// The root context; fails with one line if it does not answer in time. Every call through the reference has the time-out.
base::Result<CosNaming::NamingContext_var> root_context(CORBA::ORB_ptr orb, std::string_view address, std::chrono::milliseconds timeout);

// Makes the contexts in front of the last component of the name where they are missing and (re)binds the object. CosNaming and system
// exceptions pass. Contexts that were made are appended to `made`.
void rebind_recursive(CosNaming::NamingContext_ptr root, const CosNaming::Name& name, CORBA::Object_ptr object,
                      std::vector<CosNaming::Name>* made = nullptr);

// What a walk through contexts has entered: anybody may bind them in circles, or so often that the paths through a few are beyond number.
class ContextWalk {
 public:
  // The stay in a context. None when it is one of those around it, when it would be the 21st, or when ten thousand have been entered.
  class Stay {
   public:
    Stay(ContextWalk& walk, CosNaming::NamingContext_ptr context);
    ~Stay();
    Stay(const Stay&) = delete;
    Stay& operator=(const Stay&) = delete;
    explicit operator bool() const { return walk_ != nullptr; }

   private:
    ContextWalk* walk_ = nullptr;
  };

 private:
  std::vector<CosNaming::NamingContext_var> around_;
  std::size_t entered_ = 0;
};

// Every name below the context whose last component fits; at most `max_names`. CosNaming and system exceptions pass.
std::vector<CosNaming::Name> find_names(CosNaming::NamingContext_ptr root, const std::function<bool(const CosNaming::NameComponent&)>& fits,
                                        std::size_t max_names = 10'000);

struct BindingsSettings {
  std::chrono::milliseconds interval{10'000};     // every binding is looked after this often; also the pause between attempts; 0: never
  std::chrono::milliseconds call_timeout{1'000};  // of every call to a naming service
  bool always_rebind = false;                     // even when an entry is in order
  // The reference to bind on the service of that address instead of the object's own; none: its own. Called on the service's thread.
  std::function<CORBA::Object_ptr(CORBA::Object_ptr, const std::string& address)> present{};
};

// Keeps objects bound in any number of naming services, each looked after by a thread of its own: entries come back when a service was away
// or lost them; what another living object has taken over is left alone with a warning; entries of dead objects are replaced.
class Bindings {
 public:
  Bindings(CORBA::ORB_ptr orb, const BindingsSettings& settings);
  // Stops at once; unbind_all() first to take the entries out.
  ~Bindings();
  Bindings(const Bindings&) = delete;
  Bindings& operator=(const Bindings&) = delete;

  void add_server(const std::string& address);
  std::vector<std::string> servers() const;

  // Returns when every service that answers has the entry, at the latest after twice the call time-out. A name that is no name is logged.
  // `yields`: a name that belongs to somebody else who lives is left to them, quietly, until it is free.
  void bind(const std::string& name, CORBA::Object_ptr object, bool yields = false);
  // Takes the entry out where it still is ours; returns as bind does.
  void unbind(const std::string& name);
  // As unbind for every name; also removes the contexts made for them when they are empty.
  void unbind_all();
  // Looks after everything now; does not wait.
  void refresh();

 private:
  class Server;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace corba
