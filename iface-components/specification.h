// The specification of a device component. A type adds its own rows to the common ones here. Any thread.
#pragma once

#include <coil/Properties.h>
#include <rtm/Manager.h>

#include <string>
#include <vector>

namespace iface {

inline constexpr int highest_server = 9999;

// The simulator that is meant when nobody names one: RTMSIM_SERVER_ID, as for the simulator and its tools, else 0. A value that is none is
// said once and counts as 0.
int default_server();

// In a tick of simulated time: sensors come first, what commands the robot after those who decide.
inline constexpr int sensor_phase = 0;
inline constexpr int command_phase = 2;

// One parameter of the configuration; texts as tools read and show them.
struct Parameter {
  const char* name;
  const char* value;  // in conf.default
  const char* type;
  const char* widget;
  const char* constraint = "";  // empty: every value of the type will do
};

struct Specification {
  const char* type_name;
  const char* description;
  int phase = sensor_phase;
  const char* device = "";              // the default of device_id; empty: there is no device_id
  std::vector<Parameter> parameters{};  // beside server_id and device_id
  int inport_buffer = 0;                // samples that each InPort keeps; 0: the usual number

  // The default of a parameter of these.
  const char* value_of(const std::string& name) const;
};

// As a manager takes it; conf.default.server_id is default_server().
coil::Properties properties_of(const Specification& specification);
// The same of a type with rows unlike those of the others.
coil::Properties specification(const char* const spec[]);

template <class Component>
void register_type(RTC::Manager* manager, const Specification& specification) {
  coil::Properties profile = properties_of(specification);
  manager->registerFactory(profile, RTC::Create<Component>, RTC::Delete<Component>);
}

}  // namespace iface
