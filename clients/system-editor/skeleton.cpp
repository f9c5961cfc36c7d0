#include "skeleton.h"

#include <spdlog/fmt/fmt.h>

#include <cctype>
#include <filesystem>
#include <fstream>
#include <pugixml.hpp>
#include <set>
#include <sstream>

#include "base/text.h"
#include "idl_operations.h"
#include "parameter_check.h"
#include "value_codec.h"

namespace editor {
namespace {

using base::Error;
using base::Result;

const std::set<std::string> keywords = {
    "alignas",  "alignof",  "and",       "asm",      "auto",      "bool",     "break",    "case",    "catch",   "char",
    "class",    "const",    "constexpr", "continue", "decltype",  "default",  "delete",   "do",      "double",  "else",
    "enum",     "explicit", "export",    "extern",   "false",     "float",    "for",      "friend",  "goto",    "if",
    "inline",   "int",      "long",      "mutable",  "namespace", "new",      "noexcept", "not",     "nullptr", "operator",
    "or",       "private",  "protected", "public",   "register",  "requires", "return",   "short",   "signed",  "sizeof",
    "static",   "struct",   "switch",    "template", "this",      "throw",    "true",     "try",     "typedef", "typeid",
    "typename", "union",    "unsigned",  "using",    "virtual",   "void",     "volatile", "wchar_t", "while",   "xor"};

bool is_identifier(const std::string& text) {
  if (text.empty() || keywords.contains(text) || std::isdigit(static_cast<unsigned char>(text[0]))) return false;
  for (const char c : text) {
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '_') return false;
  }
  return true;
}

bool is_type(const std::string& text) {
  for (const char c : text) {
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '_' && c != ':' && c != '<' && c != '>' && c != ' ') return false;
  }
  return !text.empty();
}

// Types of the modules that come with the product must be there; others come with an IDL file of the user's.
bool is_data_type(const std::string& type) {
  static const std::set<std::string> types = [] {
    std::set<std::string> names;
    for (const auto& id : known_data_types()) {
      auto name = id.substr(4, id.rfind(':') - 4);  // IDL:RTC/TimedLong:1.0
      for (auto slash = name.find('/'); slash != std::string::npos; slash = name.find('/')) name.replace(slash, 1, "::");
      names.insert(name);
    }
    return names;
  }();
  if (types.contains(type)) return true;
  const auto module = type.substr(0, type.find("::") + 2);
  return type.find("::") != std::string::npos && types.lower_bound(module) != types.end() &&
         !types.lower_bound(module)->starts_with(module);
}

std::string upper(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

// "SimpleService::MyService" -> "MyService".
std::string last_name(const std::string& name) {
  const auto colon = name.rfind("::");
  return colon == std::string::npos ? name : name.substr(colon + 2);
}

std::string literal(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    result += c == '\n' ? ' ' : c;
  }
  return result + "\"";
}

std::string stem(const std::string& file) { return std::filesystem::path(file).stem().string(); }

// The header of idl/ that has a type.
std::string header_of(const std::string& type) {
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
  std::string text;
  for (const auto& [header, unused] : headers) text += "#include <" + header + ">\n";
  return text;
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
  for (const auto& parameter : component.parameters) add("conf.__widget__." + parameter.name, "text");
  for (const auto& parameter : component.parameters) add("conf.__type__." + parameter.name, parameter.type);
  return text + "    \"\"};\n";
}

std::string header_file(const NewComponent& component) {
  std::string members;
  for (const auto& parameter : component.parameters) members += fmt::format("  {} m_{};\n", parameter.type, parameter.name);
  for (const auto& port : component.in_ports) members += fmt::format("\n  {0} m_{1};\n  RTC::InPort<{0}> m_{1}In;\n", port.type, port.name);
  for (const auto& port : component.out_ports)
    members += fmt::format("\n  {0} m_{1};\n  RTC::OutPort<{0}> m_{1}Out;\n", port.type, port.name);
  std::string includes;
  for (const auto& service : component.services) {
    members += fmt::format("\n  RTC::CorbaPort m_{}Port;\n", service.port);
    if (service.is_provided) {
      members += fmt::format("  {} m_{};\n", last_name(service.interface) + "SVC_impl", service.instance);
      includes += fmt::format("#include \"{}SVC_impl.h\"\n", stem(service.idl_file));
    } else {
      members += fmt::format("  RTC::CorbaConsumer<{}> m_{};\n", service.interface, service.instance);
      includes += fmt::format("#include \"{}Stub.h\"\n", stem(service.idl_file));
    }
  }
  return fmt::format(R"(// {description}
#ifndef {guard}_H
#define {guard}_H

{data}#include <rtm/Manager.h>
#include <rtm/DataFlowComponentBase.h>
#include <rtm/CorbaPort.h>
#include <rtm/DataInPort.h>
#include <rtm/DataOutPort.h>

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

 private:
{members}}};

extern "C"
{{
  DLL_EXPORT void {name}Init(RTC::Manager* manager);
}};

#endif
)",
                     fmt::arg("description", component.description), fmt::arg("guard", upper(component.name)),
                     fmt::arg("data", data_headers(component)), fmt::arg("services", includes), fmt::arg("name", component.name),
                     fmt::arg("members", members));
}

std::string source_file(const NewComponent& component) {
  std::string construct;
  for (const auto& port : component.in_ports) construct += fmt::format(",\n    m_{0}In(\"{0}\", m_{0})", port.name);
  for (const auto& port : component.out_ports) construct += fmt::format(",\n    m_{0}Out(\"{0}\", m_{0})", port.name);
  for (const auto& service : component.services) construct += fmt::format(",\n    m_{0}Port(\"{0}\")", service.port);
  std::string initialise;
  for (const auto& port : component.in_ports) initialise += fmt::format("  addInPort(\"{0}\", m_{0}In);\n", port.name);
  for (const auto& port : component.out_ports) initialise += fmt::format("  addOutPort(\"{0}\", m_{0}Out);\n", port.name);
  for (const auto& service : component.services) {
    initialise += fmt::format("  m_{0}Port.register{1}(\"{2}\", \"{3}\", m_{2});\n  addPort(m_{0}Port);\n", service.port,
                              service.is_provided ? "Provider" : "Consumer", service.instance, service.interface);
  }
  for (const auto& parameter : component.parameters)
    initialise += fmt::format("  bindParameter(\"{0}\", m_{0}, {1});\n", parameter.name, literal(parameter.default_value));
  std::string execute;
  for (const auto& port : component.in_ports)
    execute += fmt::format("  if (m_{0}In.isNew())\n  {{\n    m_{0}In.read();\n    // m_{0} holds the newest value.\n  }}\n", port.name);
  for (const auto& port : component.out_ports) execute += fmt::format("  setTimestamp(m_{0});\n  m_{0}Out.write();\n", port.name);
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

extern "C"
{{
  void {name}Init(RTC::Manager* manager)
  {{
    coil::Properties profile({lower}_spec);
    manager->registerFactory(profile, RTC::Create<{name}>, RTC::Delete<{name}>);
  }}
}};
)",
                     fmt::arg("name", component.name), fmt::arg("spec", specification(component)), fmt::arg("construct", construct),
                     fmt::arg("initialise", initialise), fmt::arg("execute", execute), fmt::arg("lower", base::to_lower(component.name)));
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

std::string cmake_file(const NewComponent& component) {
  std::string idl;
  std::map<std::string, bool> files;
  for (const auto& service : component.services)
    files[std::filesystem::path(service.idl_file).filename().string()] = service.is_provided || files[service.idl_file];
  for (const auto& [file, provided] : files) idl += fmt::format("openrtm_compile_idl_files(${{CMAKE_CURRENT_SOURCE_DIR}}/idl/{})\n", file);
  const bool any = !files.empty();
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

// The operations of the interface, as our IDL compiler declares them for C++.
Result<std::string> service_header(const NewService& service) {
  const auto operations = operations_of(service);
  if (!operations) return operations.error();
  const auto name = last_name(service.interface);
  std::string methods;
  for (const auto& operation : *operations)
    methods += fmt::format("  {} override\n  {{\n    {}\n  }}\n", operation.declaration, operation.answer);
  return fmt::format(R"(// Implementation of the service {interface}.
#ifndef {guard}SVC_IMPL_H
#define {guard}SVC_IMPL_H

#include "{stem}Skel.h"

class {name}SVC_impl : public virtual POA_{interface}, public virtual PortableServer::RefCountServantBase
{{
 public:
{methods}}};

#endif
)",
                     fmt::arg("interface", service.interface), fmt::arg("stem", stem(service.idl_file)),
                     fmt::arg("guard", upper(stem(service.idl_file))), fmt::arg("name", name), fmt::arg("methods", methods));
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

Result<std::string> read_file(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in || std::filesystem::is_directory(file)) return Error{"file " + base::in_quotes(file) + ": cannot be read"};
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

}  // namespace

Result<void> check(const NewComponent& component) {
  if (!is_identifier(component.name)) return Error{"component name " + base::in_quotes(component.name) + ": must be a C++ identifier"};
  if (!(component.rate > 0 && component.rate <= 1e5))
    return Error{"rate " + base::format_number(component.rate) + ": must be above 0 and at most 100000 Hz"};
  std::map<std::string, std::string> seen;
  const auto add = [&](const std::string& name, const std::string& what) -> Result<void> {
    if (!is_identifier(name)) return Error{what + " " + base::in_quotes(name) + ": must be a C++ identifier"};
    if (const auto [other, is_new] = seen.emplace(name, what); !is_new)
      return Error{what + " " + base::in_quotes(name) + ": there is a " + other->second + " of this name"};
    return {};
  };
  for (const auto* ports : {&component.in_ports, &component.out_ports}) {
    for (const auto& port : *ports) {
      if (auto ok = add(port.name, "port"); !ok) return ok;
      if (!is_type(port.type)) return Error{"port " + port.name + ": type " + base::in_quotes(port.type) + " is no C++ type"};
      if (!is_data_type(port.type))
        return Error{"port " + port.name + ": there is no data type " + base::in_quotes(port.type) +
                     ", expected one like RTC::TimedDouble"};
    }
  }
  for (const auto& parameter : component.parameters) {
    if (auto ok = add(parameter.name, "parameter"); !ok) return ok;
    if (!is_type(parameter.type))
      return Error{"parameter " + parameter.name + ": type " + base::in_quotes(parameter.type) + " is no C++ type"};
    if (!is_parameter_type(parameter.type))
      return Error{"parameter " + parameter.name + ": type " + base::in_quotes(parameter.type) +
                   " is none that a parameter can have, expected int, double, bool, string, std::vector<double> or the like"};
    if (const auto problem = type_problem(parameter.type, parameter.default_value); !problem.empty())
      return Error{"parameter " + parameter.name + ": default " + base::in_quotes(parameter.default_value) + ", expected " + problem};
  }
  for (const auto& service : component.services) {
    if (auto ok = add(service.port, "service port"); !ok) return ok;
    if (auto ok = add(service.instance, "service"); !ok) return ok;
    if (!is_type(service.interface))
      return Error{"service port " + service.port + ": interface " + base::in_quotes(service.interface) + " is no IDL name"};
    if (!std::filesystem::is_regular_file(service.idl_file))
      return Error{"service port " + service.port + ": IDL file " + base::in_quotes(service.idl_file) + " does not exist"};
  }
  return {};
}

Result<std::map<std::string, std::string>> skeleton(const NewComponent& component) {
  if (const auto ok = check(component); !ok) return ok.error();
  std::map<std::string, std::string> files;
  files["README.md"] = readme_file(component);
  files["CMakeLists.txt"] = cmake_file(component);
  files["include/" + component.name + ".h"] = header_file(component);
  files["src/" + component.name + ".cpp"] = source_file(component);
  files["src/" + component.name + "Comp.cpp"] = program_file(component);
  files["test/starts.cmake"] = test_file(component);
  for (const auto& service : component.services) {
    auto idl = read_file(service.idl_file);
    if (!idl) return idl.error();
    files["idl/" + std::filesystem::path(service.idl_file).filename().string()] = *idl;
    if (!service.is_provided) continue;
    auto header = service_header(service);
    if (!header) return header.error();
    files["include/" + stem(service.idl_file) + "SVC_impl.h"] = *header;
  }
  return files;
}

}  // namespace editor
