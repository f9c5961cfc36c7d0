// new: reads what the component shall be from options, RTC.xml or YAML, and writes its sources.
#include <yaml-cpp/yaml.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <pugixml.hpp>
#include <set>

#include "base/text.h"
#include "skeleton.h"

namespace editor {
namespace {

using base::Error;
using base::Result;

std::string_view local(std::string_view name) {
  const auto colon = name.find(':');
  return colon == std::string_view::npos ? name : name.substr(colon + 1);
}

// xsi:type says what kind of element it is, not what type a port has.
std::string attribute(const pugi::xml_node& node, std::string_view name, const std::string& otherwise = "") {
  for (const auto& candidate : node.attributes()) {
    if (local(candidate.name()) == name && !std::string_view(candidate.name()).starts_with("xsi:")) return candidate.value();
  }
  return otherwise;
}

// Types of RTC.xml are C++ names, or, in old files, names without a module.
std::string full_type(const std::string& type) { return type.find("::") == std::string::npos ? "RTC::" + type : type; }

void add_service(NewComponent& component, const std::string& port, const pugi::xml_node& interface, const std::filesystem::path& folder) {
  NewService service;
  service.port = port;
  service.interface = attribute(interface, "type");
  service.instance = attribute(interface, "instanceName", attribute(interface, "name"));
  service.is_provided = attribute(interface, "direction") == "Provided";
  service.idl_file = attribute(interface, "idlFile");
  if (!service.idl_file.empty() && std::filesystem::path(service.idl_file).is_relative())
    service.idl_file = (folder / service.idl_file).string();
  component.services.push_back(service);
}

Result<NewComponent> read_rtc_xml(const std::string& file) {
  pugi::xml_document document;
  if (const auto parsed = document.load_file(file.c_str()); !parsed)
    return Error{"file " + base::in_quotes(file) + ": is no XML: " + parsed.description()};
  const auto root = document.document_element();
  if (local(root.name()) != "RtcProfile") return Error{"file " + base::in_quotes(file) + ": holds no RtcProfile element"};
  NewComponent component;
  for (const auto& node : root.children()) {
    const auto kind = local(node.name());
    if (kind == "BasicInfo") {
      component.name = attribute(node, "name");
      component.description = attribute(node, "description", component.description);
      component.version = attribute(node, "version", component.version);
      component.vendor = attribute(node, "vendor", component.vendor);
      component.category = attribute(node, "category", component.category);
      component.rate = base::parse_number(attribute(node, "executionRate", "100")).value_or(0);
    } else if (kind == "DataPorts") {
      auto& ports = attribute(node, "portType") == "DataInPort" ? component.in_ports : component.out_ports;
      ports.push_back({attribute(node, "name"), full_type(attribute(node, "type"))});
    } else if (kind == "ServicePorts") {
      for (const auto& interface : node.children()) {
        if (local(interface.name()) == "ServiceInterface")
          add_service(component, attribute(node, "name"), interface, std::filesystem::path(file).parent_path());
      }
    } else if (kind == "ConfigurationSet") {
      for (const auto& parameter : node.children()) {
        if (local(parameter.name()) == "Configuration")
          component.parameters.push_back(
              {attribute(parameter, "name"), attribute(parameter, "type", "double"), attribute(parameter, "defaultValue")});
      }
    }
  }
  return component;
}

std::string text(const YAML::Node& node, const char* key, const std::string& otherwise = "") {
  return node[key] && node[key].IsScalar() ? node[key].Scalar() : otherwise;
}

Result<NewComponent> read_yaml(const std::string& file) {
  try {
    const auto root = YAML::LoadFile(file);
    if (!root.IsMap())
      return Error{"file " + base::in_quotes(file) + ": must hold a map with name, in_ports, out_ports, parameters, services"};
    static const std::set<std::string> known{"name", "description", "version",   "vendor",     "category",
                                             "rate", "in_ports",    "out_ports", "parameters", "services"};
    for (const auto& entry : root) {
      const auto key = entry.first.Scalar();
      if (!known.contains(key))
        return Error{"file " + base::in_quotes(file) + ":" + std::to_string(entry.first.Mark().line + 1) + ": unknown key " +
                     base::in_quotes(key) + ", expected one of " + base::join({known.begin(), known.end()}, ", ")};
    }
    NewComponent component;
    component.name = text(root, "name");
    component.description = text(root, "description", component.description);
    component.version = text(root, "version", component.version);
    component.vendor = text(root, "vendor", component.vendor);
    component.category = text(root, "category", component.category);
    component.rate = base::parse_number(text(root, "rate", "100")).value_or(0);
    for (const auto& port : root["in_ports"]) component.in_ports.push_back({text(port, "name"), full_type(text(port, "type"))});
    for (const auto& port : root["out_ports"]) component.out_ports.push_back({text(port, "name"), full_type(text(port, "type"))});
    for (const auto& parameter : root["parameters"])
      component.parameters.push_back({text(parameter, "name"), text(parameter, "type", "double"), text(parameter, "default", "0")});
    for (const auto& service : root["services"]) {
      auto idl = text(service, "idl");
      if (std::filesystem::path(idl).is_relative()) idl = (std::filesystem::path(file).parent_path() / idl).string();
      const auto interface = text(service, "interface");
      component.services.push_back({text(service, "port"), interface, idl, text(service, "direction", "provided") == "provided",
                                    text(service, "instance", "service")});
    }
    return component;
  } catch (const YAML::Exception& e) {
    return Error{"file " + base::in_quotes(file) + ":" + std::to_string(e.mark.line + 1) + ": is no YAML: " + e.msg};
  }
}

// "name:type" with the type's own colons; `otherwise` when there is no type.
std::pair<std::string, std::string> name_and_rest(const std::string& option) {
  const auto colon = option.find(':');
  if (colon == std::string::npos) return {option, ""};
  return {option.substr(0, colon), option.substr(colon + 1)};
}

struct Options {
  std::string name;
  std::string specification;
  std::string folder;
  std::string description, vendor, category, version;
  double rate = 0;
  std::vector<std::string> in_ports, out_ports, parameters, provided, required;
};

Result<NewComponent> component_of(const Options& options) {
  NewComponent component;
  if (!options.specification.empty()) {
    auto read = read_specification(options.specification);
    if (!read) return read.error();
    component = *read;
  }
  if (!options.name.empty()) component.name = options.name;
  if (!options.description.empty()) component.description = options.description;
  if (!options.vendor.empty()) component.vendor = options.vendor;
  if (!options.category.empty()) component.category = options.category;
  if (!options.version.empty()) component.version = options.version;
  if (options.rate != 0) component.rate = options.rate;
  for (const auto& option : options.in_ports)
    component.in_ports.push_back({name_and_rest(option).first, full_type(name_and_rest(option).second)});
  for (const auto& option : options.out_ports)
    component.out_ports.push_back({name_and_rest(option).first, full_type(name_and_rest(option).second)});
  for (const auto& option : options.parameters) {
    const auto [name, rest] = name_and_rest(option);
    const auto equals = rest.find('=');
    component.parameters.push_back({name, rest.substr(0, equals), equals == std::string::npos ? "0" : rest.substr(equals + 1)});
  }
  for (const auto* services : {&options.provided, &options.required}) {
    for (const auto& option : *services) {
      const auto parts = base::split_list(option, ',');
      if (parts.size() != 3) return Error{"service " + base::in_quotes(option) + ": expected PORT,MODULE::INTERFACE,FILE.idl"};
      component.services.push_back(
          {parts[0], parts[1], parts[2], services == &options.provided, "service" + std::to_string(component.services.size())});
    }
  }
  return component;
}

Result<void> write_skeleton(const NewComponent& component, const std::filesystem::path& folder) {
  const auto files = skeleton(component);
  if (!files) return files.error();
  std::error_code error;
  if (std::filesystem::exists(folder, error) && !std::filesystem::is_empty(folder, error))
    return Error{"folder " + base::in_quotes(folder.string()) + ": exists and is not empty"};
  for (const auto& [name, content] : *files) {
    std::filesystem::create_directories((folder / name).parent_path(), error);
    std::ofstream out(folder / name, std::ios::binary);
    out << content;
    out.close();
    if (!out) return Error{"file " + base::in_quotes((folder / name).string()) + ": cannot be written"};
  }
  return {};
}

}  // namespace

Result<NewComponent> read_specification(const std::string& file) {
  if (!std::filesystem::is_regular_file(file)) return Error{"file " + base::in_quotes(file) + ": does not exist"};
  return file.ends_with(".xml") ? read_rtc_xml(file) : read_yaml(file);
}

void add_new_command(CLI::App& app, int& code) {
  auto* command = app.add_subcommand("new", "Write the sources of a new component: CMake project, module, program, test");
  auto options = std::make_shared<Options>();
  command->add_option("NAME", options->name, "Name of the component; a C++ identifier");
  command->add_option("--spec", options->specification,
                      "RTC.xml (RTCBuilder) or YAML with name, in_ports, out_ports, parameters, services");
  command->add_option("--in", options->in_ports, "InPort as NAME:TYPE, e.g. range:RTC::RangeData")->allow_extra_args(false);
  command->add_option("--out", options->out_ports, "OutPort as NAME:TYPE")->allow_extra_args(false);
  command->add_option("--param", options->parameters, "Parameter as NAME:TYPE=DEFAULT, e.g. gain:double=0.5")->allow_extra_args(false);
  command->add_option("--provide", options->provided, "Service as PORT,MODULE::INTERFACE,FILE.idl")->allow_extra_args(false);
  command->add_option("--require", options->required, "Service as PORT,MODULE::INTERFACE,FILE.idl")->allow_extra_args(false);
  command->add_option("--description", options->description, "One line on what it does");
  command->add_option("--vendor", options->vendor, "Vendor");
  command->add_option("--category", options->category, "Category");
  command->add_option("--component-version", options->version, "Version of the component");
  command->add_option("--rate", options->rate, "Rate of its execution context [Hz]");
  command->add_option("-C,--directory", options->folder, "Where to; default: a folder of the component's name");
  command->callback([options, &code] {
    const auto component = component_of(*options);
    const auto folder = component && options->folder.empty() ? component->name : options->folder;
    const auto written = component ? write_skeleton(*component, folder) : Result<void>(component.error());
    if (written) {
      std::cout << "wrote " << folder << "; build it: cmake -S " << folder << " -B " << folder << "/build && cmake --build " << folder
                << "/build\n";
      return;
    }
    std::cerr << "rtse: " << written.error().message << '\n';
    code = 1;
  });
}

}  // namespace editor
