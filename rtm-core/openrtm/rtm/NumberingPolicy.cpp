#include "rtm/NumberingPolicy.h"

#include <algorithm>

#include "rtm/Manager.h"
#include "rtm/NamingManager.h"
#include "rtm/RTObject.h"

namespace RTM {

std::string ProcessUniquePolicy::onCreate(void* object) {
  const std::string type = static_cast<RTC::RTObject_impl*>(object)->getTypeName();
  auto* manager = RTC::Manager::instance_if_any();
  for (int number = 0;; ++number) {
    const auto name = type + std::to_string(number);
    const bool is_ours = std::any_of(names_.begin(), names_.end(), [&](const auto& entry) { return entry.second == name; });
    if (is_ours || (manager != nullptr && manager->getComponent(name) != nullptr) || is_taken(name, object)) continue;
    names_[object] = name;
    return std::to_string(number);
  }
}

void ProcessUniquePolicy::onDelete(void* object) { names_.erase(object); }

bool ProcessUniquePolicy::is_taken(const std::string&, void*) { return false; }

bool NodeNumberingPolicy::is_taken(const std::string& instance_name, void*) {
  auto* manager = RTC::Manager::instance_if_any();
  return manager != nullptr && manager->getNaming() != nullptr && manager->getNaming()->isInstanceTaken(instance_name, true);
}

bool NamingServiceNumberingPolicy::is_taken(const std::string& instance_name, void*) {
  auto* manager = RTC::Manager::instance_if_any();
  return manager != nullptr && manager->getNaming() != nullptr && manager->getNaming()->isInstanceTaken(instance_name, false);
}

}  // namespace RTM
