// RTC::Logger and the RTC_* macros: what components log with. Any thread; never log while a lock is held.
// A macro formats its text only if somebody listens at its level. Records go where the manager's logger.* keys say (default: stderr), to
// the sinks added with addLogSink, and carry the simulated time beside the wall time while the calling thread runs on a simulated clock.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

namespace RTC {

class Logger;

namespace detail {
#ifdef __GNUC__
__attribute__((format(printf, 1, 2)))
#endif
std::string
format_log_text(const char* format, ...);
}  // namespace detail

struct LogRecord {
  int level;  // Logger::RTL_*
  std::string_view name;
  std::string_view message;
  std::chrono::nanoseconds time;                      // Unix time
  std::optional<std::chrono::nanoseconds> simulated;  // the calling thread's clock, if that is not the system clock
};

// Every record at least as important as `level` is handed to the sink, on the thread that logs, several at once; the sink must not log.
// After removeLogSink returns no call begins (one that runs may still end).
using LogSink = std::function<void(const LogRecord&)>;
using LogSinkId = std::uint64_t;
LogSinkId addLogSink(int level, LogSink sink);
void removeLogSink(LogSinkId id);

// Where log lines go and how they look; the manager fills it from the logger.* keys.
struct LogSettings {
  bool enabled = true;
  int level = 4;                                  // Logger::RTL_INFO
  std::vector<std::string> files = {"stderr"};    // "stderr", "stdout", else names of files (appended to)
  std::string date_format = "%b %d %H:%M:%S.%Q";  // strftime; %Q milliseconds, %q microseconds
  bool colored = false;
  std::string clock{};  // of coil::ClockManager: "logical", "adjusted"; else the system's
};
// Replaces the settings of the whole process. Returns one line per file that cannot be written.
std::vector<std::string> setLogSettings(const LogSettings& settings);
// Lines also go to this stream buffer until it is removed; it is called by one thread at a time.
void addLogStreamBuffer(std::streambuf* buffer);
void removeLogStreamBuffer(std::streambuf* buffer);

class Logger {
 public:
  enum LogLevel { RTL_SILENT, RTL_FATAL, RTL_ERROR, RTL_WARN, RTL_INFO, RTL_DEBUG, RTL_TRACE, RTL_VERBOSE, RTL_PARANOID };

  // One line, written when the object dies: rtclog.level(Logger::RTL_INFO) << value;
  class Line final : public std::ostringstream {
   public:
    Line(const Logger& logger, int level) : logger_(logger), level_(level) {}
    ~Line() override;

   private:
    const Logger& logger_;
    int level_;
  };

  explicit Logger(const char* name = "") : name_(name ? name : "") {}
  explicit Logger(const std::string& name) : name_(name) {}

  void setName(const char* name) { name_ = name ? name : ""; }
  const std::string& getName() const { return name_; }
  // A level of this logger alone, which then counts instead of the process's. False for an unknown name; nothing changes then.
  bool setLevel(int level);
  bool setLevel(const char* level);
  int getLevel() const;
  // Kept for sources that call them: the date is the process's affair and whole lines are always written at once.
  void setDateFormat(const char* format);
  void setClockType(const std::string&) {}
  void enableLock() {}
  void disableLock() {}
  void lock() {}
  void unlock() {}

  bool isValid(int level) const;
  void write(int level, const std::string& text) const;
  Line level(int level) const { return Line(*this, level); }

  // "INFO" or "info" or "4" -> RTL_INFO; RTL_SILENT for anything unknown.
  static int strToLevel(const char* text);
  static std::optional<int> parseLevel(std::string_view text);
  static const char* getLevelString(int level);

 private:
  std::string name_;
  int own_level_ = -1;
};

}  // namespace RTC

#define RTC_LOG(LV, fmt)                                                          \
  do {                                                                            \
    if (rtclog.isValid(LV)) rtclog.write(LV, ::RTC::detail::format_log_text fmt); \
  } while (false)
// `stream` is "a << b": parentheses would change it.
#define RTC_LOG_STR(LV, stream)                                        \
  do {                                                                 \
    if (rtclog.isValid(LV)) {                                          \
      std::ostringstream rtclog_text_;                                 \
      rtclog_text_ << stream; /* NOLINT(bugprone-macro-parentheses) */ \
      rtclog.write(LV, rtclog_text_.str());                            \
    }                                                                  \
  } while (false)

#define RTC_FATAL(fmt) RTC_LOG(::RTC::Logger::RTL_FATAL, fmt)
#define RTC_ERROR(fmt) RTC_LOG(::RTC::Logger::RTL_ERROR, fmt)
#define RTC_WARN(fmt) RTC_LOG(::RTC::Logger::RTL_WARN, fmt)
#define RTC_INFO(fmt) RTC_LOG(::RTC::Logger::RTL_INFO, fmt)
#define RTC_DEBUG(fmt) RTC_LOG(::RTC::Logger::RTL_DEBUG, fmt)
#define RTC_TRACE(fmt) RTC_LOG(::RTC::Logger::RTL_TRACE, fmt)
#define RTC_VERBOSE(fmt) RTC_LOG(::RTC::Logger::RTL_VERBOSE, fmt)
#define RTC_PARANOID(fmt) RTC_LOG(::RTC::Logger::RTL_PARANOID, fmt)
#define RTC_FATAL_STR(str) RTC_LOG_STR(::RTC::Logger::RTL_FATAL, str)
#define RTC_ERROR_STR(str) RTC_LOG_STR(::RTC::Logger::RTL_ERROR, str)
#define RTC_WARN_STR(str) RTC_LOG_STR(::RTC::Logger::RTL_WARN, str)
#define RTC_INFO_STR(str) RTC_LOG_STR(::RTC::Logger::RTL_INFO, str)
#define RTC_DEBUG_STR(str) RTC_LOG_STR(::RTC::Logger::RTL_DEBUG, str)
#define RTC_TRACE_STR(str) RTC_LOG_STR(::RTC::Logger::RTL_TRACE, str)
#define RTC_VERBOSE_STR(str) RTC_LOG_STR(::RTC::Logger::RTL_VERBOSE, str)
#define RTC_PARANOID_STR(str) RTC_LOG_STR(::RTC::Logger::RTL_PARANOID, str)
