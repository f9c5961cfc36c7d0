// Parses the argument that creates a component: `Type`, `Type?key=value&key=value` or `RTC:vendor:category:Type:language:version?...`
// (empty parts match anything). Any thread.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/result.h"

namespace rt {

struct ComponentId {
  std::string vendor;
  std::string category;
  std::string implementation_id;  // never empty
  std::string language;
  std::string version;
  bool operator==(const ComponentId&) const = default;
};

struct ComponentArgument {
  ComponentId id;
  std::vector<std::pair<std::string, std::string>> properties;  // in the order given
};

base::Result<ComponentArgument> parse_component_argument(std::string_view text);

// Every part that both have is the same.
bool is_match(const ComponentId& wanted, const ComponentId& offered);

// Not empty, at most 1024 bytes, no control characters.
base::Result<void> check_instance_name(std::string_view name);

}  // namespace rt
