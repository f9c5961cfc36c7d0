// What every command works with: the ORB, the name server, the form of output. One thread at a time.
#pragma once

#include <chrono>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "system/component_view.h"

namespace editor {

// Prints errors as "rtse: ..." and remembers that there was one.
class Editor {
 public:
  Editor(CORBA::ORB_ptr orb, std::string server, bool json, std::chrono::milliseconds limit);

  CORBA::ORB_ptr orb() const { return orb_; }
  const std::string& server() const { return server_; }
  bool json() const { return json_; }
  // How long one call to another process may take.
  std::chrono::milliseconds limit() const { return limit_; }

  // Reads the name server that `path` speaks of: its own for absolute paths, else the default.
  // With `only`, what the path cannot mean is listed and not asked whether it lives.
  Result<NamingTree> tree(const std::string& path = "", bool only = false) const;
  Result<ComponentView> component(const std::string& path, Detail detail) const;
  struct Port {
    ComponentView component;
    PortView port;
  };
  Result<Port> port(const std::string& path, bool with_connectors = false) const;

  void fail(const Error& error);
  // For what is told in another way than by a line on standard error.
  void set_failed() { failed_ = true; }
  // Whoever uses it tells its problem: fail() says nothing from now on.
  void be_silent() { is_silent_ = true; }
  bool failed() const { return failed_; }
  // What was said first.
  const std::string& problem() const { return problem_; }
  void print(const nlohmann::ordered_json& value) const;

 private:
  CORBA::ORB_var orb_;
  std::string server_;
  bool json_;
  std::chrono::milliseconds limit_;
  bool failed_ = false;
  bool is_silent_ = false;
  std::string problem_;
};

}  // namespace editor
