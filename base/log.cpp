#include "base/log.h"

#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <atomic>
#include <memory>

#include "base/guarded.h"
#include "base/log_stderr.h"
#include "base/terminal.h"

namespace base {
namespace {

using Sink = std::function<void(const LogRecord&)>;

// The log is the one thing a process has exactly one of.
struct Log {
  std::atomic<Level> level{Level::info};
  Guarded<std::shared_ptr<const Sink>, Rank::log> sink;
  std::shared_ptr<spdlog::logger> standard_error = [] {
    auto logger = std::make_shared<spdlog::logger>("rtm", std::make_shared<spdlog::sinks::stderr_sink_mt>());
    logger->set_level(spdlog::level::trace);
    logger->set_pattern("%H:%M:%S.%e %v");
    logger->flush_on(spdlog::level::trace);
    return logger;
  }();
};

Log& the_log() {
  static Log& log = *std::make_unique<Log>().release();  // lives as long as the process: threads log while statics are destroyed
  return log;
}

std::string_view level_name(Level level) {
  switch (level) {
    case Level::fatal:
      return "fatal";
    case Level::error:
      return "error";
    case Level::warn:
      return "warning";
    case Level::info:
      return "info";
    case Level::debug:
      return "debug";
    case Level::trace:
      return "trace";
    case Level::verbose:
      return "verbose";
    case Level::paranoid:
      return "paranoid";
    case Level::silent:
      break;
  }
  return "";
}

}  // namespace

void set_log_level(Level level) { the_log().level.store(level, std::memory_order_relaxed); }
Level log_level() { return the_log().level.load(std::memory_order_relaxed); }
bool is_logged(Level level) { return level >= log_level() && level != Level::silent; }

void set_log_sink(Sink sink) {
  auto next = sink ? std::make_shared<const Sink>(std::move(sink)) : nullptr;
  the_log().sink.lock()->swap(next);  // the one before ends without the lock
}

void log_text(Level level, std::string_view name, std::string_view message) {
  if (!is_logged(level)) return;
  auto& log = the_log();
  expect_no_data_held();
  if (const auto sink = log.sink.snapshot()) return (*sink)({level, name, message});
  log_to_stderr({level, name, message});
}

void log_to_stderr(const LogRecord& record) {
  the_log().standard_error->log(spdlog::level::info, "{}: {}: {}", level_name(record.level), for_terminal(record.name),
                                for_terminal(record.message));
}

}  // namespace base
