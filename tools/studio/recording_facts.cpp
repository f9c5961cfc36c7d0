#include "studio/recording_facts.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "base/text.h"
#include "recording/mcap/bytes.h"
#include "recording/ring.h"
#include "recording/sample_text.h"

namespace studio {
namespace {

using base::Error;
using base::Result;
using std::chrono::nanoseconds;

constexpr std::size_t max_log_lines = 5000;            // of logs that a page is given
constexpr std::size_t max_states = 100000;             // changes of state, of all components
constexpr const char* path_of_unsaved = "/recorded/";  // of a component that no profile names

std::string text_in(const mcap::Texts& texts, const std::string& key) {
  const auto found = texts.find(key);
  return found == texts.end() ? "" : found->second;
}

std::string after_dot(const std::string& name) { return name.substr(name.rfind('.') + 1); }

std::string type_of(const tools::SavedComponent& component) {  // RTC:vendor:category:type:version
  const auto parts = base::split_list(component.id, ':');
  return parts.size() > 3 ? parts[3] : component.instance;
}

// Gathers the components of the profile, and those that only channels tell of.
class Components {
 public:
  explicit Components(const tools::SavedSystem& system) : system_(system) {
    for (const auto& saved : system.components) {
      const auto parts = base::split_list(saved.id, ':');
      const auto part = [&](std::size_t i) { return i < parts.size() ? parts[i] : std::string(); };
      auto& one = add(saved.instance, type_of(saved), "/" + saved.path_uri);
      one["vendor"] = part(1);
      one["category"] = part(2);
      one["version"] = part(4);
      one["active_set"] = saved.active_set;
      one["composite"] = saved.composite_type != "None" && !saved.composite_type.empty();
      one["members"] = saved.participants;
      for (std::size_t i = 0; i < saved.contexts.size(); ++i) one["contexts"].push_back(context(saved.contexts[i], i));
      for (const auto& port : saved.data_ports)
        add_port(saved.instance, after_dot(port.name), "in", "");  // unless something says otherwise
      for (const auto& port : saved.service_ports) add_port(saved.instance, after_dot(port.name), "service", "");
    }
    for (const auto& connector : system.connectors) {
      if (!connector.is_data) continue;
      add_port(connector.source.instance, after_dot(connector.source.port_name), "out", connector.data_type);
      add_port(connector.target.instance, after_dot(connector.target.port_name), "in", connector.data_type);
    }
  }

  // Of a channel; returns the path of its component.
  std::string take(const mcap::Texts& metadata) {
    const auto name = text_in(metadata, "component");
    if (!by_name_.contains(name)) add(name, text_in(metadata, "component_type"), path_of_unsaved + name + ".rtc");
    if (const auto port = text_in(metadata, "port"); !port.empty())
      add_port(name, port, text_in(metadata, "port_type") == "DataInPort" ? "in" : "out", text_in(metadata, "data_type"));
    return path(name);
  }

  std::string path(const std::string& instance) const {
    const auto found = by_name_.find(instance);
    return found == by_name_.end() ? "" : found->second.value("path", "");
  }

  Json connections() const {
    Json list = Json::array();
    for (const auto& connector : system_.connectors) {
      Json properties = Json::object();
      for (const auto& [key, value] : connector.properties) properties[key] = value;
      list.push_back({{"id", connector.id},
                      {"name", connector.name},
                      {"ports", Json::array({path(connector.source.instance) + ":" + after_dot(connector.source.port_name),
                                             path(connector.target.instance) + ":" + after_dot(connector.target.port_name)})},
                      {"absent", Json::array()},
                      {"properties", std::move(properties)}});
    }
    return list;
  }

  Json list() const {
    Json all = Json::array();
    for (const auto& name : names_) all.push_back(by_name_.at(name));
    return all;
  }

 private:
  static Json context(const tools::SavedContext& saved, std::size_t index) {
    return {{"index", index},  {"owned", true},        {"kind", saved.kind}, {"rate", base::parse_number(saved.rate).value_or(0)},
            {"running", true}, {"state", saved.state}, {"type", ""}};
  }
  Json& add(const std::string& instance, const std::string& type, const std::string& path) {
    if (!by_name_.contains(instance)) names_.push_back(instance);
    return by_name_[instance] = {{"path", path},
                                 {"instance", instance},
                                 {"type", type},
                                 {"category", ""},
                                 {"vendor", ""},
                                 {"version", ""},
                                 {"description", ""},
                                 {"problem", ""},
                                 {"state", "Unknown"},
                                 {"composite", false},
                                 {"members", Json::array()},
                                 {"active_set", ""},
                                 {"contexts", Json::array()},
                                 {"ports", Json::array()}};
  }
  void add_port(const std::string& instance, const std::string& name, const char* kind, const std::string& type) {
    const auto found = by_name_.find(instance);
    if (found == by_name_.end()) return;
    for (auto& port : found->second["ports"]) {
      if (port["name"] != name) continue;
      port["kind"] = kind;
      if (!type.empty()) port["data_type"] = type;
      return;
    }
    found->second["ports"].push_back({{"name", name}, {"kind", kind}, {"data_type", type}, {"interfaces", Json::array()}});
  }

  const tools::SavedSystem& system_;
  std::vector<std::string> names_;  // in their order
  std::map<std::string, Json> by_name_;
};

// ---- what was said of components ----

const char* level_text(int level) {
  constexpr int debug = 10, info = 20, warn = 30;  // of rcl_interfaces/msg/Log
  return level <= debug ? "DEBUG" : level <= info ? "INFO" : level <= warn ? "WARN" : "ERROR";
}

class Facts {
 public:
  Facts(mcap::Reader& reader, RecordingFacts& facts) : reader_(reader), facts_(facts) {}

  Result<void> read() {
    if (const auto done = read_run(); !done) return done;
    auto saved = read_profile();
    if (!saved) return saved.error();
    Components components(*saved);
    for (const auto& [id, channel] : reader_.channels()) take_channel(id, channel, components);
    for (const auto& one : saved->components) facts_.saved[components.path(one.instance)] = one;
    facts_.components = components.list();
    facts_.connections = components.connections();
    if (const auto told = read_told(); !told) return told;
    for (const auto& chunk : reader_.broken_chunks()) facts_.damage += (facts_.damage.empty() ? "" : "; ") + facts_.text_of(chunk);
    return {};
  }

 private:
  Result<void> read_run() {
    const auto& statistics = reader_.statistics();
    facts_.from = to_nanoseconds(statistics.first);
    facts_.to = to_nanoseconds(statistics.last);
    if (reader_.damage()) facts_.damage = *reader_.damage();
    reader_.leave_out_broken_chunks();
    auto metadata = reader_.metadata();
    if (!metadata) return metadata.error();
    for (const auto& one : *metadata) {
      if (one.name != "run") continue;
      facts_.world = text_in(one.texts, "world");
      if (text_in(one.texts, "clock") == "wall") facts_.zero = facts_.from;
    }
    return {};
  }

  Result<tools::SavedSystem> read_profile() {
    const auto there = reader_.attachments();
    if (std::none_of(there.begin(), there.end(), [](const auto& entry) { return entry.name == "system.xml"; })) return tools::SavedSystem();
    const auto attachment = reader_.attachment("system.xml");
    if (!attachment) return attachment.error();
    return tools::parse_xml(attachment->data, facts_.file + ": system.xml");
  }

  void take_channel(std::uint16_t id, const mcap::Channel& channel, Components& components) {
    const auto& metadata = channel.metadata;
    if (const auto iface = text_in(metadata, "iface"); !iface.empty()) return take_iface(channel, iface);
    if (channel.topic == "/log") logs_ = id;
    if (const auto model = text_in(metadata, "model"); !model.empty())
      facts_.signals.push_back({{"topic", channel.topic}, {"kind", "iface"}, {"type", "joints"}, {"model", model}});
    if (text_in(metadata, "component").empty()) return;
    const auto path = components.take(metadata);
    if (channel.topic.starts_with("/rtc/")) {
      if (channel.topic.ends_with("/state")) states_[id] = path;
      return;
    }
    if (metadata.contains("port"))
      facts_.signals.push_back({{"topic", channel.topic}, {"kind", "port"}, {"type", text_in(metadata, "data_type")}, {"component", path}});
  }

  // An iface with several channels is one.
  void take_iface(const mcap::Channel& channel, const std::string& iface) {
    const auto type = text_in(channel.metadata, "iface_type");
    if (!ifaces_.insert(type + ":" + iface).second) return;
    const auto model = iface.substr(0, iface.find("::"));
    const bool is_picture = type == "camera" || type == "depth";
    facts_.ifaces.push_back({{"type", type}, {"name", iface}, {"model", model}, {"info", Json::object()}});
    facts_.signals.push_back({{"topic", iface_topic(type, iface)},
                              {"kind", is_picture ? "image" : "iface"},
                              {"type", type},
                              {"iface", iface},
                              {"model", model}});
  }

  Result<void> read_told() {
    mcap::Query query;
    for (const auto& [id, path] : states_) query.channels.push_back(id);
    if (logs_) query.channels.push_back(*logs_);
    if (query.channels.empty()) return {};
    recorder::SampleValues values(reader_);
    reader_.seek(query);
    for (std::size_t changes = 0;;) {
      const auto message = reader_.next();
      if (!message) return message.error();
      if (!message->has_value()) return {};
      if ((*message)->channel == logs_ && facts_.lines.size() >= max_log_lines) {
        ++facts_.lines_left_out;
        continue;
      }
      const auto value = values.of(**message);
      if (!value) return value.error();
      const double time = facts_.seconds(to_nanoseconds((*message)->log_time));
      if ((*message)->channel == logs_) {
        facts_.lines.push_back({time, level_text(value->value("level", 0)), value->value("name", ""), value->value("msg", "")});
      } else if (++changes <= max_states) {
        facts_.states[states_.at((*message)->channel)].push_back({time, value->value("state", "")});
      }
    }
  }

  mcap::Reader& reader_;
  RecordingFacts& facts_;
  std::map<std::uint16_t, std::string> states_;  // channels, and the paths of their components
  std::optional<std::uint16_t> logs_;
  std::set<std::string> ifaces_;
};

}  // namespace

nanoseconds RecordingFacts::time_of(double seconds) const {
  const double length = std::chrono::duration<double>(to - zero).count();
  return zero + nanoseconds(std::llround(std::clamp(seconds, this->seconds(from), std::max(length, this->seconds(from))) * 1e9));
}

std::string RecordingFacts::text_of(const mcap::Reader::BrokenChunk& chunk) const {
  const auto text = [this](mcap::Time time) { return base::format_number(seconds(to_nanoseconds(time))); };
  return "from " + text(chunk.first) + " to " + text(chunk.last) + " s: " + chunk.problem;
}

Result<RecordingFacts> RecordingFacts::read(const std::string& file) {
  auto reader = recorder::open_recording(file);
  if (!reader) return reader.error();
  RecordingFacts facts;
  facts.file = file;
  try {
    if (const auto done = Facts(*reader, facts).read(); !done) return done.error();
  } catch (const Json::exception& e) {
    return Error{base::in_quotes(file) + ": a sample has not the members that its channel has in recordings of rtse: " + e.what()};
  }
  return facts;
}

bool is_recording(const std::string& file) { return recorder::is_recording(file) || file.ends_with(".mcap"); }

nanoseconds to_nanoseconds(mcap::Time time) {
  return nanoseconds(static_cast<std::int64_t>(std::min<std::uint64_t>(time.count(), INT64_MAX)));
}

mcap::Time to_mcap_time(nanoseconds time) { return mcap::Time(static_cast<std::uint64_t>(std::max<std::int64_t>(time.count(), 0))); }

std::string iface_topic(const std::string& type, const std::string& name) {
  std::string path = name;
  for (auto at = path.find("::"); at != std::string::npos; at = path.find("::", at)) path.replace(at, 2, "/");
  return "/sim/" + type + "/" + path;
}

}  // namespace studio
