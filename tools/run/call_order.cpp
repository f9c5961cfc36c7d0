#include "run/call_order.h"

#include <algorithm>
#include <set>
#include <tuple>
#include <utility>

namespace tools {
namespace {

// Who comes before whom, without circles.
class Order {
 public:
  // False: they have the other order already.
  bool add(const std::string& first, const std::string& then) {
    std::set<std::string> seen;
    if (is_before(then, first, seen)) return false;
    before_[then].insert(first);
    before_[first];
    return true;
  }
  // Of each: how many come before it, one after the other.
  std::map<std::string, int> layers() const {
    std::map<std::string, int> found;
    for (const auto& [instance, ignored] : before_) layer_of(instance, found);
    return found;
  }

 private:
  bool is_before(const std::string& first, const std::string& then, std::set<std::string>& seen) const {
    if (first == then) return true;
    const auto it = before_.find(then);
    if (it == before_.end() || !seen.insert(then).second) return false;
    return std::ranges::any_of(it->second, [&](const auto& one) { return is_before(first, one, seen); });
  }
  int layer_of(const std::string& instance, std::map<std::string, int>& found) const {
    if (const auto known = found.find(instance); known != found.end()) return known->second;
    int layer = 0;
    for (const auto& one : before_.at(instance)) layer = std::max(layer, layer_of(one, found) + 1);
    return found[instance] = layer;
  }

  std::map<std::string, std::set<std::string>> before_;
};

bool is_pull(const SavedConnector& connector) {
  for (const auto& [key, value] : connector.properties) {
    if (key == "dataport.dataflow_type") return value == "pull";
  }
  return connector.dataflow_type == "pull";
}

}  // namespace

int CallOrder::turn_of(const std::string& instance) const {
  const auto it = turns.find(instance);
  return it == turns.end() ? 0 : it->second;
}

CallOrder call_order(const SavedSystem& system, const std::function<CalledComponent(const std::string& instance)>& about) {
  CallOrder result;
  Order order;
  std::map<std::string, std::set<std::string>> writers;  // by InPort of others
  std::set<std::tuple<std::string, std::string, std::string>> links;
  for (const auto& connector : system.connectors) {
    const auto &from = connector.source.instance, &to = connector.target.instance;
    if (!connector.is_data || from == to) continue;
    const auto writer = about(from), reader = about(to);
    if (reader.is_foreign && !is_pull(connector)) writers[connector.target.port_name].insert(from);
    if (!reader.is_foreign && !(writer.is_foreign && is_pull(connector))) continue;
    if (writer.phase && reader.phase && *writer.phase != *reader.phase) continue;
    links.emplace(connector.source.port_name + " to " + connector.target.port_name, from, to);
  }
  for (const auto& [link, from, to] : links) {
    if (!order.add(to, from)) result.in_a_circle.push_back(link);
  }
  const auto layers = order.layers();
  for (const auto& [port, instances] : writers) {
    std::vector<std::pair<int, std::string>> by_turn;
    for (const auto& instance : instances) by_turn.emplace_back(layers.contains(instance) ? layers.at(instance) : 0, instance);
    std::ranges::sort(by_turn);
    for (std::size_t i = 1; i < by_turn.size(); ++i) order.add(by_turn[i - 1].second, by_turn[i].second);
  }
  result.turns = order.layers();
  return result;
}

}  // namespace tools
