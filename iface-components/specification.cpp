#include "specification.h"

#include <base/log.h>
#include <base/text.h>

#include <cassert>
#include <cstdlib>

namespace iface {
namespace {

int read_server() {
  const char* text = std::getenv("RTMSIM_SERVER_ID");
  if (!text || !*text) return 0;
  const auto number = base::parse_integer(text);
  if (number && *number >= 0 && *number <= highest_server) return static_cast<int>(*number);
  base::log(base::Level::warn, "simulator", "RTMSIM_SERVER_ID must be a number from 0 to {}, got {}", highest_server,
            base::in_quotes(text));
  return 0;
}

}  // namespace

int default_server() {
  static const int server = read_server();
  return server;
}

const char* Specification::value_of(const std::string& name) const {
  for (const auto& parameter : parameters) {
    if (parameter.name == name) return parameter.value;
  }
  assert(!"a parameter of the specification");
  return "";
}

coil::Properties properties_of(const Specification& specification) {
  const auto server = std::to_string(default_server()), range = "0<=x<=" + std::to_string(highest_server);
  std::vector<Parameter> parameters = {{"server_id", server.c_str(), "int", "spin", range.c_str()}};
  if (*specification.device) parameters.push_back({"device_id", specification.device, "string", "text"});
  if (*specification.device) parameters.push_back({"port_names", "", "string", "text"});
  parameters.insert(parameters.end(), specification.parameters.begin(), specification.parameters.end());

  coil::Properties properties;
  properties["implementation_id"] = specification.type_name;
  properties["type_name"] = specification.type_name;
  properties["description"] = specification.description;
  properties["version"] = "1.0.0";
  properties["vendor"] = "rtm-sim";
  properties["category"] = "simulation";
  properties["activity_type"] = "PERIODIC";
  properties["kind"] = "DataFlowComponent";
  properties["max_instance"] = "0";
  properties["language"] = "C++";
  properties["lang_type"] = "compile";
  properties["exec_cxt.periodic.rate"] = "1000";
  properties["exec_cxt.sim_time.phase"] = std::to_string(specification.phase);
  if (specification.inport_buffer > 0) properties["port.inport.dataport.buffer.length"] = std::to_string(specification.inport_buffer);
  for (const auto& parameter : parameters) properties[std::string("conf.default.") + parameter.name] = parameter.value;
  for (const auto& parameter : parameters) properties[std::string("conf.__type__.") + parameter.name] = parameter.type;
  for (const auto& parameter : parameters) properties[std::string("conf.__widget__.") + parameter.name] = parameter.widget;
  for (const auto& parameter : parameters) {
    if (*parameter.constraint) properties[std::string("conf.__constraints__.") + parameter.name] = parameter.constraint;
  }
  return properties;
}

coil::Properties specification(const char* const spec[]) {
  coil::Properties properties(spec);
  properties["conf.default.server_id"] = std::to_string(default_server());
  return properties;
}

}  // namespace iface
