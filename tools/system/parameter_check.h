// Checks whether a value fits a parameter of a component, by the types and constraints in its configuration (the hidden sets __type__ and
// __constraints__, as editors of OpenRTM write them). Pure; any thread.
#pragma once

#include <string>

namespace tools {

// Sets like __type__, __widget__ and __constraints__ hold what editors know of parameters, not values: they are shown and kept, and never
// set, compared or changed.
inline bool is_hidden_set(const std::string& id) { return id.starts_with("_"); }

// "" or what was expected. Types: the integers of C++ and C99, float, double, bool, string, std::vector<...> and sequences with commas; one
// that is not known allows everything.
std::string type_problem(const std::string& type, const std::string& value);

// One of the types above.
bool is_parameter_type(const std::string& type);

// "" or what was expected. Constraints: "0<=x<=9", "x>0", several with commas for the members of a list, "(a,b,c)" and "{a,b,c}" for
// choices; one that is not understood allows everything.
std::string constraint_problem(const std::string& constraint, const std::string& value);

}  // namespace tools
