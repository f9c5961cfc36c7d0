#include "rtse/skeleton/specification.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <filesystem>
#include <pugixml.hpp>
#include <set>

#include "base/plain_file.h"
#include "base/text.h"
#include "base/yaml_keys.h"

namespace tools {
namespace {

using base::Error;
using base::Result;

std::string_view local_part(std::string_view name) {
  const auto colon = name.find(':');
  return colon == std::string_view::npos ? name : name.substr(colon + 1);
}

// xsi:type says what kind of element it is, not what type a port has.
std::string attribute(const pugi::xml_node& node, std::string_view name, const std::string& otherwise = "") {
  for (const auto& candidate : node.attributes()) {
    if (local_part(candidate.name()) == name && !std::string_view(candidate.name()).starts_with("xsi:")) return candidate.value();
  }
  return otherwise;
}

// Files that a specification names are relative to its own folder.
std::string beside(const std::string& specification, const std::string& file) {
  if (file.empty() || std::filesystem::path(file).is_absolute()) return file;
  return (std::filesystem::path(specification).parent_path() / file).string();
}

// The same for RTC.xml, which may come from another system and another machine: back-slashes part folders, and a file that is not where it
// is said to be may lie beside the specification or in its folder idl.
std::string idl_beside(const std::string& specification, std::string file) {
  std::ranges::replace(file, '\\', '/');
  const auto as_said = beside(specification, file);
  const auto name = std::filesystem::path(file).filename();
  const auto folder = std::filesystem::path(specification).parent_path();
  for (const auto& candidate : {std::filesystem::path(as_said), folder / name, folder / "idl" / name}) {
    std::error_code error;
    if (std::filesystem::is_regular_file(candidate, error)) return candidate.string();
  }
  return as_said;
}

NewService service_of(const std::string& port, const pugi::xml_node& interface, const std::string& specification) {
  NewService service;
  service.port = port;
  service.interface = attribute(interface, "type");
  service.instance = attribute(interface, "instanceName", attribute(interface, "name"));
  service.is_provided = attribute(interface, "direction") == "Provided";
  service.idl_file = idl_beside(specification, attribute(interface, "idlFile"));
  return service;
}

// An interface without instance name has that of its port, as in RTCBuilder; a second one in the port that of its type.
void add_service(NewComponent& component, const std::string& port, const pugi::xml_node& interface, const std::string& specification) {
  auto service = service_of(port, interface, specification);
  const auto is_taken = [&](const std::string& name) {
    return std::ranges::any_of(component.services, [&](const NewService& other) { return other.instance == name; });
  };
  if (service.instance.empty()) service.instance = is_taken(port) ? service.interface.substr(service.interface.rfind(':') + 1) : port;
  component.services.push_back(std::move(service));
}

NewParameter parameter_of(const pugi::xml_node& node) {
  NewParameter parameter{attribute(node, "name"), attribute(node, "type", "double"), attribute(node, "defaultValue")};
  for (const auto& property : node.children()) {
    if (local_part(property.name()) == "Properties" && attribute(property, "name") == "__widget__")
      parameter.widget = attribute(property, "value", parameter.widget);
  }
  return parameter;
}

// "OnReset" with implemented="true" -> onReset, for the callbacks that are not always written.
void add_actions(NewComponent& component, const pugi::xml_node& actions) {
  for (const auto& node : actions.children()) {
    auto name = std::string(local_part(node.name()));
    if (name.empty()) continue;
    name.front() = 'o';
    const bool is_further = std::ranges::find(further_actions(), name) != further_actions().end();
    if (is_further && attribute(node, "implemented") == "true") add_once(component.actions, name);
  }
}

void add_data_port(NewComponent& component, const pugi::xml_node& node, const std::string& specification) {
  auto& ports = attribute(node, "portType") == "DataInPort" ? component.in_ports : component.out_ports;
  ports.push_back({attribute(node, "name"), full_type(attribute(node, "type"))});
  // The files of the product's own types are named by paths of the machine where RTCBuilder ran.
  const auto idl = attribute(node, "idlFile");
  if (!idl.empty() && !is_product_type(ports.back().type)) add_once(component.idl_files, idl_beside(specification, idl));
}

Result<NewComponent> read_rtc_xml(const std::string& file) {
  pugi::xml_document document;
  if (const auto parsed = document.load_file(file.c_str()); !parsed)
    return Error{"file " + base::in_quotes(file) + ": is no XML: " + parsed.description()};
  const auto root = document.document_element();
  if (local_part(root.name()) != "RtcProfile") return Error{"file " + base::in_quotes(file) + ": holds no RtcProfile element"};
  NewComponent component;
  for (const auto& node : root.children()) {
    const auto kind = local_part(node.name());
    if (kind == "BasicInfo") {
      component.name = attribute(node, "name");
      component.description = attribute(node, "description", component.description);
      component.version = attribute(node, "version", component.version);
      component.vendor = attribute(node, "vendor", component.vendor);
      component.category = attribute(node, "category", component.category);
      // 0 and nothing mean "the usual one" to RTCBuilder.
      const std::string rate = attribute(node, "executionRate", "0");
      const auto number = base::parse_number(rate.empty() ? "0" : rate);
      component.rate = !number ? 0 : *number == 0 ? NewComponent().rate : *number;
    } else if (kind == "Actions") {
      add_actions(component, node);
    } else if (kind == "DataPorts") {
      add_data_port(component, node, file);
    } else if (kind == "ServicePorts") {
      for (const auto& interface : node.children()) {
        if (local_part(interface.name()) == "ServiceInterface") add_service(component, attribute(node, "name"), interface, file);
      }
    } else if (kind == "ConfigurationSet") {
      for (const auto& parameter : node.children()) {
        if (local_part(parameter.name()) == "Configuration") component.parameters.push_back(parameter_of(parameter));
      }
    }
  }
  return component;
}

// Reads a specification in YAML. What is not understood is remembered with its line; the first one counts.
class YamlReader {
 public:
  explicit YamlReader(std::string file) : file_(std::move(file)) {}

  Result<NewComponent> read() {
    const auto root = yaml::load_file(file_);
    only(root, {"name", "description", "version", "vendor", "category", "rate", "in_ports", "out_ports", "parameters", "services",
                "idl_files", "actions"});
    NewComponent component;
    if (!problem_.empty()) return Error{problem_};
    component.name = text(root, "name");
    component.description = text(root, "description", component.description);
    component.version = text(root, "version", component.version);
    component.vendor = text(root, "vendor", component.vendor);
    component.category = text(root, "category", component.category);
    const auto rate = base::parse_number(text(root, "rate", "100"));
    if (!rate) say(root["rate"], "rate must be a number [Hz]");
    component.rate = rate.value_or(0);
    for (const auto& node : list(root, "in_ports")) component.in_ports.push_back(port(node));
    for (const auto& node : list(root, "out_ports")) component.out_ports.push_back(port(node));
    for (const auto& node : list(root, "parameters")) component.parameters.push_back(parameter(node));
    for (const auto& node : list(root, "services")) component.services.push_back(service(node));
    for (const auto& node : list(root, "idl_files")) component.idl_files.push_back(beside(file_, scalar(node, "an IDL file")));
    for (const auto& node : list(root, "actions")) component.actions.push_back(scalar(node, "the name of a callback"));
    if (!problem_.empty()) return Error{problem_};
    return component;
  }

 private:
  void say(const YAML::Node& node, const std::string& what) {
    if (problem_.empty()) problem_ = "file " + base::in_quotes(file_) + ":" + std::to_string(node.Mark().line + 1) + ": " + what;
  }
  // A map with no other keys.
  bool only(const YAML::Node& node, const std::set<std::string>& known) {
    if (!node.IsMap()) {
      say(node, "must be a map with " + base::join({known.begin(), known.end()}, ", "));
      return false;
    }
    for (const auto& entry : node) {
      const auto key = entry.first.IsScalar() ? entry.first.Scalar() : std::string();
      if (!known.contains(key))
        say(entry.first, "unknown key " + base::in_quotes(key) + ", expected one of " + base::join({known.begin(), known.end()}, ", "));
    }
    return true;
  }
  std::string scalar(const YAML::Node& node, const std::string& what) {
    if (node.IsScalar()) return node.Scalar();
    say(node, "must be " + what);
    return "";
  }
  std::string text(const YAML::Node& node, const char* key, const std::string& otherwise = "") {
    const auto value = node[key];
    return value && !value.IsNull() ? scalar(value, std::string(key) + ": a text or a number") : otherwise;
  }
  std::vector<YAML::Node> list(const YAML::Node& root, const char* key) {
    std::vector<YAML::Node> nodes;
    const auto value = root[key];
    if (!value || value.IsNull()) return nodes;
    if (!value.IsSequence()) say(value, std::string(key) + " must be a list");
    for (const auto& node : value) nodes.push_back(node);
    return nodes;
  }
  NewPort port(const YAML::Node& node) {
    if (!only(node, {"name", "type"})) return {};
    return {text(node, "name"), full_type(text(node, "type"))};
  }
  NewParameter parameter(const YAML::Node& node) {
    if (!only(node, {"name", "type", "default", "constraint", "widget"})) return {};
    return {text(node, "name"), text(node, "type", "double"), text(node, "default", "0"), text(node, "constraint"),
            text(node, "widget", "text")};
  }
  NewService service(const YAML::Node& node) {
    if (!only(node, {"port", "interface", "idl", "direction", "instance"})) return {};
    const auto direction = text(node, "direction", "provided");
    if (direction != "provided" && direction != "required") say(node["direction"], "direction must be provided or required");
    return {text(node, "port"), text(node, "interface"), beside(file_, text(node, "idl")), direction == "provided",
            text(node, "instance", "service" + std::to_string(services_++))};
  }

  std::string file_;
  std::string problem_;
  int services_ = 0;
};

Result<NewComponent> read_yaml(const std::string& file) {
  try {
    return YamlReader(file).read();
  } catch (const YAML::Exception& e) {
    return Error{"file " + base::in_quotes(file) + ":" + std::to_string(e.mark.line + 1) + ": is no YAML: " + e.msg};
  }
}

}  // namespace

std::string full_type(const std::string& type) { return type.empty() || type.find("::") != std::string::npos ? type : "RTC::" + type; }

void add_once(std::vector<std::string>& list, const std::string& item) {
  if (std::ranges::find(list, item) == list.end()) list.push_back(item);
}

Result<NewComponent> read_specification(const std::string& file) {
  if (const auto problem = base::file_problem(file); !problem.empty()) return Error{"file " + base::in_quotes(file) + ": " + problem};
  return file.ends_with(".xml") ? read_rtc_xml(file) : read_yaml(file);
}

}  // namespace tools
