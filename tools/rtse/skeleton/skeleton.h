// Generates the sources of a new component, complete and ready to build. Pure; any thread.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "base/result.h"

namespace tools {

struct NewPort {
  std::string name;
  std::string type;  // C++ type of idl/: RTC::TimedLong
};

struct NewParameter {
  std::string name;
  std::string type;  // short, int, long, float, double, bool, std::string, std::vector<double>, ...
  std::string default_value;
  std::string constraint = "";  // as editors read it: 0<=x<=9
  std::string widget = "text";
};

// One interface of a service port; a port may have several.
struct NewService {
  std::string port;
  std::string interface;  // of the IDL file: Module::Interface or Interface
  std::string idl_file;   // copied into idl/, with what it includes
  bool is_provided = true;
  std::string instance;
};

struct NewComponent {
  std::string name;
  std::string description = "A new component";
  std::string version = "1.0.0";
  std::string vendor = "Me";
  std::string category = "example";
  double rate = 100;  // [Hz]
  std::vector<NewPort> in_ports;
  std::vector<NewPort> out_ports;
  std::vector<NewParameter> parameters;
  std::vector<NewService> services;
  std::vector<std::string> idl_files;  // with data types of ports
  std::vector<std::string> actions;    // callbacks besides onInitialize, onActivated, onDeactivated and onExecute
};

// Names must be C++ identifiers that do not meet in the code, types known ones; the error names what is not.
base::Result<void> check(const NewComponent& component);
// "SimpleService::MyService" -> "MyService".
std::string last_name(const std::string& name);
// A data type that comes with the product, as RTC::TimedLong.
bool is_product_type(const std::string& type);
// What may stand in `actions`.
const std::vector<std::string>& further_actions();
// File name -> content.
base::Result<std::map<std::string, std::string>> skeleton(const NewComponent& component);
// The same for a component in Python.
base::Result<std::map<std::string, std::string>> python_skeleton(const NewComponent& component);

}  // namespace tools
