// What `rtse new` can make code of: names, types, defaults.
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>
#include <set>

#include "base/text.h"
#include "rtse/skeleton/idl_operations.h"
#include "rtse/skeleton/skeleton.h"
#include "system/parameter_check.h"
#include "system/value_codec.h"

namespace tools {
namespace {

using base::Error;
using base::Result;

// Words of C++, namespaces and macros that the code meets, and targets that CMake or the package OpenRTM keep for themselves.
const std::set<std::string> taken_names = {
    "alignas", "alignof", "and", "and_eq", "asm", "auto", "bitand", "bitor", "bool", "break", "case", "catch", "char", "char8_t",
    "char16_t", "char32_t", "class", "compl", "concept", "const", "consteval", "constexpr", "constinit", "const_cast", "continue",
    "co_await", "co_return", "co_yield", "decltype", "default", "delete", "do", "double", "dynamic_cast", "else", "enum", "explicit",
    "export", "extern", "false", "float", "for", "friend", "goto", "if", "inline", "int", "long", "mutable", "namespace", "new", "noexcept",
    "not", "not_eq", "nullptr", "operator", "or", "or_eq", "private", "protected", "public", "register", "reinterpret_cast", "requires",
    "return", "short", "signed", "sizeof", "static", "static_assert", "static_cast", "struct", "switch", "template", "this", "thread_local",
    "throw", "true", "try", "typedef", "typeid", "typename", "union", "unsigned", "using", "virtual", "void", "volatile", "wchar_t",
    "while", "xor", "xor_eq",
    // namespaces, macros, functions
    "std", "RTC", "RTM", "coil", "CORBA", "CosNaming", "OpenRTM", "OpenRTM_aist", "PortableServer", "SDOPackage", "base", "core", "corba",
    "rt", "linux", "unix", "main", "NULL", "TRUE", "FALSE", "EOF",
    // targets
    "all", "ALL_BUILD", "ALL_IDL_TGT", "INSTALL", "PACKAGE", "RUN_TESTS", "ZERO_CHECK", "clean", "depend", "edit_cache", "help", "install",
    "list_install_components", "omniorb", "openrtm", "package", "package_source", "preinstall", "rebuild_cache", "test"};

bool is_word(const std::string& text) {
  if (text.empty() || !std::isalpha(static_cast<unsigned char>(text.front()))) return false;
  return std::ranges::all_of(text, [](unsigned char c) { return std::isalnum(c) || c == '_'; }) && text.find("__") == std::string::npos;
}

bool is_type(const std::string& text) {
  return !text.empty() && std::ranges::all_of(text, [](unsigned char c) {
    return std::isalnum(c) || c == '_' || c == ':' || c == '<' || c == '>' || c == ' ';
  });
}

const std::set<std::string>& product_types() {
  static const std::set<std::string> types = [] {
    std::set<std::string> names;
    for (const auto& id : known_data_types()) {
      auto name = id.substr(4, id.rfind(':') - 4);  // IDL:RTC/TimedLong:1.0
      for (auto slash = name.find('/'); slash != std::string::npos; slash = name.find('/')) name.replace(slash, 1, "::");
      names.insert(name);
    }
    return names;
  }();
  return types;
}

// Every name becomes a member of the class, so two things may not ask for the same.
class Members {
 public:
  Result<void> add(const std::string& name, const std::string& what) {
    if (const auto [other, is_new] = names_.emplace(name, what); !is_new)
      return Error{what + ": its member m_" + name + " is that of " + other->second + " too"};
    return {};
  }

 private:
  std::map<std::string, std::string> names_;
};

Result<void> check_word(const std::string& name, const std::string& what) {
  if (is_word(name)) return {};
  return Error{what + " " + base::in_quotes(name) + ": must be a C++ identifier (letters, digits and single underscores, a letter first)"};
}

Result<void> check_port_type(const NewPort& port, const std::map<std::string, std::string>& idl) {
  const auto what = "port " + port.name + ": ";
  if (port.type.empty()) return Error{what + "has no type, expected NAME:TYPE, e.g. " + port.name + ":RTC::TimedDouble"};
  if (!is_type(port.type)) return Error{what + "type " + base::in_quotes(port.type) + " is no C++ type"};
  if (is_product_type(port.type) || defines_type(idl, port.type)) return {};
  return Error{what + "there is no data type " + base::in_quotes(port.type) +
               (idl.empty() ? ", expected one like RTC::TimedDouble, or one of your own with --idl FILE.idl" : " in the IDL files")};
}

Result<void> check_ports(const NewComponent& component, Members& members, std::set<std::string>& names) {
  const auto idl = with_included(component.idl_files);
  if (!idl) return idl.error();
  for (const auto* ports : {&component.in_ports, &component.out_ports}) {
    for (const auto& port : *ports) {
      if (const auto ok = check_word(port.name, "port"); !ok) return ok;
      if (!names.insert(port.name).second) return Error{"port " + base::in_quotes(port.name) + ": there is another of this name"};
      if (const auto ok = check_port_type(port, *idl); !ok) return ok;
      const auto what = "port " + base::in_quotes(port.name);
      if (const auto ok = members.add(port.name, what); !ok) return ok;
      if (const auto ok = members.add(port.name + (ports == &component.in_ports ? "In" : "Out"), what); !ok) return ok;
    }
  }
  return {};
}

Result<void> check_parameters(const NewComponent& component, Members& members) {
  for (const auto& parameter : component.parameters) {
    if (const auto ok = check_word(parameter.name, "parameter"); !ok) return ok;
    const auto what = "parameter " + parameter.name + ": ";
    if (const auto ok = members.add(parameter.name, "parameter " + base::in_quotes(parameter.name)); !ok) return ok;
    if (!is_type(parameter.type) || !is_parameter_type(parameter.type)) {
      return Error{what + "type " + base::in_quotes(parameter.type) +
                   " is not allowed for a parameter, expected int, double, bool, string, std::vector<double> or the like"};
    }
    auto problem = type_problem(parameter.type, parameter.default_value);
    if (problem.empty()) problem = constraint_problem(parameter.constraint, parameter.default_value);
    if (!problem.empty()) return Error{what + "default " + base::in_quotes(parameter.default_value) + ", expected " + problem};
  }
  return {};
}

Result<void> check_services(const NewComponent& component, Members& members, const std::set<std::string>& data_ports) {
  std::set<std::string> ports;
  for (const auto& service : component.services) {
    if (const auto ok = check_word(service.port, "service port"); !ok) return ok;
    const auto what = "service port " + base::in_quotes(service.port);
    if (data_ports.contains(service.port)) return Error{what + ": there is a data port of this name"};
    if (ports.insert(service.port).second) {
      if (const auto ok = members.add(service.port + "Port", what); !ok) return ok;
    }
    if (const auto ok = check_word(service.instance, "instance of " + what); !ok) return ok;
    if (const auto ok = members.add(service.instance, "instance " + base::in_quotes(service.instance) + " of " + what); !ok) return ok;
    if (!is_type(service.interface)) return Error{what + ": interface " + base::in_quotes(service.interface) + " is no IDL name"};
    if (!std::filesystem::is_regular_file(service.idl_file))
      return Error{what + ": IDL file " + base::in_quotes(service.idl_file) + " does not exist"};
  }
  return {};
}

}  // namespace

bool is_product_type(const std::string& type) { return product_types().contains(type); }

const std::vector<std::string>& further_actions() {
  static const std::vector<std::string> actions = {"onFinalize", "onStartup", "onShutdown",    "onAborting",
                                                   "onError",    "onReset",   "onStateUpdate", "onRateChanged"};
  return actions;
}

Result<void> check(const NewComponent& component) {
  if (const auto ok = check_word(component.name, "component name"); !ok) return ok;
  if (taken_names.contains(component.name))
    return Error{"component name " + base::in_quotes(component.name) + ": is taken, by C++, CMake or the runtime"};
  if (!(component.rate > 0 && component.rate <= 1e5))
    return Error{"rate " + base::format_number(component.rate) + ": must be above 0 and at most 100000 Hz"};
  for (const auto& action : component.actions) {
    if (std::ranges::find(further_actions(), action) == further_actions().end())
      return Error{"action " + base::in_quotes(action) + ": unknown, expected one of " + base::join(further_actions(), ", ")};
  }
  Members members;
  std::set<std::string> data_ports;
  if (const auto ok = check_ports(component, members, data_ports); !ok) return ok;
  if (const auto ok = check_parameters(component, members); !ok) return ok;
  return check_services(component, members, data_ports);
}

}  // namespace tools
