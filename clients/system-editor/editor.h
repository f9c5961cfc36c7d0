// What every command works with: the ORB, the name server, the form of output; and the commands themselves. One thread at a time.
#pragma once

#include <chrono>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "component_view.h"

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
  std::string problem_;
};

// Each prints what it did or found and reports failures through editor.fail().
struct ListOptions {
  std::string path;
  bool is_long = false;
  bool recurse = false;
};
void list(Editor& editor, const ListOptions& options);
void tree(Editor& editor, const std::string& path);
void cat(Editor& editor, const std::string& path, bool is_long);

enum class Transition { activate, deactivate, reset };
// `context` is an index into the component's contexts; -1: the first.
Result<void> change_state(const ComponentView& component, Transition transition, int context);
void change_state(Editor& editor, const std::vector<std::string>& paths, Transition transition, int context);
void exit_components(Editor& editor, const std::vector<std::string>& paths);
// Contexts that hold something living only with `force`.
void delete_bindings(Editor& editor, const std::vector<std::string>& paths, bool zombies, bool force);
void wait_for_state(Editor& editor, const std::vector<std::string>& paths, const std::string& state, double timeout_s);

// "" or what the component has said that a value of this parameter must be.
std::string value_problem(const ComponentView& component, const std::string& parameter, const std::string& value);

// Merges the values into the set; it is applied when the set is activated.
Result<void> set_values(const ComponentView& component, const std::string& id,
                        const std::vector<std::pair<std::string, std::string>>& values);
Result<void> use_set(const ComponentView& component, const std::string& id);

struct ConfigurationOptions {
  std::string path;
  std::string action = "list";  // list, get, set, use
  std::vector<std::string> arguments;
  std::string set;     // empty: the active one
  bool all = false;    // hidden sets too
  bool force = false;  // also what the component's own types and constraints forbid
};
void configure(Editor& editor, const ConfigurationOptions& options);

// Connects ports in the given order; the first starts. Empty id: the runtime makes one. The error says what does not fit.
Result<void> connect_ports(const std::vector<const PortView*>& ports, const std::string& id, const std::string& name,
                           const Properties& properties);
Result<void> disconnect_connector(const PortView& port, const std::string& id);

struct ConnectOptions {
  std::vector<std::string> ports;
  std::string id;
  std::string name;
  std::vector<std::string> properties;  // key=value
  bool no_duplicates = false;
};
void connect(Editor& editor, const ConnectOptions& options);
void disconnect(Editor& editor, const std::vector<std::string>& paths, const std::string& id);

struct PrintOptions {
  std::vector<std::string> ports;
  int count = 0;         // 0: until stopped
  double timeout_s = 0;  // 0: none
  double rate = 0;       // at most so many lines a second; 0: all
};
void print_ports(Editor& editor, const PrintOptions& options);
struct InjectOptions {
  std::string port;
  std::vector<std::string> values;
  double rate = 1;  // of repeated values [Hz]
  int count = 1;    // how often the values are sent
};
void inject(Editor& editor, const InjectOptions& options);

struct SaveOptions {
  std::string file = "-";
  std::string name = "RTSystem";
  std::string vendor = "Me";
  std::string version = "0";
  std::string abstract;
  bool yaml = false;
};
void save(Editor& editor, const SaveOptions& options);
struct LoadOptions {
  std::string file;
  bool dry_run = false;
  bool with_states = false;
  bool force = false;  // also values that the components' own types and constraints forbid
};
void load(Editor& editor, const LoadOptions& options);
void start(Editor& editor, const std::string& file, bool dry_run);
void stop(Editor& editor, const std::string& file, bool dry_run);
void teardown(Editor& editor, const std::string& file, bool dry_run);
// State: that of every component; "any": not compared; "saved": as the file says.
void check_system(Editor& editor, const std::string& file, const std::string& state);

struct ManagerOptions {
  std::string manager;  // path or corbaloc:: address; empty: the only manager of the name server
  std::string action;   // create, delete, load, unload, list
  std::vector<std::string> arguments;
};
void manage(Editor& editor, const ManagerOptions& options);
void watch(Editor& editor, const std::string& path);

}  // namespace editor
