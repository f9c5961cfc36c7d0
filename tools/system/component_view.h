// One component as its process describes it: profile, ports, connections, contexts, configuration. A snapshot of values and references; any
// thread.
#pragma once

#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "system/naming_tree.h"
#include "system/parameter_check.h"

namespace tools {

struct ConnectorView {
  std::string id;
  std::string name;
  Properties properties;
  RTC::PortServiceList ports;
};

struct InterfaceView {
  std::string instance;
  std::string type;
  bool is_provided = true;
};

struct PortView {
  std::string name;       // without the instance prefix
  std::string full_name;  // as the profile has it
  Properties properties;
  std::vector<InterfaceView> interfaces;
  std::vector<ConnectorView> connectors;
  RTC::PortService_var object;

  std::string port_type() const { return property(properties, "port.port_type"); }  // DataInPort, DataOutPort, CorbaPort
  std::string data_type() const { return property(properties, "dataport.data_type"); }
  bool is_data_port() const { return port_type() == "DataInPort" || port_type() == "DataOutPort"; }
};

struct ContextView {
  RTC::ExecutionContextHandle_t handle = 0;
  bool is_owned = true;
  RTC::ExecutionKind kind = RTC::PERIODIC;
  double rate = 0;  // [Hz]
  bool is_running = false;
  RTC::LifeCycleState state = RTC::CREATED_STATE;
  Properties properties;
  RTC::ExecutionContext_var object;
  std::string problem;  // its process does not answer, and why; only the handle is known then

  bool is_gone() const { return !problem.empty(); }
};

struct ConfigurationSetView {
  std::string id;
  std::vector<std::pair<std::string, std::string>> values;  // in the component's order

  bool is_hidden() const { return is_hidden_set(id); }
};

// What to ask for besides the profile; each costs calls.
struct Detail {
  bool contexts = false;
  bool connectors = false;  // they come with the profile of most runtimes; asked for when it has none
  bool configuration = false;
  bool members = false;
};

struct ComponentView {
  std::string path;  // in the naming service
  std::vector<std::string> segments;
  std::string instance;
  std::string type;
  std::string category;
  std::string vendor;
  std::string version;
  std::string description;
  Properties properties;
  std::vector<PortView> ports;
  std::vector<ContextView> contexts;
  std::vector<ConfigurationSetView> configuration_sets;
  std::string active_set;            // empty: none is active
  std::vector<std::string> members;  // instance names; of a composite component
  RTC::RTObject_var object;
  std::string problem;  // it could not be read, and why

  std::string profile_id() const { return "RTC:" + vendor + ":" + category + ":" + type + ":" + version; }
  // What is meant when nobody names a context: one on simulated time that another process runs for it, else the first that runs, else
  // the first; nullptr when there is none.
  const ContextView* shown_context() const;
  // In that context.
  RTC::LifeCycleState state() const;
  const PortView* port(const std::string& name) const;
};

// Reads one component. Never throws; what went wrong is in `problem`.
ComponentView read_component(const Entry& entry, Detail detail);
// All components of the tree in parallel; dead ones and hung ones come with their problem.
std::vector<ComponentView> read_components(const NamingTree& tree, Detail detail, std::chrono::milliseconds limit);

// The component and port that own a port reference, among those read; nullptr when it is none of them.
struct PortOwner {
  const ComponentView* component = nullptr;
  const PortView* port = nullptr;
};
PortOwner owner_of(RTC::PortService_ptr port, const std::vector<ComponentView>& components);
// The same for many ports. The components must live as long.
class PortIndex {
 public:
  explicit PortIndex(const std::vector<ComponentView>& components);
  PortOwner owner_of(RTC::PortService_ptr port) const;

 private:
  std::unordered_multimap<CORBA::ULong, PortOwner> owners_;  // by the hash of the reference
};
// Whose a port is that none of them has, in words; it is asked whether it lives.
std::string absent_port(RTC::PortService_ptr port);

}  // namespace tools
