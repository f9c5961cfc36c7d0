// Reads IDL files for `rtse new`: their dependencies, and the operations of an interface as C++ declarations, by omniidl. Any
// thread.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "rtse/skeleton/skeleton.h"

namespace tools {

struct Operation {
  std::string declaration;  // "Mod::Pt* q(char*& s)"
  std::string answer;       // a statement that returns something harmless
};

// Those of the interface and of the interfaces that it inherits. Fails when omniidl is missing or rejects the file.
base::Result<std::vector<Operation>> operations_of(const NewService& service);

// Interfaces that are declared in an IDL text, with their modules ("Mod::If"), in its order.
std::vector<std::string> interfaces_in(const std::string& idl);

// The service with its interface in full: RTC.xml may leave out the module, as in "Ranger" for RTC::Ranger; the file of the service must
// have one interface of that name, or those that it includes.
base::Result<NewService> in_full(const NewService& service);

// File name -> text: the files, and those of their own folders that they include. What is included from elsewhere must be in a folder that
// every project gets (the data types of the product). Fails for files that cannot lie in one folder.
base::Result<std::map<std::string, std::string>> with_included(const std::vector<std::string>& files);

// A struct, union or typedef of this C++ name ("Mod::Pt") is in one of the texts.
bool defines_type(const std::map<std::string, std::string>& idl, const std::string& type);

}  // namespace tools
