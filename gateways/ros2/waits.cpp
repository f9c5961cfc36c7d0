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
      if (is_of(wanted_[i], topic)) missing_.insert(topic);
    }
  }
}

bool Waits::is_of(const WaitFor& wanted, const std::string& topic) { return topic == wanted.topic || topic.ends_with("/" + wanted.topic); }

bool Waits::arrive(const Arrival& arrival) {
  const bool is_awaited = std::ranges::any_of(wanted_, [&](const WaitFor& wanted) { return is_of(wanted, arrival.topic); });
  if (!is_awaited) return true;
  if (arrival.stamp && *arrival.stamp != now_) return false;
  return missing_.erase(arrival.topic) > 0;
}

void Waits::rewind() {
  missing_.clear();
  due_.clear();
  for (const auto& wanted : wanted_) due_.push_back(wanted.period);
}

}  // namespace ros2
