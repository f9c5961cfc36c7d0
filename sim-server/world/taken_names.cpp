#include "world/taken_names.h"

namespace sim {

std::string TakenNames::free(const std::string& name) {
  if (!contains(name)) return name;
  int& number = next_.try_emplace(name, 1).first->second;
  while (contains(name + "_" + std::to_string(number))) ++number;
  return name + "_" + std::to_string(number);
}

}  // namespace sim
