// A saved system: RTSProfile version 0.2, the format of RTSystemEditor and rtshell, as values; read and written as XML and YAML. Any
// thread. Attributes that we do not use survive only where a field below holds them.
//
// The format has no place for states: each is kept as a property `state` of its execution context.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "base/result.h"
#include "system/parameter_check.h"

namespace tools {

// The format has no place for states: they are kept as a property of the execution context, which other readers leave alone.
inline constexpr const char* state_property = "state";

using NamedValues = std::vector<std::pair<std::string, std::string>>;

struct SavedPort {
  std::string name;  // without the instance prefix
};

struct SavedConfigurationSet {
  std::string id;
  NamedValues values;

  bool is_hidden() const { return is_hidden_set(id); }
};

struct SavedContext {
  std::string id = "0";
  std::string kind = "PERIODIC";
  std::string rate = "1000.0";
  std::string state;  // Active, Inactive, Error: the component's when it was saved; empty: not known
};

// Where RTSystemEditor draws a component: its upper left corner and its size, in the pixels of the diagram. All zero: nobody has placed it.
struct SavedPlace {
  int x = 0, y = 0, width = 0, height = 0;
  std::string direction = "down";  // of its ports: right, left, up, down

  // What a file says of a coordinate; what is no whole number is 0.
  static int pixels(const std::string& text);
  bool is_placed() const { return x != 0 || y != 0 || width != 0 || height != 0; }
};

struct SavedComponent {
  std::string id;        // RTC:vendor:category:type:version
  std::string path_uri;  // "host/ctx.host_cxt/Name0.rtc"
  std::string active_set;
  std::string instance;
  std::string composite_type = "None";
  bool is_required = true;
  std::vector<SavedPort> data_ports;
  std::vector<SavedPort> service_ports;
  std::vector<SavedConfigurationSet> configuration_sets;
  std::vector<SavedContext> contexts;
  std::vector<std::string> participants;  // instance names
  SavedPlace place;
  NamedValues properties;
};

struct SavedTarget {
  std::string component_id;
  std::string instance;
  std::string port_name;  // "Name0.port"
  std::string path_uri;   // COMPONENT_PATH_ID
};

struct SavedConnector {
  bool is_data = true;
  std::string id;
  std::string name;
  std::string data_type;
  std::string interface_type;
  std::string dataflow_type;
  std::string subscription_type;
  SavedTarget source;
  SavedTarget target;
  NamedValues properties;

  // A port with a topic is at both ends, since the format wants two.
  bool has_one_port() const { return source.instance == target.instance && source.port_name == target.port_name; }
};

// One entry of a StartUp, Activation, ... list: a component to send to, in the order of `sequence`.
struct SavedTurn {
  std::string instance;
  std::string path_uri;
  std::string component_id;
  std::string context_id = "0";
  int sequence = 0;
};

struct SavedSystem {
  std::string id;  // RTSystem:vendor:name:version
  std::string abstract;
  std::string creation_date;
  std::string update_date;
  std::vector<SavedComponent> components;
  std::vector<SavedConnector> connectors;
  std::vector<SavedTurn> start_up;
  std::vector<SavedTurn> shut_down;

  const SavedComponent* component(const std::string& instance) const;
};

base::Result<SavedSystem> parse_xml(const std::string& text, const std::string& file);
std::string to_xml(const SavedSystem& system);
base::Result<SavedSystem> parse_yaml(const std::string& text, const std::string& file);
std::string to_yaml(const SavedSystem& system);

// XML or YAML by content. "-" is standard input. Files above 64 MiB are rejected.
base::Result<SavedSystem> read_system(const std::string& file);
// By the ending: .yaml and .yml YAML, anything else XML. Written whole or not at all.
base::Result<void> write_system(const SavedSystem& system, const std::string& file);

}  // namespace tools
