// Commands that a tick waits for (--wait-for cmd_vel=20Hz). Pure but for the clock that it is given; one thread at a time.
//
// A tick waits for a topic at each multiple of its period except 0, at the first tick at or after it. A command with a stamp must carry the
// time of the tick; one without a stamp must arrive after the tick's clock was sent. Other commands of such a topic do not count, so their
// time of arrival has no effect. Time 0 is excluded: the timers of ROS do not run yet, and a stamp of 0 means no stamp.
#pragma once

#include <chrono>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/result.h"
#include "commands.h"

namespace ros2 {

struct WaitFor {
  std::string topic;  // "/leader/cmd_vel", or "cmd_vel" for that of every robot
  std::chrono::nanoseconds period{0};
};
// "cmd_vel=20Hz"; the unit may be left out.
base::Result<WaitFor> parse_wait_for(const std::string& text);

class Waits {
 public:
  explicit Waits(std::vector<WaitFor> wanted) : wanted_(std::move(wanted)) { rewind(); }

  // `topics`: all command topics there are.
  void begin(std::chrono::nanoseconds now, const std::vector<std::string>& topics);
  // True when the command counts.
  bool arrive(const Arrival& arrival);
  bool is_waiting() const { return !missing_.empty(); }
  const std::set<std::string>& missing() const { return missing_; }
  void give_up() { missing_.clear(); }
  // After a reset.
  void rewind();
  static bool is_of(const WaitFor& wanted, const std::string& topic);

 private:
  const std::vector<WaitFor> wanted_;
  std::vector<std::chrono::nanoseconds> due_;
  std::chrono::nanoseconds now_{0};
  std::set<std::string> missing_;
};

}  // namespace ros2
