// Checks the settings of a connection before it is made, for tools: a port replaces a value that it does not understand by its default,
// and reports that only in its log. Pure; any thread.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace corba {

// A line for each value of a ConnectorProfile that a port of this runtime would replace: the key, what is allowed, and the value.
std::vector<std::string> misunderstood_values(const std::map<std::string, std::string>& properties);

// Why a port of this runtime rejects a connection with these values; empty if it does not.
std::string refusal_of_values(const std::map<std::string, std::string>& properties);

}  // namespace corba
