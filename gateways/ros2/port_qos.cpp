#include "port_qos.h"

#include <algorithm>
#include <vector>

#include "base/log.h"
#include "base/text.h"

namespace ros2 {
namespace {

constexpr std::size_t most_samples = 10'000;

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

// Keys below `node` that mean something to OpenRTM but not here.
void name_useless_keys(const coil::Properties& connection, const std::string& node, const std::vector<std::string>& known) {
  std::vector<std::string> useless;
  for (const auto& key : connection.propertyNames()) {
    if (key.starts_with(node) && std::ranges::find(known, key.substr(node.size())) == known.end()) useless.push_back(key);
  }
  if (!useless.empty())
    base::log(base::Level::warn, "ros2", "{} without effect: reliability, durability and history are supported", base::join(useless, ", "));
}

}  // namespace

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
  if (!number || *number < 1 || *number > static_cast<std::int64_t>(most_samples))
    return base::Error{depth.key + " must be from 1 to 10000, got " + base::in_quotes(depth.value)};
  endpoint.depth = *keep_all ? most_samples : static_cast<std::size_t>(*number);
  name_useless_keys(connection, python, {"durability.kind", "reliability.kind", "history.kind", "history.depth"});
  name_useless_keys(connection, cpp,
                    {"qos.durability.kind", "qos.reliability.kind", "topic.historyQos.kind", "topic.historyQos.depth", "name"});
  return {};
}

}  // namespace ros2
