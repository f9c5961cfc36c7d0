#include "rtse/skeleton/skeleton.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <set>

#include "base/text.h"
#include "rtse/skeleton/idl_operations.h"

namespace tools {
namespace {

using base::Error;
using base::Result;

// For the guards of headers.
std::string upper(std::string text) {
  for (char& c : text)
    c = std::isalnum(static_cast<unsigned char>(c)) ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : '_';
  return text;
}

std::string literal(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    result += std::iscntrl(static_cast<unsigned char>(c)) ? ' ' : c;
  }
  return result + "\"";
}

// For a comment of one line: no control characters, and no backslash at the end, which would take the next line into the comment.
std::string comment(std::string text) {
  for (char& c : text) c = std::iscntrl(static_cast<unsigned char>(c)) ? ' ' : c;
  while (text.ends_with('\\') || text.ends_with(' ')) text.pop_back();
  return text;
}

// RTC.xml says "string" where C++ says "std::string".
std::string cpp_type(std::string type) {
  for (const std::string_view word : {"string", "vector", "int16_t", "uint16_t", "int32_t", "uint32_t", "int64_t", "uint64_t"}) {
    for (auto at = type.find(word); at != std::string::npos; at = type.find(word, at + word.size() + 5)) {
      const bool is_whole = at == 0 || (!std::isalnum(static_cast<unsigned char>(type[at - 1])) && type[at - 1] != ':');
      if (is_whole) type.insert(at, "std::");
    }
  }
  return type;
}

std::string stem(const std::string& file) { return std::filesystem::path(file).stem().string(); }

// The header of idl/ that has a type; nothing for types of the user's own IDL files.
std::string header_of(const std::string& type) {
  if (!is_product_type(type)) return "";
  if (type.starts_with("Img::")) return "rtm/ext/CameraCommonInterfaceSkel.h";
  if (type.starts_with("JARA_ARM::")) return "rtm/ext/ManipulatorCommonInterface_DataTypesSkel.h";
  const auto name = last_name(type);
  static const std::vector<std::string> basic = {"State", "Short", "Long",    "UShort", "ULong",  "Float",  "Double",
                                                 "Char",  "WChar", "Boolean", "Octet",  "String", "WString"};
  for (const auto& one : basic) {
    if (name == "Timed" + one || name == "Timed" + one + "Seq") return "rtm/idl/BasicDataTypeSkel.h";
  }
  if (name.starts_with("Timed")) return "rtm/idl/ExtendedDataTypesSkel.h";
  return "rtm/idl/InterfaceDataTypesSkel.h";
}

std::string data_headers(const NewComponent& component) {
  std::map<std::string, bool> headers;
  for (const auto& port : component.in_ports) headers[header_of(port.type)] = true;
  for (const auto& port : component.out_ports) headers[header_of(port.type)] = true;
  headers.erase("");
  std::string text;
  for (const auto& [header, unused] : headers) text += "#include <" + header + ">\n";
  for (const auto& file : component.idl_files) text += fmt::format("#include \"{}Skel.h\"\n", stem(file));
  return text;
}

// The service ports in their order, each once.
std::vector<std::string> service_ports(const NewComponent& component) {
  std::vector<std::string> ports;
  for (const auto& service : component.services) {
    if (std::ranges::find(ports, service.port) == ports.end()) ports.push_back(service.port);
  }
  return ports;
}

// "MyServiceSVC_impl"; with its module when another provided interface has the same last name.
std::string implementation_name(const NewComponent& component, const std::string& interface) {
  const bool is_alone = std::ranges::none_of(component.services, [&](const NewService& other) {
    return other.is_provided && other.interface != interface && last_name(other.interface) == last_name(interface);
  });
  auto name = is_alone ? last_name(interface) : interface;
  for (auto colon = name.find("::"); colon != std::string::npos; colon = name.find("::")) name.replace(colon, 2, "_");
  return name + "SVC_impl";
}

std::string arguments_of(const std::string& action, bool is_definition) {
  if (action == "onFinalize") return "";
  return is_definition ? "RTC::UniqueId /*ec_id*/" : "RTC::UniqueId ec_id";
}

std::string specification(const NewComponent& component) {
  std::string text = "static const char* const " + base::to_lower(component.name) + "_spec[] = {\n";
  const auto add = [&](const std::string& key, const std::string& value) { text += "    " + literal(key) + ", " + literal(value) + ",\n"; };
  add("implementation_id", component.name);
  add("type_name", component.name);
  add("description", component.description);
  add("version", component.version);
  add("vendor", component.vendor);
  add("category", component.category);
  add("activity_type", "PERIODIC");
  add("kind", "DataFlowComponent");
  add("max_instance", "0");
  add("language", "C++");
  add("lang_type", "compile");
  add("exec_cxt.periodic.rate", base::format_number(component.rate));
  for (const auto& parameter : component.parameters) add("conf.default." + parameter.name, parameter.default_value);
  for (const auto& parameter : component.parameters) add("conf.__widget__." + parameter.name, parameter.widget);
  for (const auto& parameter : component.parameters) add("conf.__type__." + parameter.name, parameter.type);
  for (const auto& parameter : component.parameters) {
    if (!parameter.constraint.empty()) add("conf.__constraints__." + parameter.name, parameter.constraint);
  }
  return text + "    \"\"};\n";
}

std::string header_file(const NewComponent& component) {
  std::string members;
  for (const auto& parameter : component.parameters) members += fmt::format("  {} m_{};\n", cpp_type(parameter.type), parameter.name);
  for (const auto& port : component.in_ports) members += fmt::format("\n  {0} m_{1};\n  RTC::InPort<{0}> m_{1}In;\n", port.type, port.name);
  for (const auto& port : component.out_ports)
    members += fmt::format("\n  {0} m_{1};\n  RTC::OutPort<{0}> m_{1}Out;\n", port.type, port.name);
  for (const auto& port : service_ports(component)) members += fmt::format("\n  RTC::CorbaPort m_{}Port;\n", port);
  std::set<std::string> includes;
  for (const auto& service : component.services) {
    if (service.is_provided) {
      members += fmt::format("  {} m_{};\n", implementation_name(component, service.interface), service.instance);
      includes.insert(fmt::format("#include \"{}SVC_impl.h\"\n", stem(service.idl_file)));
    } else {
      members += fmt::format("  RTC::CorbaConsumer<{}> m_{};\n", service.interface, service.instance);
      includes.insert(fmt::format("#include \"{}Stub.h\"\n", stem(service.idl_file)));
    }
  }
  std::string actions;
  for (const auto& action : component.actions)
    actions += fmt::format("  RTC::ReturnCode_t {}({}) override;\n", action, arguments_of(action, false));
  return fmt::format(R"(// {description}
#ifndef {guard}_H
#define {guard}_H

{data}#include <rtm/Manager.h>
#include <rtm/DataFlowComponentBase.h>
#include <rtm/CorbaPort.h>
#include <rtm/DataInPort.h>
#include <rtm/DataOutPort.h>

#include <cstdint>
#include <string>
#include <vector>

{services}
class {name} : public RTC::DataFlowComponentBase
{{
 public:
  {name}(RTC::Manager* manager);
  ~{name}() override;

  RTC::ReturnCode_t onInitialize() override;
  RTC::ReturnCode_t onActivated(RTC::UniqueId ec_id) override;
  RTC::ReturnCode_t onDeactivated(RTC::UniqueId ec_id) override;
  RTC::ReturnCode_t onExecute(RTC::UniqueId ec_id) override;
{actions}
 private:
{members}}};

extern "C"
{{
  DLL_EXPORT void {name}Init(RTC::Manager* manager);
}};

#endif
)",
                     fmt::arg("description", comment(component.description)), fmt::arg("guard", upper(component.name)),
                     fmt::arg("data", data_headers(component)), fmt::arg("services", fmt::join(includes, "")),
                     fmt::arg("name", component.name), fmt::arg("members", members), fmt::arg("actions", actions));
}

std::string source_file(const NewComponent& component) {
  std::string construct;
  for (const auto& port : component.in_ports) construct += fmt::format(",\n    m_{0}In(\"{0}\", m_{0})", port.name);
  for (const auto& port : component.out_ports) construct += fmt::format(",\n    m_{0}Out(\"{0}\", m_{0})", port.name);
  for (const auto& port : service_ports(component)) construct += fmt::format(",\n    m_{0}Port(\"{0}\")", port);
  std::string initialise;
  for (const auto& port : component.in_ports) initialise += fmt::format("  addInPort(\"{0}\", m_{0}In);\n", port.name);
  for (const auto& port : component.out_ports) initialise += fmt::format("  addOutPort(\"{0}\", m_{0}Out);\n", port.name);
  for (const auto& service : component.services) {
    initialise += fmt::format("  m_{0}Port.register{1}(\"{2}\", \"{3}\", m_{2});\n", service.port,
                              service.is_provided ? "Provider" : "Consumer", service.instance, service.interface);
  }
  for (const auto& port : service_ports(component)) initialise += fmt::format("  addPort(m_{0}Port);\n", port);
  for (const auto& parameter : component.parameters)
    initialise += fmt::format("  bindParameter(\"{0}\", m_{0}, {1});\n", parameter.name, literal(parameter.default_value));
  std::string execute;
  for (const auto& port : component.in_ports)
    execute += fmt::format("  if (m_{0}In.isNew())\n  {{\n    m_{0}In.read();\n    // m_{0} holds the newest value.\n  }}\n", port.name);
  for (const auto& port : component.out_ports) execute += fmt::format("  setTimestamp(m_{0});\n  m_{0}Out.write();\n", port.name);
  std::string actions;
  for (const auto& action : component.actions) {
    actions +=
        fmt::format("RTC::ReturnCode_t {}::{}({})\n{{\n  return RTC::RTC_OK;\n}}\n\n", component.name, action, arguments_of(action, true));
  }
  return fmt::format(R"(#include "{name}.h"

{spec}
{name}::{name}(RTC::Manager* manager)
  : RTC::DataFlowComponentBase(manager){construct}
{{
}}

{name}::~{name}()
{{
}}

RTC::ReturnCode_t {name}::onInitialize()
{{
{initialise}  return RTC::RTC_OK;
}}

RTC::ReturnCode_t {name}::onActivated(RTC::UniqueId /*ec_id*/)
{{
  return RTC::RTC_OK;
}}

RTC::ReturnCode_t {name}::onDeactivated(RTC::UniqueId /*ec_id*/)
{{
  return RTC::RTC_OK;
}}

RTC::ReturnCode_t {name}::onExecute(RTC::UniqueId /*ec_id*/)
{{
{execute}  return RTC::RTC_OK;
}}

{actions}extern "C"
{{
  void {name}Init(RTC::Manager* manager)
  {{
    coil::Properties profile({lower}_spec);
    manager->registerFactory(profile, RTC::Create<{name}>, RTC::Delete<{name}>);
  }}
}};
)",
                     fmt::arg("name", component.name), fmt::arg("spec", specification(component)), fmt::arg("construct", construct),
                     fmt::arg("initialise", initialise), fmt::arg("execute", execute), fmt::arg("actions", actions),
                     fmt::arg("lower", base::to_lower(component.name)));
}

std::string program_file(const NewComponent& component) {
  return fmt::format(R"(#include <rtm/Manager.h>

#include <iostream>

#include "{name}.h"

void MyModuleInit(RTC::Manager* manager)
{{
  {name}Init(manager);
  if (manager->createComponent("{name}") == nullptr)
  {{
    std::cerr << "{name}Comp: component {name} could not be created" << std::endl;
  }}
}}

int main(int argc, char** argv)
{{
  RTC::Manager* manager = RTC::Manager::init(argc, argv);
  manager->setModuleInitProc(MyModuleInit);
  manager->activateManager();
  manager->runManager();
  return 0;
}}
)",
                     fmt::arg("name", component.name));
}

std::string cmake_file(const NewComponent& component, const std::map<std::string, std::string>& idl_files) {
  std::string idl;
  for (const auto& [file, text] : idl_files) idl += fmt::format("openrtm_compile_idl_files(${{CMAKE_CURRENT_SOURCE_DIR}}/idl/{})\n", file);
  const bool any = !idl_files.empty();
  return fmt::format(
      R"(cmake_minimum_required(VERSION 3.10)
project({name} CXX)

find_package(OpenRTM REQUIRED)
if(NOT CMAKE_CXX_STANDARD)
  set(CMAKE_CXX_STANDARD 14)
endif()
add_definitions(${{OPENRTM_CFLAGS}})
include_directories(${{CMAKE_CURRENT_SOURCE_DIR}}/include ${{CMAKE_CURRENT_BINARY_DIR}} ${{OPENRTM_INCLUDE_DIRS}})
link_directories(${{OPENRTM_LIBRARY_DIRS}})
{idl}
add_library({name} SHARED src/{name}.cpp{sources})
set_target_properties({name} PROPERTIES PREFIX "")
target_link_libraries({name} ${{OPENRTM_LIBRARIES}})

add_executable({name}Comp src/{name}.cpp src/{name}Comp.cpp{sources})
target_link_libraries({name}Comp ${{OPENRTM_LIBRARIES}})
{depends}
enable_testing()
add_test(NAME {name}_starts COMMAND ${{CMAKE_COMMAND}} -DPROGRAM=$<TARGET_FILE:{name}Comp> -P ${{CMAKE_CURRENT_SOURCE_DIR}}/test/starts.cmake)

install(TARGETS {name} {name}Comp RUNTIME DESTINATION bin LIBRARY DESTINATION lib)
)",
      fmt::arg("name", component.name), fmt::arg("idl", idl), fmt::arg("sources", any ? " ${ALL_IDL_SRCS}" : ""),
      fmt::arg("depends",
               any ? fmt::format("add_dependencies({0} ALL_IDL_TGT)\nadd_dependencies({0}Comp ALL_IDL_TGT)\n", component.name) : ""));
}

std::string test_file(const NewComponent& component) {
  return fmt::format(R"(# The program starts, creates its component and ends when asked to.
execute_process(COMMAND ${{PROGRAM}} -o naming.enable:NO -o manager.shutdown_auto:NO -o corba.endpoints:127.0.0.1: TIMEOUT 3 RESULT_VARIABLE result ERROR_VARIABLE errors)
if(NOT result MATCHES "timeout" OR errors MATCHES "could not be created")
  message(FATAL_ERROR "{name}Comp ended by itself: ${{result}} ${{errors}}")
endif()
)",
                     fmt::arg("name", component.name));
}

// The implementation of an interface, with the operations as the IDL compiler declares them for C++.
Result<std::string> implementation(const NewComponent& component, const NewService& service) {
  const auto operations = operations_of(service);
  if (!operations) return operations.error();
  std::string methods;
  for (const auto& operation : *operations)
    methods += fmt::format("  {} override\n  {{\n    {}\n  }}\n", operation.declaration, operation.answer);
  return fmt::format(R"(
// Implementation of the service {interface}.
class {name} : public virtual POA_{interface}, public virtual PortableServer::RefCountServantBase
{{
 public:
{methods}}};
)",
                     fmt::arg("interface", service.interface), fmt::arg("name", implementation_name(component, service.interface)),
                     fmt::arg("methods", methods));
}

// One header for each IDL file with provided interfaces.
Result<void> add_implementations(const NewComponent& component, std::map<std::string, std::string>& files) {
  std::map<std::string, std::string> bodies;  // by the file's stem
  std::set<std::string> seen;
  for (const auto& service : component.services) {
    if (!service.is_provided || !seen.insert(service.interface).second) continue;
    const auto body = implementation(component, service);
    if (!body) return body.error();
    bodies[stem(service.idl_file)] += *body;
  }
  for (const auto& [name, body] : bodies) {
    files["include/" + name + "SVC_impl.h"] =
        fmt::format("#ifndef {0}SVC_IMPL_H\n#define {0}SVC_IMPL_H\n\n#include \"{1}Skel.h\"\n{2}\n#endif\n", upper(name), name, body);
  }
  return {};
}

std::string readme_file(const NewComponent& component) {
  std::string ports;
  for (const auto& port : component.in_ports) ports += fmt::format("- in `{}`: {}\n", port.name, port.type);
  for (const auto& port : component.out_ports) ports += fmt::format("- out `{}`: {}\n", port.name, port.type);
  for (const auto& parameter : component.parameters)
    ports += fmt::format("- parameter `{}`: {}, {}\n", parameter.name, parameter.type, parameter.default_value);
  for (const auto& service : component.services)
    ports += fmt::format("- service `{}`: {} {}\n", service.port, service.is_provided ? "provides" : "uses", service.interface);
  return fmt::format(
      "# {0}\n\n{1}\n\n{2}\nBuild: `cmake -B build && cmake --build build && ctest --test-dir build`; run: `build/{0}Comp`.\n",
      component.name, component.description, ports);
}

}  // namespace

std::string last_name(const std::string& name) {
  const auto colon = name.rfind("::");
  return colon == std::string::npos ? name : name.substr(colon + 2);
}

Result<std::map<std::string, std::string>> skeleton(const NewComponent& given) {
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
  files["README.md"] = readme_file(component);
  files["CMakeLists.txt"] = cmake_file(component, *idl);
  files["include/" + component.name + ".h"] = header_file(component);
  files["src/" + component.name + ".cpp"] = source_file(component);
  files["src/" + component.name + "Comp.cpp"] = program_file(component);
  files["test/starts.cmake"] = test_file(component);
  for (const auto& [name, text] : *idl) files["idl/" + name] = text;
  if (const auto added = add_implementations(component, files); !added) return added.error();
  return files;
}

}  // namespace tools
