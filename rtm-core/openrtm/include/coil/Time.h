// Sleeping and the wall clock of the 1.x API. Any thread.
#pragma once

#include <sys/time.h>
#include <unistd.h>

#include <chrono>
#include <thread>

#include "coil/TimeValue.h"

namespace coil {

inline unsigned int sleep(unsigned int seconds) { return ::sleep(seconds); }
inline int sleep(TimeValue interval) {
  std::this_thread::sleep_for(std::chrono::nanoseconds(interval));
  return 0;
}
template <class R, class P>
void sleep(std::chrono::duration<R, P> interval) {
  std::this_thread::sleep_for(interval);
}
inline int usleep(useconds_t microseconds) {
  std::this_thread::sleep_for(std::chrono::microseconds(microseconds));
  return 0;
}
inline int gettimeofday(timeval* tv, void* tz) { return ::gettimeofday(tv, static_cast<struct timezone*>(tz)); }
inline TimeValue gettimeofday() { return TimeValue(std::chrono::system_clock::now().time_since_epoch()); }
// Sets the clock of the computer; 0 or -1 with errno (the caller needs the right to).
inline int settimeofday(const timeval* tv, const struct timezone* tz) { return ::settimeofday(tv, tz); }
inline TimeValue clock() { return TimeValue(std::chrono::steady_clock::now().time_since_epoch()); }

}  // namespace coil
