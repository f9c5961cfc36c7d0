#include "manager/transport_modules.h"

#include <chrono>
#include <optional>
#include <string_view>

#include "base/guarded.h"
#include "manager/manager_impl.h"

namespace RTC {
namespace {

struct TransportModule {
  std::string_view transport, module, package;
};
constexpr TransportModule transport_modules[] = {
    {"cyclone-dds", "ROS2Transport", "rtm-ros2"}, {"fast-rtps", "ROS2Transport", "rtm-ros2"}, {"ros2", "ROS2Transport", "rtm-ros2"}};

struct Looked {
  std::optional<std::chrono::steady_clock::time_point> time;
  std::vector<std::string> found;
};
constexpr std::chrono::seconds between_looks{5};

}  // namespace

std::string ManagerImpl::module_file(const std::string& module) {
  Manager* manager = Manager::instance_if_any();
  const bool is_there = manager != nullptr && manager->impl_->modules != nullptr && !manager->impl_->is_ending();
  return is_there ? manager->impl_->modules->findFile(module) : "";
}

namespace detail {

std::vector<std::string> transports_of_modules() {
  static base::Guarded<Looked, base::Rank::noted> looked;
  const auto now = std::chrono::steady_clock::now();
  {
    auto last = looked.lock();
    if (last->time && now < *last->time + between_looks) return last->found;
  }
  std::vector<std::string> found;
  for (const auto& row : transport_modules) {
    if (!ManagerImpl::module_file(std::string(row.module)).empty()) found.emplace_back(row.transport);
  }
  *looked.lock() = {now, found};
  return found;
}

std::string load_transport_module(const std::string& transport) {
  for (const auto& row : transport_modules) {
    if (row.transport != transport) continue;
    const std::string module(row.module);
    if (ManagerImpl::module_file(module).empty())
      return "the module " + module + " is not in manager.modules.load_path and not installed (package " + std::string(row.package) + ")";
    // Of two ports at a time one waits: it must not go on before the transport is registered.
    static base::UsersTurn loading;
    const auto mine = loading.take(std::chrono::seconds(10));
    const bool is_loaded = mine && Manager::instance_if_any()->load(module) == RTC_OK;
    return is_loaded ? "" : "the module " + module + " cannot be loaded";
  }
  return "";
}

}  // namespace detail
}  // namespace RTC
