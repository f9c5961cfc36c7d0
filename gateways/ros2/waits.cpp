#include "waits.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "names.h"

namespace ros2 {

base::Result<WaitFor> parse_wait_for(const std::string& text) {
  const auto equals = text.find('=');
  const std::string topic = text.substr(0, equals);
  std::string rate = equals == std::string::npos ? "" : text.substr(equals + 1);
  if (rate.ends_with("Hz")) rate.resize(rate.size() - 2);
  char* end = nullptr;
  const double hertz = std::strtod(rate.c_str(), &end);
  if (topic.empty() || rate.empty() || *end != '\0' || !(hertz > 0.001 && hertz <= 10000))
    return base::Error{"expected TOPIC=RATE as in cmd_vel=20Hz, got \"" + text + "\""};
  if (const auto problem = problem_of_name(topic.front() == '/' ? topic : "/" + topic))
    return base::Error{"topic \"" + topic + "\" " + *problem};
  return WaitFor{topic, std::chrono::nanoseconds(std::llround(1e9 / hertz))};
}

void Waits::begin(std::chrono::nanoseconds now, const std::vector<std::string>& topics) {
  now_ = now;
  missing_.clear();
  for (std::size_t i = 0; i < wanted_.size(); ++i) {
    if (now < due_[i]) continue;
    due_[i] = (now / wanted_[i].period + 1) * wanted_[i].period;
    for (const auto& topic : topics) {
      if (topic == wanted_[i].topic || topic.ends_with("/" + wanted_[i].topic)) missing_.insert(topic);
    }
  }
}

void Waits::arrive(const Arrival& arrival) {
  if (!arrival.stamp || *arrival.stamp == now_) missing_.erase(arrival.topic);
}

void Waits::rewind() {
  missing_.clear();
  std::ranges::fill(due_, std::chrono::nanoseconds(0));
}

}  // namespace ros2
