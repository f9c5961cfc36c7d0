#include "studio/connection_graph.h"

#include <map>
#include <set>

namespace studio {
namespace {

using Names = std::map<std::string, std::set<std::string>>;  // by topic

Json list_of(const Names& names, const char* ids) {
  Json list = Json::array();
  for (const auto& [topic, all] : names) list.push_back({{"name", topic}, {ids, all}});
  return list;
}

}  // namespace

Json connection_graph(const Json& system, const Json& signals) {
  std::map<std::string, std::string> instances, topics;  // by the paths of components, and of ports
  for (const Json& one : list_in(system, "components")) instances[one.value("path", "")] = one.value("instance", "");
  Names published, subscribed;
  for (const Json& signal : list_in(signals, "signals")) {
    const auto component = instances.find(signal.value("component", ""));
    if (signal.value("kind", "") != "port" || component == instances.end()) continue;
    const auto topic = signal.value("topic", "");
    topics[component->first + ":" + topic.substr(topic.rfind('/') + 1)] = topic;
    published[topic].insert(component->second);
  }
  for (const Json& connection : list_in(system, "connections")) {
    for (const Json& out : list_in(connection, "ports")) {
      const auto topic = topics.find(out.get<std::string>());
      if (topic == topics.end()) continue;
      for (const Json& in : list_in(connection, "ports")) {
        const auto port = in.get<std::string>();
        const auto receiver = instances.find(port.substr(0, port.rfind(':')));
        if (port != topic->first && receiver != instances.end()) subscribed[topic->second].insert(receiver->second);
      }
    }
  }
  return {{"publishedTopics", list_of(published, "publisherIds")},
          {"subscribedTopics", list_of(subscribed, "subscriberIds")},
          {"advertisedServices", Json::array()}};
}

std::string graph_update(const Json& before, const Json& now) {
  Json message{{"op", "connectionGraphUpdate"}};
  message.update(now);
  std::set<std::string> gone;
  for (const char* key : {"publishedTopics", "subscribedTopics"}) {
    for (const Json& topic : list_in(before, key)) gone.insert(topic.value("name", ""));
  }
  for (const char* key : {"publishedTopics", "subscribedTopics"}) {
    for (const Json& topic : list_in(now, key)) gone.erase(topic.value("name", ""));
  }
  // Of a topic that lost its last receiver alone an empty list tells.
  for (const Json& topic : list_in(before, "subscribedTopics")) {
    const auto name = topic.value("name", "");
    bool is_there = gone.contains(name);
    for (const Json& other : list_in(now, "subscribedTopics")) is_there = is_there || other.value("name", "") == name;
    if (!is_there) message["subscribedTopics"].push_back({{"name", name}, {"subscriberIds", Json::array()}});
  }
  message["removedTopics"] = gone;
  message["removedServices"] = Json::array();
  return to_text(message);
}

}  // namespace studio
