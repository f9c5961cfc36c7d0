#include "studio/signal_book.h"

#include <utility>

#include "studio/client_message.h"

namespace studio {
namespace {

// "a::b" -> "a/b"
std::string as_path(std::string name) {
  for (auto at = name.find("::"); at != std::string::npos; at = name.find("::", at)) name.replace(at, 2, "/");
  return name;
}

}  // namespace

bool SignalBook::take_world(const Json& world) {
  Signals now;
  for (const Json& iface : list_in(world, "ifaces")) {
    const auto type = iface.value("type", ""), name = iface.value("name", "");
    const auto topic = "/sim/" + type + "/" + as_path(name);
    const bool is_picture = type == "camera" || type == "depth";
    now[topic] = {
        {{"topic", topic}, {"kind", is_picture ? "image" : "iface"}, {"type", type}, {"iface", name}, {"model", iface.value("model", "")}},
        type + ":" + name};
  }
  const bool has_changed = now != ifaces_;
  ifaces_ = std::move(now);
  return has_changed;
}

bool SignalBook::take_system(const Json& system) {
  Signals now;
  for (const Json& component : list_in(system, "components")) {
    const auto path = component.value("path", "");
    for (const Json& port : list_in(component, "ports")) {
      if (port.value("kind", "") != "out") continue;
      const auto source = path + ":" + port.value("name", "");
      auto topic = "/" + component.value("instance", "") + "/" + port.value("name", "");
      if (now.contains(topic)) topic = source;
      now[topic] = {{{"topic", topic}, {"kind", "port"}, {"type", port.value("data_type", "")}, {"component", path}}, source};
    }
  }
  const bool has_changed = now != ports_;
  ports_ = std::move(now);
  return has_changed;
}

Json SignalBook::event() const {
  Json list = Json::array();
  for (const auto* signals : {&ifaces_, &ports_}) {
    for (const auto& [topic, signal] : *signals) list.push_back(signal.shown);
  }
  return {{"op", "signals"}, {"signals", std::move(list)}};
}

std::string SignalBook::source_of(const std::string& topic) const {
  for (const auto* signals : {&ifaces_, &ports_}) {
    if (const auto found = signals->find(topic); found != signals->end()) return found->second.source;
  }
  return topic;
}

}  // namespace studio
