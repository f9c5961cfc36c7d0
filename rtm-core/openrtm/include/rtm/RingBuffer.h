// A queue of limited length for the author's own use; connections have theirs. Any thread.
//   RTC::RingBuffer<double> values(16);  values.write(1.5);  double value;  if (values.read(value) == RTC::BufferStatus::BUFFER_OK) ...
#pragma once

#include <coil/Properties.h>
#include <coil/stringutil.h>
#include <rtm/BufferStatus.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <mutex>
#include <optional>
#include <string>

namespace RTC {

template <class DataType>
class RingBuffer {
 public:
  BUFFERSTATUS_ENUM
  static constexpr long default_length = 8;

  explicit RingBuffer(long length = default_length) : length_(places(length)) {}

  // length; write.full_policy: overwrite (as at first), do_nothing, block; read.empty_policy: readback (as at first: the last value again),
  // do_nothing, block; write.timeout, read.timeout [s], 1.
  void init(const coil::Properties& properties) {
    const std::lock_guard lock(mutex_);
    if (long length = 0; coil::stringTo(length, properties.getProperty("length").c_str()) && length > 0) length_ = places(length);
    const std::string full = coil::normalize(properties.getProperty("write.full_policy", "overwrite"));
    when_full_ = full == "block" ? Policy::block : full == "do_nothing" ? Policy::do_nothing : Policy::go_on;
    const std::string empty = coil::normalize(properties.getProperty("read.empty_policy", "readback"));
    when_empty_ = empty == "block" ? Policy::block : empty == "do_nothing" ? Policy::do_nothing : Policy::go_on;
    coil::stringTo(write_timeout_, properties.getProperty("write.timeout").c_str());
    coil::stringTo(read_timeout_, properties.getProperty("read.timeout").c_str());
    shorten();
  }

  std::size_t length() const {
    const std::lock_guard lock(mutex_);
    return length_;
  }
  ReturnCode length(std::size_t length) {
    const std::lock_guard lock(mutex_);
    length_ = std::max<std::size_t>(length, 1);
    shorten();
    return BUFFER_OK;
  }
  ReturnCode reset() {
    const std::lock_guard lock(mutex_);
    values_.clear();
    last_.reset();
    changed_.notify_all();
    return BUFFER_OK;
  }

  // With a time of its own, sec >= 0, a call waits that long, whatever the policy.
  ReturnCode write(const DataType& value, long sec = -1, long nsec = 0) {
    std::unique_lock lock(mutex_);
    if (values_.size() >= length_) {
      if (sec < 0 && when_full_ == Policy::do_nothing) return BUFFER_FULL;
      if (sec < 0 && when_full_ == Policy::go_on) {
        values_.pop_front();
      } else if (!changed_.wait_for(lock, time(sec, nsec, write_timeout_), [&] { return values_.size() < length_; })) {
        return TIMEOUT;
      }
    }
    values_.push_back(value);
    changed_.notify_all();
    return BUFFER_OK;
  }
  ReturnCode put(const DataType& value) { return write(value); }

  ReturnCode read(DataType& value, long sec = -1, long nsec = 0) {
    std::unique_lock lock(mutex_);
    if (values_.empty()) {
      if (sec < 0 && when_empty_ == Policy::go_on && last_) {
        value = *last_;
        return BUFFER_OK;
      }
      if (sec < 0 && when_empty_ != Policy::block) return BUFFER_EMPTY;
      if (!changed_.wait_for(lock, time(sec, nsec, read_timeout_), [&] { return !values_.empty(); })) return TIMEOUT;
    }
    last_ = std::move(values_.front());
    values_.pop_front();
    value = *last_;
    changed_.notify_all();
    return BUFFER_OK;
  }
  // The next value without taking it.
  ReturnCode get(DataType& value) const {
    const std::lock_guard lock(mutex_);
    if (values_.empty()) return BUFFER_EMPTY;
    value = values_.front();
    return BUFFER_OK;
  }

  std::size_t readable() const {
    const std::lock_guard lock(mutex_);
    return values_.size();
  }
  std::size_t writable() const {
    const std::lock_guard lock(mutex_);
    return length_ - values_.size();
  }
  bool empty() const { return readable() == 0; }
  bool full() const { return writable() == 0; }

 private:
  enum class Policy { go_on, do_nothing, block };
  using Seconds = std::chrono::duration<double>;
  static std::size_t places(long length) { return static_cast<std::size_t>(std::max(length, 1L)); }
  static Seconds time(long sec, long nsec, Seconds otherwise) {
    return sec < 0 ? otherwise : Seconds(static_cast<double>(sec) + static_cast<double>(nsec) * 1e-9);
  }
  void shorten() {
    while (values_.size() > length_) values_.pop_front();
  }

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::size_t length_;
  std::deque<DataType> values_{};
  std::optional<DataType> last_{};
  Policy when_full_ = Policy::go_on, when_empty_ = Policy::go_on;
  Seconds write_timeout_{1}, read_timeout_{1};
};

}  // namespace RTC
