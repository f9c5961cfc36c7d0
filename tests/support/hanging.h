// For tests of callbacks that do not return: a gate that they stand before, and the log lines that speak of them. Any thread.
#pragma once

#include <rtm/SystemLogger.h>

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <vector>

namespace support {

class Gate {
 public:
  ~Gate() { open(); }
  // Returns when the gate is open.
  void pass() {
    std::unique_lock lock(mutex_);
    ++waiting_;
    changed_.notify_all();
    changed_.wait(lock, [&] { return open_; });
    --waiting_;
    changed_.notify_all();
  }
  void open() {
    std::unique_lock lock(mutex_);
    open_ = true;
    changed_.notify_all();
    changed_.wait(lock, [&] { return waiting_ == 0; });
  }
  // Waits until that many stand before it.
  bool wait_for_visitors(int count = 1) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::seconds(60), [&] { return waiting_ >= count; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool open_ = false;
  int waiting_ = 0;
};

// The warnings and errors since it was made.
class Lines {
 public:
  Lines()
      : id_(RTC::addLogSink(RTC::Logger::RTL_WARN, [this](const RTC::LogRecord& record) {
          const std::scoped_lock lock(mutex_);
          lines_.push_back(std::string(record.name) + ": " + std::string(record.message));
        })) {}
  ~Lines() { RTC::removeLogSink(id_); }
  Lines(const Lines&) = delete;
  Lines& operator=(const Lines&) = delete;
  // A line contains both.
  bool speak_of(const std::string& component, const std::string& callback) const {
    const std::scoped_lock lock(mutex_);
    for (const std::string& line : lines_)
      if (line.find(component) != std::string::npos && line.find(callback) != std::string::npos) return true;
    return false;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<std::string> lines_;
  const RTC::LogSinkId id_;
};

}  // namespace support
