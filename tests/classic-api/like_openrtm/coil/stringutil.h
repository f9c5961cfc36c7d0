// See coil/Properties.h. Lists of numbers are not converted: that takes a function of the component's own.
#pragma once

#include <sstream>
#include <string>
#include <vector>

namespace coil {

using vstring = std::vector<std::string>;
vstring split(const std::string& input, const std::string& delimiter, bool ignore_empty = false);
std::string flatten(vstring parts, const std::string& delimiter = ", ");
bool includes(const vstring& list, std::string value, bool ignore_case = true);
bool includes(const std::string& list, std::string value, bool ignore_case = true);

template <typename To>
bool stringTo(To& value, const char* text) {
  std::stringstream stream;
  return !(stream << text).fail() && !(stream >> value).fail();
}
template <>
bool stringTo<std::string>(std::string& value, const char* text);
template <>
bool stringTo<bool>(bool& value, const char* text);

}  // namespace coil
