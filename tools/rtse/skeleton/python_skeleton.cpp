// The sources of a new component in Python.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "base/text.h"
#include "rtse/skeleton/idl_operations.h"
#include "rtse/skeleton/skeleton.h"

namespace tools {
namespace {

using base::Result;

std::string python_name(std::string cpp_name) {
  return base::join(base::split_list(base::join(base::split_list(cpp_name, ':'), "."), ' '), "");
}
std::string module_in(const std::string& cpp_name) { return cpp_name.substr(0, cpp_name.find("::")); }
std::string idl_stem(const std::string& file) { return std::filesystem::path(file).stem().string(); }

std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char letter : text) result += letter == '"' || letter == '\\' ? std::string{'\\', letter} : std::string{letter};
  return result + '"';
}

// Of the Python type that the default has.
std::string initial(const NewParameter& parameter) {
  const auto& type = parameter.type;
  const auto one = [&](const std::string& text) -> std::string {
    if (type.find("string") != std::string::npos) return quoted(text);
    if (type.find("bool") != std::string::npos) return base::parse_bool(text).value_or(false) ? "True" : "False";
    const bool is_real = type.find("double") != std::string::npos || type.find("float") != std::string::npos;
    return is_real && text.find_first_of(".eE") == std::string::npos ? text + ".0" : text;
  };
  if (!type.starts_with("std::vector")) return one(parameter.default_value);
  std::vector<std::string> parts;
  for (const auto& part : base::split_list(parameter.default_value)) parts.push_back(one(part));
  return "[" + base::join(parts, ", ") + "]";
}

std::string python_specification(const NewComponent& component) {
  std::string text = fmt::format("{}_spec = [", base::to_lower(component.name));
  bool is_first = true;
  const auto add = [&](const std::string& key, const std::string& value) {
    text += fmt::format("{}{}, {},\n", is_first ? "" : "    ", quoted(key), quoted(value));
    is_first = false;
  };
  add("implementation_id", component.name);
  add("type_name", component.name);
  add("description", component.description);
  add("version", component.version);
  add("vendor", component.vendor);
  add("category", component.category);
  add("activity_type", "PERIODIC");
  add("max_instance", "0");
  add("language", "Python");
  add("lang_type", "script");
  add("exec_cxt.periodic.rate", base::format_number(component.rate));
  for (const auto& parameter : component.parameters) {
    add("conf.default." + parameter.name, parameter.default_value);
    add("conf.__widget__." + parameter.name, parameter.widget);
    if (!parameter.constraint.empty()) add("conf.__constraints__." + parameter.name, parameter.constraint);
  }
  return text + "    \"\"]\n";
}

std::string imports(const NewComponent& component) {
  std::set<std::string> modules = {"RTC"};
  for (const auto* ports : {&component.in_ports, &component.out_ports})
    for (const auto& port : *ports) modules.insert(module_in(port.type));
  std::string examples;
  for (const auto& service : component.services) {
    modules.insert(module_in(service.interface));
    if (service.is_provided)
      examples += fmt::format("from {}_idl_example import {}_i\n", idl_stem(service.idl_file), last_name(service.interface));
  }
  std::string text = "import sys\n\nimport OpenRTM_aist\n";
  for (const auto& module : modules) text += "import " + module + "\n";
  return text + examples;
}

std::string initialization(const NewComponent& component) {
  std::string text;
  for (const auto& port : component.in_ports)
    text += fmt::format(
        "        self._d_{0} = OpenRTM_aist.instantiateDataType({1})\n        self._{0}In = OpenRTM_aist.InPort(\"{0}\", self._d_{0})\n"
        "        self.addInPort(\"{0}\", self._{0}In)\n",
        port.name, python_name(port.type));
  for (const auto& port : component.out_ports)
    text += fmt::format(
        "        self._d_{0} = OpenRTM_aist.instantiateDataType({1})\n        self._{0}Out = OpenRTM_aist.OutPort(\"{0}\", self._d_{0})\n"
        "        self.addOutPort(\"{0}\", self._{0}Out)\n",
        port.name, python_name(port.type));
  std::set<std::string> service_ports;
  for (const auto& service : component.services) {
    if (service_ports.insert(service.port).second)
      text += fmt::format("        self._{0}Port = OpenRTM_aist.CorbaPort(\"{0}\")\n", service.port);
    if (service.is_provided)
      text += fmt::format("        self._{0} = {1}_i()\n        self._{2}Port.registerProvider(\"{0}\", \"{3}\", self._{0})\n",
                          service.instance, last_name(service.interface), service.port, service.interface);
    else
      text += fmt::format(
          "        self._{0} = OpenRTM_aist.CorbaConsumer(interfaceType={1})\n        self._{2}Port.registerConsumer(\"{0}\", \"{3}\", "
          "self._{0})\n",
          service.instance, python_name(service.interface), service.port, service.interface);
  }
  for (const auto& port : service_ports) text += fmt::format("        self.addPort(self._{}Port)\n", port);
  for (const auto& parameter : component.parameters)
    text += fmt::format("        self._{0} = [{1}]\n        self.bindParameter(\"{0}\", self._{0}, {2})\n", parameter.name,
                        initial(parameter), quoted(parameter.default_value));
  return text;
}

std::string body_of_execute(const NewComponent& component) {
  std::string text;
  for (const auto& port : component.in_ports)
    text += fmt::format("        if self._{0}In.isNew():\n            self._d_{0} = self._{0}In.read()\n", port.name);
  for (const auto& port : component.out_ports)
    text += fmt::format("        # Fill self._d_{0}, then send it:\n        # self._{0}Out.write()\n", port.name);
  return text;
}

std::string module_file(const NewComponent& component) {
  std::string callbacks;
  std::vector<std::string> all = {"onActivated", "onDeactivated", "onExecute"};
  for (const auto& action : component.actions)
    if (std::ranges::find(all, action) == all.end() && action != "onInitialize") all.push_back(action);
  for (const auto& name : all)
    callbacks += fmt::format("\n    def {}(self{}):\n{}        return RTC.RTC_OK\n", name, name == "onFinalize" ? "" : ", ec_id",
                             name == "onExecute" ? body_of_execute(component) : "");
  return fmt::format(R"(#!/usr/bin/env python3
"""{description}"""
{imports}

{specification}

class {name}(OpenRTM_aist.DataFlowComponentBase):
    def __init__(self, manager):
        OpenRTM_aist.DataFlowComponentBase.__init__(self, manager)

    def onInitialize(self):
{initialization}        return RTC.RTC_OK
{callbacks}

def {name}Init(manager):
    profile = OpenRTM_aist.Properties(defaults_str={lower}_spec)
    manager.registerFactory(profile, {name}, OpenRTM_aist.Delete)


def MyModuleInit(manager):
    {name}Init(manager)
    manager.createComponent("{name}")


def main():
    manager = OpenRTM_aist.Manager.init(sys.argv)
    manager.setModuleInitProc(MyModuleInit)
    manager.activateManager()
    manager.runManager()


if __name__ == "__main__":
    main()
)",
                     fmt::arg("description", component.description), fmt::arg("imports", imports(component)),
                     fmt::arg("specification", python_specification(component)), fmt::arg("name", component.name),
                     fmt::arg("lower", base::to_lower(component.name)), fmt::arg("initialization", initialization(component)),
                     fmt::arg("callbacks", callbacks));
}

std::string python_test(const NewComponent& component) {
  return fmt::format(R"("""python3 -m pytest"""
import OpenRTM_aist
import RTC

import {0}


def test_{1}_is_created_and_becomes_active():
    manager = OpenRTM_aist.Manager.init(["test", "-o", "naming.enable:NO", "-o", "manager.shutdown_auto:NO"])
    manager.activateManager()
    {0}.{0}Init(manager)
    component = manager.createComponent("{0}")
    assert component is not None
    assert component.activate(0) == RTC.RTC_OK
)",
                     component.name, base::to_lower(component.name));
}

std::string read_me(const NewComponent& component, bool has_idl) {
  return fmt::format("# {0}\n\n{1}\n\n{2}Run: `python3 {0}.py`, or `rtcd {0}.py`. Test: `python3 -m pytest`.\n", component.name,
                     component.description, has_idl ? "First make the stubs: `sh idlcompile.sh`.\n" : "");
}

}  // namespace

Result<std::map<std::string, std::string>> python_skeleton(const NewComponent& given) {
  if (const auto ok = check(given); !ok) return ok.error();
  auto component = given;
  for (auto& service : component.services) {
    auto full = in_full(service);
    if (!full) return full.error();
    service = std::move(*full);
  }
  auto idl_paths = component.idl_files;
  for (const auto& service : component.services) idl_paths.push_back(service.idl_file);
  const auto idl = with_included(idl_paths);
  if (!idl) return idl.error();
  std::map<std::string, std::string> files;
  files[component.name + ".py"] = module_file(component);
  files["test_" + component.name + ".py"] = python_test(component);
  files["README.md"] = read_me(component, !idl->empty());
  if (idl->empty()) return files;
  std::string script = "#!/bin/sh\n# Makes the stubs of the IDL files, and an example of each servant to fill in.\n";
  for (const auto& [name, text] : *idl) {
    files["idl/" + name] = text;
    script += fmt::format("omniidl -bpython -Iidl idl/{0}\n[ -f {1}_idl_example.py ] || omniidl -bpython -Wbexample -Iidl idl/{0}\n", name,
                          idl_stem(name));
  }
  files["idlcompile.sh"] = script;
  return files;
}

}  // namespace tools
