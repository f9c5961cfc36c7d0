#include "ros/messages.h"

#include <algorithm>

namespace ros {

Time to_time(std::chrono::nanoseconds time) {
  constexpr std::int64_t second = 1'000'000'000;
  const std::int64_t ns = std::max<std::int64_t>(time.count(), 0);
  return {static_cast<std::int32_t>(std::min<std::int64_t>(ns / second, INT32_MAX)), static_cast<std::uint32_t>(ns % second)};
}

}  // namespace ros
