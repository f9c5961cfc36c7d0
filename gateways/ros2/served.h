// The tables of topics, commands and services (`ros2-gateway --interfaces`). Pure; any thread.
#pragma once

#include <string>

namespace ros2 {

std::string interface_tables();

}  // namespace ros2
