#include "log_topic.h"

#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "base/guarded.h"
#include "base/log_stderr.h"
#include "node.h"
#include "robot_topics.h"
#include "ros/messages.h"

namespace ros2 {
namespace {

constexpr std::size_t max_waiting = 1000;

std::uint8_t level_of_ros(base::Level level) {
  switch (level) {
    case base::Level::fatal:
      return 50;
    case base::Level::error:
      return 40;
    case base::Level::warn:
      return 30;
    case base::Level::info:
      return 20;
    default:
      return 10;
  }
}

}  // namespace

struct LogTopic::Lines {
  base::Guarded<std::vector<ros::Log>, base::Rank::queue> waiting;
};

LogTopic::LogTopic() : lines_(std::make_shared<Lines>()) {
  base::set_log_sink([lines = lines_](const base::LogRecord& record) {
    base::log_to_stderr(record);
    ros::Log line{.stamp = ros::to_time(std::chrono::system_clock::now().time_since_epoch()),
                  .level = level_of_ros(record.level),
                  .logger = gateway_node.name,
                  .msg = std::string(record.message)};
    auto waiting = lines->waiting.lock();
    if (waiting->size() < max_waiting) waiting->push_back(std::move(line));
  });
}

LogTopic::~LogTopic() { base::set_log_sink({}); }

void LogTopic::send(Writer& writer) {
  std::vector<ros::Log> lines;
  lines_->waiting.lock()->swap(lines);
  for (const auto& line : lines) publish(writer, line);
}

}  // namespace ros2
