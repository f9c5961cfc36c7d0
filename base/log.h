// The log of a process. Messages go to stderr, one line each, unless a sink is set. Any thread; never with a lock held.
#pragma once

#include <spdlog/fmt/fmt.h>

#include <functional>
#include <string>
#include <string_view>

namespace base {

enum class Level { paranoid, verbose, trace, debug, info, warn, error, fatal, silent };

struct LogRecord {
  Level level;
  std::string_view name;  // who speaks: a component, a port, a part of the simulator
  std::string_view message;
};

// Records below this level are dropped before they are formatted. Default: info.
void set_log_level(Level level);
Level log_level();
bool is_logged(Level level);

// Everything goes to `sink` instead of stderr; an empty one restores stderr. The sink is called from any thread, several at once.
void set_log_sink(std::function<void(const LogRecord&)> sink);

void log_text(Level level, std::string_view name, std::string_view message);

template <class... Args>
void log(Level level, std::string_view name, fmt::format_string<Args...> format, Args&&... args) {
  if (is_logged(level)) log_text(level, name, fmt::format(format, std::forward<Args>(args)...));
}

}  // namespace base
