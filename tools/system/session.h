// Connection of a tool to a running system: the ORB, the name server, and how long calls may take. A value; one thread at a time.
#pragma once

#include <chrono>
#include <string>

#include "system/component_view.h"
#include "system/transitions.h"

namespace tools {

class Session {
 public:
  // `call_timeout`: of one call to another process. `transition_timeout`: of a state transition, which lasts as long as the component's
  // callback; see change_state().
  Session(CORBA::ORB_ptr orb, std::string server, std::chrono::milliseconds call_timeout,
          std::chrono::milliseconds transition_timeout = default_transition_timeout);

  // Nil for commands that need no ORB.
  CORBA::ORB_ptr orb() const { return orb_; }
  const std::string& server() const { return server_; }
  std::chrono::milliseconds call_timeout() const { return call_timeout_; }
  std::chrono::milliseconds transition_timeout() const { return transition_timeout_; }

  // Reads the name server that `path` speaks of: its own for absolute paths, else the default.
  // With `only`, what the path cannot mean is listed and not asked whether it lives.
  Result<NamingTree> tree(const std::string& path = "", bool only = false) const;
  // The components at the other ends of its connections, and perhaps more: to say their names. `path`: of the component.
  Result<std::vector<ComponentView>> peers_of(const ComponentView& component, const std::string& path) const;
  Result<ComponentView> component(const std::string& path, Detail detail) const;
  // Of each of these, in their order. One look at the name server is enough for those on the session's own.
  std::vector<Result<ComponentView>> components(const std::vector<std::string>& paths, Detail detail) const;
  struct Port {
    ComponentView component;
    PortView port;
  };
  Result<Port> port(const std::string& path, bool with_connectors = false) const;

 private:
  CORBA::ORB_var orb_;
  std::string server_;
  std::chrono::milliseconds call_timeout_;
  std::chrono::milliseconds transition_timeout_;
};

}  // namespace tools
