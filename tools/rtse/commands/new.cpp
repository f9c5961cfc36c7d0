// new: reads what the component shall be from options and a specification, and writes its sources.
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <optional>

#include "base/command_line.h"
#include "base/output_name.h"
#include "base/text.h"
#include "rtse/command.h"
#include "rtse/commands/commands.h"
#include "rtse/skeleton/specification.h"

namespace tools {
namespace {

using base::Error;
using base::Result;

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
  std::string language = "cpp";
  std::string description, vendor, category, version;
  std::optional<double> rate;
  std::vector<std::string> in_ports, out_ports, parameters, provided, required, idl_files, actions;
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
  if (options.rate) component.rate = *options.rate;
  for (const auto& file : options.idl_files) add_once(component.idl_files, file);
  for (const auto& action : options.actions) add_once(component.actions, action);
  for (const auto& option : options.in_ports)
    component.in_ports.push_back({name_and_rest(option).first, full_type(name_and_rest(option).second)});
  for (const auto& option : options.out_ports)
    component.out_ports.push_back({name_and_rest(option).first, full_type(name_and_rest(option).second)});
  for (const auto& option : options.parameters) {
    const auto [name, rest] = name_and_rest(option);
    const auto equals = rest.find('=');
    if (rest.empty() || equals == 0)
      return Error{"parameter " + base::in_quotes(option) + ": expected NAME:TYPE=DEFAULT, e.g. gain:double=0.5"};
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

Result<void> write_skeleton(const NewComponent& component, bool is_python, const std::filesystem::path& folder) {
  const auto files = is_python ? python_skeleton(component) : skeleton(component);
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

void make_component(Console& console, const Options& options) {
  const auto component = component_of(options);
  if (!component) return console.reject(component.error());
  const auto folder = options.folder.empty() ? component->name : options.folder;
  const bool is_python = options.language == "python";
  if (const auto written = write_skeleton(*component, is_python, folder); !written) return console.reject(written.error());
  if (is_python) {
    std::cout << "wrote " << folder << "; run it: cd " << folder << " && python3 " << component->name << ".py\n";
    return;
  }
  std::cout << "wrote " << folder << "; build it: cmake -S " << folder << " -B " << folder << "/build && cmake --build " << folder
            << "/build\n";
}

}  // namespace

void add_new(base::Command& app, Chosen& chosen) {
  auto* command = app.add_subcommand("new", "Write the sources of a new component, with a test: a CMake project, or a module of Python");
  auto options = std::make_shared<Options>();
  command->add_option("NAME", options->name, "Name of the component; a C++ identifier");
  command->add_option("--language", options->language, "Language of the component: cpp or python (default cpp)")
      ->check(base::one_of({"cpp", "python"}));
  command->add_option("--spec", options->specification,
                      "RTC.xml (RTCBuilder) or YAML with name, in_ports, out_ports, parameters, services");
  command->add_option("--idl", options->idl_files, "IDL file with data types of ports; it is copied, with its includes")
      ->allow_extra_args(false);
  command->add_option("--in", options->in_ports, "InPort as NAME:TYPE, e.g. range:RTC::RangeData")->allow_extra_args(false);
  command->add_option("--out", options->out_ports, "OutPort as NAME:TYPE")->allow_extra_args(false);
  command->add_option("--param", options->parameters, "Parameter as NAME:TYPE=DEFAULT, e.g. gain:double=0.5")->allow_extra_args(false);
  command->add_option("--provide", options->provided, "Service as PORT,MODULE::INTERFACE,FILE.idl")->allow_extra_args(false);
  command->add_option("--require", options->required, "Service as PORT,MODULE::INTERFACE,FILE.idl")->allow_extra_args(false);
  command->add_option("--description", options->description, "Description, one line");
  command->add_option("--vendor", options->vendor, "Vendor");
  command->add_option("--category", options->category, "Category");
  command->add_option("--component-version", options->version, "Version of the component");
  command->add_option("--rate", options->rate, "Rate of its execution context [Hz]")->check(base::number_between(1e-3, 1e5));
  command->add_option("--action", options->actions, "A further callback: " + base::join(further_actions(), ", "))->allow_extra_args(false);
  command->add_option("-C,--directory", options->folder, "Output folder (default: the component's name)")->check(base::output_name());
  command->callback([&chosen, options] {
    if (options->name.empty() && options->specification.empty()) base::require_on_command_line("NAME or --spec");
    chosen = {[options](const Session&, Console& console) { make_component(console, *options); }, /*needs_orb*/ false};
  });
}

}  // namespace tools
