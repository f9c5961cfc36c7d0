#include "naming.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>

#include "base/plain_file.h"
#include "base/suggestion.h"
#include "base/text.h"
#include "base/yaml_keys.h"
#include "names.h"

namespace ros2 {
namespace {

// Thrown by the readers below, caught in read_naming.
struct WrongEntry {
  YAML::Mark mark;
  std::string what;
};

// `key` is that of the value; empty for a key.
[[noreturn]] void throw_wrong(const YAML::Node& node, const std::string& key, const std::string& expected) {
  const std::string got = node.IsScalar()     ? base::in_quotes(node.Scalar())
                          : node.IsMap()      ? "a map"
                          : node.IsSequence() ? "a list"
                                              : "nothing";
  throw WrongEntry{node.Mark(), (key.empty() ? "" : key + ": ") + "expected " + expected + ", got " + got};
}

std::string naming_text(const YAML::Node& node, const std::string& key, const char* what) {
  if (!node.IsScalar()) throw_wrong(node, key, what);
  return node.Scalar();
}

[[noreturn]] void throw_unknown(const YAML::Node& key_node, const std::string& key, const std::vector<std::string>& known) {
  const auto meant = base::suggestion(key, known);
  const auto expected = known.size() < 2 ? known : std::vector<std::string>(known.begin(), known.end() - 1);
  throw WrongEntry{key_node.Mark(), "unknown key " + base::in_quotes(key) +
                                        (meant.empty() ? "; expected " + base::join(expected, ", ") + " or " + known.back() : meant)};
}

double naming_number(const YAML::Node& node, const std::string& key, double min, double max, const char* what) {
  double value = 0;
  if (!node.IsScalar() || !YAML::convert<double>::decode(node, value) || !(value >= min && value <= max)) throw_wrong(node, key, what);
  return value;
}

double naming_integer(const YAML::Node& node, const std::string& key, double min, double max, const char* what) {
  const double value = naming_number(node, key, min, max, what);
  if (value != std::floor(value)) throw_wrong(node, key, what);
  return value;
}

bool naming_flag(const YAML::Node& node, const std::string& key) {
  bool value = false;
  if (!node.IsScalar() || !YAML::convert<bool>::decode(node, value)) throw_wrong(node, key, "true or false");
  return value;
}

std::string full_name(const YAML::Node& node, const std::string& key, bool may_be_root) {
  std::string name = naming_text(node, key, "a name");
  if (may_be_root && (name.empty() || name == "/")) return "/";
  const auto problem = problem_of_name(name.starts_with('/') ? name : "/" + name);
  if (problem) throw WrongEntry{node.Mark(), key + ": " + base::in_quotes(name) + " " + *problem};
  return may_be_root && !name.starts_with('/') ? "/" + name : name;
}

RobotNames robot_names(const std::string& model, const YAML::Node& node) {
  if (!node.IsMap()) throw_wrong(node, model, "namespace or frame_prefix");
  RobotNames names{"/" + tokens(model), tokens(model) + "/"};
  for (const auto& entry : node) {
    const auto key = naming_text(entry.first, "", "namespace or frame_prefix");
    if (key == "namespace") {
      names.space = full_name(entry.second, key, true);
    } else if (key == "frame_prefix") {
      names.frame_prefix = naming_text(entry.second, key, "a prefix");
    } else {
      throw_unknown(entry.first, key, {"namespace", "frame_prefix"});
    }
  }
  return names;
}

void read_topic_key(TopicEntry& topic, const std::string& key, const YAML::Node& key_node, const YAML::Node& value) {
  if (key == "iface") {
    topic.iface = naming_text(value, key, "the name of an iface");
  } else if (key == "ros_type_name") {
    topic.type = naming_text(value, key, "a type such as sensor_msgs/msg/LaserScan");
  } else if (key == "ros_topic_name") {
    topic.topic = full_name(value, key, false);
  } else if (key == "frame_id") {
    topic.frame = naming_text(value, key, "a frame");
  } else if (key == "rate") {
    topic.rate = naming_number(value, key, 1e-3, 1e6, "a rate in Hz");
  } else if (key == "publisher_queue") {
    topic.depth = static_cast<std::size_t>(naming_integer(value, key, 1, 10000, "a number from 1 to 10000"));
  } else if (key == "durability") {
    const auto text = naming_text(value, key, "volatile or transient_local");
    if (text != "volatile" && text != "transient_local") throw_wrong(value, key, "volatile or transient_local");
    topic.is_transient = text == "transient_local";
  } else if (key == "served") {
    topic.is_served = naming_flag(value, key);
  } else {
    throw_unknown(key_node, key,
                  {"iface", "ros_type_name", "ros_topic_name", "frame_id", "rate", "publisher_queue", "durability", "served"});
  }
}

TopicEntry topic_entry(const YAML::Node& node) {
  if (!node.IsMap()) throw_wrong(node, "topics", "entries with iface");
  TopicEntry topic;
  for (const auto& entry : node) read_topic_key(topic, naming_text(entry.first, "", "a key"), entry.first, entry.second);
  if (topic.iface.empty()) throw WrongEntry{node.Mark(), "iface is missing"};
  if (topic.topic && topic.type.empty())
    throw WrongEntry{node.Mark(), "ros_topic_name needs ros_type_name: an iface can have several topics"};
  return topic;
}

Naming naming_of(const YAML::Node& root) {
  if (!root.IsMap()) throw_wrong(root, "", "domain, clock_rate, robots or topics");
  Naming naming;
  for (const auto& entry : root) {
    const auto key = naming_text(entry.first, "", "a key");
    if (key == "domain") {
      naming.domain = static_cast<std::uint32_t>(naming_integer(entry.second, key, 0, 232, "a domain from 0 to 232"));
    } else if (key == "clock_rate") {
      naming.clock_rate = naming_number(entry.second, key, 0, 10000, "a rate from 0 to 10000 Hz");
    } else if (key == "robots") {
      if (!entry.second.IsMap()) throw_wrong(entry.second, key, "MODEL: {namespace: ...}");
      for (const auto& robot : entry.second) {
        const auto model = naming_text(robot.first, key, "the name of a model");
        naming.robots[model] = robot_names(model, robot.second);
      }
    } else if (key == "topics") {
      if (!entry.second.IsSequence()) throw_wrong(entry.second, key, "a list");
      for (const auto& topic : entry.second) naming.topics.push_back(topic_entry(topic));
    } else {
      throw_unknown(entry.first, key, {"domain", "clock_rate", "robots", "topics"});
    }
  }
  return naming;
}

}  // namespace

RobotNames Naming::names_of(const std::string& model) const {
  if (const auto given = spaces.find(model); given != spaces.end())
    return {given->second, has_tf_per_robot || given->second == "/" ? "" : given->second.substr(1) + "/"};
  if (const auto found = robots.find(model); found != robots.end()) return found->second;
  if (!root_robot.empty() && model == root_robot) return {"/", ""};
  return {"/" + tokens(model), has_tf_per_robot ? "" : tokens(model) + "/"};
}

const TopicEntry* Naming::entry(const std::string& iface, const std::string& type) const {
  const auto found = std::ranges::find_if(
      topics, [&](const TopicEntry& topic) { return topic.iface == iface && (topic.type.empty() || topic.type == type); });
  return found == topics.end() ? nullptr : &*found;
}

base::Result<Naming> read_naming(const std::string& path) {
  if (const auto problem = base::file_problem(path); !problem.empty())
    return base::Error{"mapping " + base::in_quotes(path) + ": " + problem};
  try {
    return naming_of(yaml::load_file(path));
  } catch (const WrongEntry& wrong) {
    return base::Error{path + ":" + std::to_string(std::max(wrong.mark.line, 0) + 1) + ": " + wrong.what};
  } catch (const YAML::BadFile&) {
    return base::Error{"mapping " + base::in_quotes(path) + " cannot be read"};
  } catch (const YAML::Exception& wrong) {
    return base::Error{path + ":" + std::to_string(wrong.mark.line + 1) + ": " + wrong.msg};
  }
}

}  // namespace ros2
