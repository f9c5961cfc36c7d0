#include "studio/services.h"

#include <array>

#include "base/text.h"

namespace studio {
namespace {

using base::Error;
using base::Result;

struct Row {
  std::string_view act;
  std::string_view arguments;  // NAME:TYPE, required with "!" in front; TYPE is a JSON type, or how many numbers
};

// The number of a service is its place in this list, from 1.
constexpr std::array rows{
    Row{"run", ""},
    Row{"pause", ""},
    Row{"step", "steps:number participant:string paced:boolean"},
    Row{"reset_world", "poses_only:boolean"},
    Row{"speed", "!rtf:number"},
    Row{"tree", "model:string"},
    Row{"models", ""},
    Row{"contacts", "!model:string"},
    Row{"set_pose", "!model:string planar:3 pose:7"},
    Row{"push", "!name:string !force:3 torque:3 seconds:number"},
    Row{"set_velocity", "!model:string !linear:3 !angular:3"},
    Row{"spawn", "model:string sdf:string name:string pose:7"},
    Row{"delete_model", "!model:string"},
    Row{"restore_model", "!model:string"},
    Row{"drop_participant", "!name:string"},
    Row{"reset_odometry", "!iface:string"},
    Row{"set_motors", "!iface:string !on:boolean"},
};

Json json_type(const std::string& type) {
  const auto count = base::parse_integer(type);
  if (!count) return {{"type", type}};
  return {{"type", "array"}, {"items", {{"type", "number"}}}, {"minItems", *count}, {"maxItems", *count}};
}

Json schema_of(const Row& row) {
  Json properties = Json::object(), required = Json::array();
  for (const auto& word : base::split_list(std::string(row.arguments), ' ')) {
    const bool is_required = word.starts_with('!');
    const auto colon = word.find(':');
    const auto name = word.substr(is_required ? 1 : 0, colon - (is_required ? 1 : 0));
    properties[name] = json_type(word.substr(colon + 1));
    if (is_required) required.push_back(name);
  }
  return {{"type", "object"}, {"properties", properties}, {"required", required}};
}

Json side_of(const std::string& name, const Json& schema) {
  return {{"encoding", "json"}, {"schemaName", name}, {"schemaEncoding", "jsonschema"}, {"schema", to_text(schema)}};
}

}  // namespace

std::string advertise_services(bool may_act) {
  Json services = Json::array();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Act* act = find_act(rows[i].act);
    if (act == nullptr || (!may_act && !act->is_reading)) continue;
    const std::string name(rows[i].act), type = "rtmsim/" + name;
    const Json schema = schema_of(rows[i]);
    // requestSchema and responseSchema are for clients of before `request` and `response`.
    services.push_back({{"id", i + 1},
                        {"name", "/simulator/" + name},
                        {"type", type},
                        {"requestSchema", to_text(schema)},
                        {"responseSchema", R"({"type":"object"})"},
                        {"request", side_of(type + "_Request", schema)},
                        {"response", side_of(type + "_Response", {{"type", "object"}})}});
  }
  return to_text({{"op", "advertiseServices"}, {"services", services}});
}

std::optional<Service> find_service(std::uint32_t id) {
  if (id < 1 || id > rows.size()) return std::nullopt;
  return Service{std::string(rows[id - 1].act), find_act(rows[id - 1].act)};
}

Result<Json> arguments_of(const ServiceCall& call) {
  if (call.encoding != "json") return Error{"encoding " + base::in_quotes(call.encoding) + ": expected json"};
  if (base::trim(call.payload).empty()) return Json::object();
  if (!is_flat_enough(call.payload)) return Error{"request: its brackets are more than 24 deep"};
  Json args = Json::parse(call.payload, nullptr, false);
  if (!args.is_object()) return Error{"request: expected a JSON object"};
  return args;
}

}  // namespace studio
