#include "port_qos.h"

#include <algorithm>
#include <array>
#include <vector>

#include "base/log.h"
#include "base/suggestion.h"
#include "base/text.h"

namespace ros2 {
namespace {

constexpr std::size_t max_samples = 10'000;

struct Policy {
  std::string key, value;  // the key that has the value; without a value: the first key that could have one
};

Policy first_policy(const coil::Properties& connection, const std::vector<std::string>& keys) {
  for (const auto& key : keys) {
    if (const auto value = base::trim(connection.getProperty(key)); !value.empty()) return {key, std::string(value)};
  }
  return {keys.front(), ""};
}

// "BEST_EFFORT_RELIABILITY_QOS" is "best_effort" with this end.
bool is_named(const std::string& value, const std::string& plain, const std::string& end) {
  return base::equal_ignoring_case(value, plain) || base::equal_ignoring_case(value, plain + end);
}

// Whether a policy has the second of its two values.
base::Result<bool> is_second(const Policy& policy, const std::string& first, const std::string& second, const std::string& end,
                             bool usual) {
  if (policy.value.empty()) return usual;
  if (is_named(policy.value, first, end)) return false;
  if (is_named(policy.value, second, end)) return true;
  return base::Error{policy.key + " must be " + first + " or " + second + ", got " + base::in_quotes(policy.value)};
}

// All that mean something here, without the name of the transport.
const std::vector<std::string>& known_keys() {
  static const std::vector<std::string> known = [] {
    std::vector<std::string> keys = {"topic", "frame_id", "child_frame_id", "joint_names", "reliability", "durability", "depth", "history"};
    for (const char* node : {"writer_qos.", "reader_qos."})
      for (const char* key : {"durability.kind", "reliability.kind", "history.kind", "history.depth"})
        keys.push_back(std::string(node) + key);
    for (const char* node : {"publisher.", "subscriber."})
      for (const char* key : {"qos.durability.kind", "qos.reliability.kind", "topic.historyQos.kind", "topic.historyQos.depth", "name"})
        keys.push_back(std::string(node) + key);
    return keys;
  }();
  return known;
}

// A policy of OpenRTM's transports that has no effect here.
bool is_other_policy(std::string_view key) {
  bool is_qos = false;
  for (const std::string_view node : {"writer_qos.", "reader_qos.", "publisher.", "subscriber.", "qos."}) {
    if (!key.starts_with(node)) continue;
    key.remove_prefix(node.size());
    is_qos = true;
  }
  return is_qos && std::ranges::any_of(
                       std::array{"avoid_ros_namespace_conventions", "deadline.", "destinationOrder.", "durabilityService.",
                                  "history_memory_policy", "latencyBudget.", "lifespan.", "liveliness.", "ownership.", "ownershipStrength.",
                                  "presentation.", "publishMode.", "reliability.max_blocking_time", "timeBasedFilter.", "times.", "topic."},
                       [&](const char* policy) { return key.starts_with(policy); });
}

}  // namespace

base::Result<void> check_keys(const coil::Properties& connection, const std::string& name, bool is_own_mapping) {
  for (const auto& full : connection.propertyNames()) {
    if (!full.starts_with(name + ".")) continue;
    const std::string key = full.substr(name.size() + 1);
    if (std::ranges::find(known_keys(), key) != known_keys().end()) continue;
    if (is_other_policy(key)) {
      base::log(base::Level::warn, "ros2", "{}: {}={} without effect: reliability, durability and history are supported",
                connection.getProperty("connector_name"), full, connection.getProperty(full));
      continue;
    }
    const std::string meant = base::nearest(key, known_keys());
    if (meant.empty() && is_own_mapping) continue;
    return base::Error{
        "unknown property " + full +
        (meant.empty() ? "; expected " + name + ".topic or another one of docs/ros2.md" : "; did you mean " + name + "." + meant + "?")};
  }
  return {};
}

base::Result<void> read_qos(const coil::Properties& connection, const std::string& name, bool is_writer, PortTopic& topic) {
  EndpointSettings& endpoint = topic.endpoint;
  const std::string python = name + (is_writer ? ".writer_qos." : ".reader_qos.");
  const std::string cpp = name + (is_writer ? ".publisher." : ".subscriber.");
  const auto policy = [&](const std::string& in_python, const std::string& in_cpp, const std::string& own) {
    return first_policy(connection, {python + in_python, cpp + in_cpp, name + "." + own});
  };
  const auto transient = is_second(policy("durability.kind", "qos.durability.kind", "durability"), "volatile", "transient_local",
                                   "_durability_qos", endpoint.is_transient);
  if (!transient) return transient.error();
  endpoint.is_transient = *transient;
  const auto reliability = policy("reliability.kind", "qos.reliability.kind", "reliability");
  topic.takes_all = !is_writer && reliability.value.empty();
  const auto reliable = is_second(reliability, "best_effort", "reliable", "_reliability_qos", endpoint.is_reliable);
  if (!reliable) return reliable.error();
  endpoint.is_reliable = *reliable;
  const auto keep_all =
      is_second(policy("history.kind", "topic.historyQos.kind", "history"), "keep_last", "keep_all", "_history_qos", false);
  if (!keep_all) return keep_all.error();
  const auto depth = policy("history.depth", "topic.historyQos.depth", "depth");
  const auto number = base::parse_integer(depth.value.empty() ? std::to_string(endpoint.depth) : depth.value);
  if (!number || *number < 1 || *number > static_cast<std::int64_t>(max_samples))
    return base::Error{depth.key + " must be from 1 to 10000, got " + base::in_quotes(depth.value)};
  endpoint.depth = *keep_all ? max_samples : static_cast<std::size_t>(*number);
  return {};
}

}  // namespace ros2
