#include "unknown_names.h"

#include <algorithm>

#include "base/suggestion.h"
#include "base/text.h"

namespace ros2 {

std::vector<std::string> lines_of_unknown_names(const Naming& naming, const std::vector<WaitFor>& waits, const KnownNames& known) {
  std::vector<std::string> lines;
  const auto expect = [&](const std::string& name, const std::vector<std::string>& names, const std::string& what) {
    const bool is_known = std::ranges::find(names, name) != names.end();
    if (!is_known) lines.push_back(what + " " + base::in_quotes(name) + base::suggestion(name, names));
    return is_known;
  };
  if (!naming.root_robot.empty()) expect(naming.root_robot, known.robots, "--root: the world has no robot");
  for (const auto& [robot, names] : naming.robots) expect(robot, known.robots, "--config: robots: the world has no robot");
  for (const auto& topic : naming.topics) {
    if (!expect(topic.iface, known.ifaces, "--config: topics: the world has no iface") || topic.type.empty()) continue;
    const auto types = known.types.find(topic.iface);
    if (types != known.types.end())
      expect(topic.type, types->second, "--config: topics: iface " + topic.iface + " has no topic of the type");
  }
  for (const auto& wait : waits) {
    const auto is_of = [&](const std::string& topic) { return Waits::is_of(wait, topic); };
    if (std::ranges::none_of(known.command_topics, is_of))
      expect(wait.topic, known.command_topics, "--wait-for: time does not wait, because no robot has the command topic");
  }
  return lines;
}

std::vector<std::string> lines_of_shared_names(const UsedNames& used) {
  std::vector<std::string> lines;
  for (const auto& [topic, types] : used.writers) {
    const bool is_command = std::ranges::find(used.commands, topic) != used.commands.end();
    if (types.size() < 2 && !is_command) continue;
    const std::string what = is_command ? "receives commands and sends " : "has several types: ";
    lines.push_back("--config: topic " + topic + " " + what + base::join({types.begin(), types.end()}, " and ") +
                    "; give one of them another ros_topic_name");
  }
  std::map<std::string, std::string> owners;  // of frames, by prefix
  for (const auto& [robot, prefix] : used.frame_prefixes) {
    const auto [owner, is_first] = owners.emplace(prefix, robot);
    if (!is_first)
      lines.push_back("--config: robots " + owner->second + " and " + robot + " have the frame_prefix " + base::in_quotes(prefix) +
                      ", so their frames on /tf are the same; give one of them another one");
  }
  return lines;
}

}  // namespace ros2
