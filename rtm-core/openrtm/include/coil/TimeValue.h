// A length of time in seconds and microseconds, both of the same sign. A value; converts from and to std::chrono.
#pragma once

#include <chrono>
#include <cmath>
#include <ostream>
#include <type_traits>

namespace coil {

class TimeValue {
 public:
  constexpr TimeValue() = default;
  constexpr TimeValue(long sec, long usec) : usec_(static_cast<long long>(sec) * 1000000 + usec) {}
  TimeValue(double seconds) : usec_(std::llround(seconds * 1e6)) {}
  template <class R, class P>
  constexpr TimeValue(std::chrono::duration<R, P> time) : usec_(std::chrono::duration_cast<std::chrono::microseconds>(time).count()) {}

  constexpr long sec() const { return static_cast<long>(usec_ / 1000000); }
  constexpr long usec() const { return static_cast<long>(usec_ % 1000000); }
  void set_time(long sec, long usec) { *this = TimeValue(sec, usec); }
  void set_time(double seconds) { *this = TimeValue(seconds); }
  constexpr double getDouble() const { return static_cast<double>(usec_) * 1e-6; }
  constexpr operator double() const { return getDouble(); }
  // A std::chrono duration made from this would otherwise take the whole seconds for its ticks.
  template <class T, std::enable_if_t<std::is_integral_v<T>, int> = 0>
  operator T() const = delete;
  constexpr operator std::chrono::nanoseconds() const { return std::chrono::microseconds(usec_); }
  constexpr operator std::chrono::microseconds() const { return std::chrono::microseconds(usec_); }
  // 1, 0 or -1.
  constexpr int sign() const { return usec_ > 0 ? 1 : usec_ < 0 ? -1 : 0; }
  // Seconds and microseconds always have the same sign here; kept for sources that call it.
  void normalize() {}

  TimeValue& operator=(double seconds) { return *this = TimeValue(seconds); }
  // Templates, so that an expression with a double is one of doubles.
  template <class T, std::enable_if_t<std::is_same_v<T, TimeValue>, int> = 0>
  friend constexpr TimeValue operator+(T a, T b) {
    return from(a.usec_ + b.usec_);
  }
  template <class T, std::enable_if_t<std::is_same_v<T, TimeValue>, int> = 0>
  friend constexpr TimeValue operator-(T a, T b) {
    return from(a.usec_ - b.usec_);
  }
  template <class T, std::enable_if_t<std::is_same_v<T, TimeValue>, int> = 0>
  friend constexpr bool operator==(T a, T b) {
    return a.usec_ == b.usec_;
  }
  template <class T, std::enable_if_t<std::is_same_v<T, TimeValue>, int> = 0>
  friend constexpr bool operator!=(T a, T b) {
    return a.usec_ != b.usec_;
  }
  template <class T, std::enable_if_t<std::is_same_v<T, TimeValue>, int> = 0>
  friend constexpr bool operator<(T a, T b) {
    return a.usec_ < b.usec_;
  }
  template <class T, std::enable_if_t<std::is_same_v<T, TimeValue>, int> = 0>
  friend constexpr bool operator>(T a, T b) {
    return a.usec_ > b.usec_;
  }
  template <class T, std::enable_if_t<std::is_same_v<T, TimeValue>, int> = 0>
  friend constexpr bool operator<=(T a, T b) {
    return a.usec_ <= b.usec_;
  }
  template <class T, std::enable_if_t<std::is_same_v<T, TimeValue>, int> = 0>
  friend constexpr bool operator>=(T a, T b) {
    return a.usec_ >= b.usec_;
  }

  // In seconds.
  friend std::ostream& operator<<(std::ostream& out, const TimeValue& time) { return out << time.getDouble(); }

 private:
  static constexpr TimeValue from(long long usec) { return TimeValue(std::chrono::microseconds(usec)); }

  long long usec_ = 0;
};

}  // namespace coil
