#include "rtm/SystemLogger.h"

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <ctime>
#include <deque>
#include <fstream>
#include <iostream>
#include <memory>
#include <optional>
#include <streambuf>
#include <thread>

#include <coil/ClockManager.h>
#include <coil/Logger.h>

#include "base/clock.h"
#include "base/guarded.h"
#include "base/log.h"
#include "base/terminal.h"
#include "base/text.h"

namespace RTC {
namespace {

constexpr const char* level_names[] = {"SILENT", "FATAL", "ERROR", "WARN", "INFO", "DEBUG", "TRACE", "VERBOSE", "PARANOID"};

bool is_level(int level) { return level >= Logger::RTL_SILENT && level <= Logger::RTL_PARANOID; }
// The scales run in opposite directions: here silent is 0, in base it is the last.
base::Level to_base(int level) { return static_cast<base::Level>(Logger::RTL_PARANOID - level); }
int from_base(base::Level level) { return Logger::RTL_PARANOID - static_cast<int>(level); }

struct Sink {
  LogSinkId id;
  int level;
  LogSink call;
};
using Sinks = std::vector<std::shared_ptr<const Sink>>;

// One place that takes whole lines. Written to by one thread at a time.
struct Output {
  std::ostream stream;
  std::unique_ptr<std::filebuf> file;
  explicit Output(std::streambuf* buffer) : stream(buffer) {}
};

std::string format_date(const std::string& format, std::chrono::nanoseconds time) {
  const auto since_epoch = time.count();
  const std::time_t seconds = static_cast<std::time_t>(since_epoch / 1'000'000'000);
  const auto nanoseconds = static_cast<unsigned>(since_epoch % 1'000'000'000);
  std::string expanded;
  for (std::size_t i = 0; i < format.size(); ++i) {
    if (format[i] != '%' || i + 1 == format.size()) {
      expanded += format[i];
      continue;
    }
    const char next = format[++i];
    char digits[8];
    if (next == 'Q') {
      std::snprintf(digits, sizeof digits, "%03u", nanoseconds / 1'000'000 % 1000);
      expanded += digits;
    } else if (next == 'q') {
      std::snprintf(digits, sizeof digits, "%03u", nanoseconds / 1000 % 1000);
      expanded += digits;
    } else {
      expanded += '%';
      expanded += next;
    }
  }
  std::tm local{};
  localtime_r(&seconds, &local);
  char text[256];
  return {text, std::strftime(text, sizeof text, expanded.c_str(), &local)};
}

const char* color_of(int level) {
  switch (level) {
    case Logger::RTL_FATAL:
    case Logger::RTL_ERROR:
      return "\x1b[31m";
    case Logger::RTL_WARN:
      return "\x1b[33m";
    case Logger::RTL_INFO:
      return "\x1b[32m";
    default:
      return "\x1b[90m";
  }
}

std::string format_line(const LogSettings& settings, const LogRecord& record) {
  std::string line;
  if (settings.colored) line += color_of(record.level);
  if (!settings.date_format.empty()) line += format_date(settings.date_format, record.time) + ' ';
  if (record.simulated) {
    char text[32];
    std::snprintf(text, sizeof text, "[%.6f] ", static_cast<double>(record.simulated->count()) * 1e-9);
    line += text;
  }
  line += Logger::getLevelString(record.level);
  line += ": ";
  line += base::for_terminal(record.name);  // names and values come from peers, and people look at logs in terminals
  line += ": ";
  line += base::for_terminal(record.message);
  if (settings.colored) line += "\x1b[0m";
  line += '\n';
  return line;
}

// Takes every record of the process: those of Logger and those of base::log. The process has exactly one; it lives until the end because
// threads log while statics are destroyed.
class Router {
 public:
  static Router& instance() {
    static Router& router = *std::make_unique<Router>().release();
    return router;
  }

  Router() {
    open_outputs();
    base::set_log_sink([this](const base::LogRecord& record) { route(from_base(record.level), record.name, record.message, false); });
    base::set_log_level(to_base(shared_.lock()->settings->level));
  }

  // `wanted`: the logger's own level let it pass, whatever the process's level is.
  void route(int level, std::string_view name, std::string_view message, bool wanted) {
    LogRecord record{level, name, message, base::SystemClock().now(), {}};
    const auto& clock = base::current_clock();
    if (!dynamic_cast<const base::SystemClock*>(&clock)) record.simulated = clock.now();

    base::expect_no_data_held();
    const auto [settings, sinks, last] = shared_.snapshot();
    if (!settings->clock.empty()) {
      const auto time = coil::ClockManager::instance().getClock(settings->clock).gettime();
      record.time = std::chrono::seconds(time.sec()) + std::chrono::microseconds(time.usec());
    }
    if (settings->enabled && (wanted || level <= settings->level)) {
      const auto line = format_line(*settings, record);
      {
        const auto mine = writing_.take();
        for (const auto& output : outputs_) output->stream << line << std::flush;
      }
      give_to_buffers(*settings, record, line);
    }
    for (const auto& sink : sinks) {
      if (level <= sink->level) sink->call(record);
    }
  }

  LogSinkId add_sink(int level, LogSink call) {
    auto shared = shared_.lock();
    const auto id = ++shared->last_id;
    shared->sinks.push_back(std::make_shared<const Sink>(Sink{id, level, std::move(call)}));
    update_level(*shared);
    return id;
  }

  void remove_sink(LogSinkId id) {
    Sinks before;  // what ends with the sink ends without the lock
    auto shared = shared_.lock();
    before = shared->sinks;
    std::erase_if(shared->sinks, [&](const auto& sink) { return sink->id == id; });
    update_level(*shared);
  }

  std::vector<std::string> set_settings(const LogSettings& settings) {
    {
      auto shared = shared_.lock();
      shared->settings = std::make_shared<const LogSettings>(settings);
      update_level(*shared);
    }
    return open_outputs();
  }

  void change_date_format(const char* format) {
    auto shared = shared_.lock();
    auto changed = *shared->settings;
    changed.date_format = format;
    shared->settings = std::make_shared<const LogSettings>(std::move(changed));
  }

  void add_buffer(std::streambuf* buffer) { mail_.lock()->buffers.push_back(buffer); }
  // The buffer is not used any more when it returns, unless it is its own code that asks.
  void remove_buffer(std::streambuf* buffer) {
    auto mail = mail_.lock();
    std::erase(mail->buffers, buffer);
    const auto is_let_go = [&] { return mail->in_use != buffer || mail->sender == std::this_thread::get_id(); };
    while (!mail.wait_for(given_, std::chrono::hours(1), is_let_go)) {
    }
  }

 private:
  // A record that waits for the buffers.
  struct Letter {
    int level;
    std::string name, date, message, line;
  };
  // Buffers are other people's code, and called without a lock, by one thread at a time: whoever finds nobody at it gives them all that
  // waits, and others leave their records to it. What a buffer logs does not come back to it.
  struct Mail {
    static constexpr std::size_t most = 10000;  // records that wait for a buffer that does not return; later ones are dropped
    std::vector<std::streambuf*> buffers;
    std::deque<Letter> letters;
    std::optional<std::thread::id> sender;
    std::streambuf* in_use = nullptr;
  };

  void give_to_buffers(const LogSettings& settings, const LogRecord& record, const std::string& line) {
    {
      auto mail = mail_.lock();
      if (mail->buffers.empty() || mail->letters.size() >= Mail::most || mail->sender == std::this_thread::get_id()) return;
    }
    const auto date = settings.date_format.empty() ? std::string() : format_date(settings.date_format, record.time);
    {
      auto mail = mail_.lock();
      mail->letters.push_back({record.level, std::string(record.name), date, std::string(record.message), line});
      if (mail->sender) return;
      mail->sender = std::this_thread::get_id();
    }
    while (const auto letter = next_letter()) {
      for (auto* buffer : buffers()) {
        if (use(buffer)) give(*buffer, *letter);
      }
      static_cast<void>(use(nullptr));
    }
  }
  std::optional<Letter> next_letter() {
    auto mail = mail_.lock();
    if (mail->letters.empty()) {
      mail->sender.reset();
      return std::nullopt;
    }
    auto letter = std::move(mail->letters.front());
    mail->letters.pop_front();
    return letter;
  }
  std::vector<std::streambuf*> buffers() { return mail_.lock()->buffers; }
  // Keeps the buffer from going until the next is used; false if it has gone already.
  bool use(std::streambuf* buffer) {
    bool is_there = false;
    {
      auto mail = mail_.lock();
      is_there = std::ranges::find(mail->buffers, buffer) != mail->buffers.end();
      mail->in_use = is_there ? buffer : nullptr;
    }
    given_.notify_all();
    return is_there;
  }
  static void give(std::streambuf& buffer, const Letter& letter) {
    try {
      if (auto* records = dynamic_cast<coil::LogStreamBuffer*>(&buffer)) {
        records->write(letter.level, letter.name, letter.date, letter.message);
      } else {
        buffer.sputn(letter.line.data(), static_cast<std::streamsize>(letter.line.size()));
        buffer.pubsync();
      }
    } catch (...) {  // a record that cannot be logged cannot be complained about either
      return;
    }
  }

  struct Shared {
    std::shared_ptr<const LogSettings> settings = std::make_shared<const LogSettings>();
    Sinks sinks;
    LogSinkId last_id = 0;
  };

  // Base must let pass what anybody wants.
  static void update_level(const Shared& shared) {
    int level = shared.settings->enabled ? shared.settings->level : static_cast<int>(Logger::RTL_SILENT);
    for (const auto& sink : shared.sinks) level = std::max(level, sink->level);
    base::set_log_level(to_base(level));
  }

  std::vector<std::string> open_outputs() {
    std::vector<std::string> complaints;
    std::vector<std::unique_ptr<Output>> outputs;
    const auto settings = shared_.snapshot().settings;
    for (const auto& name : settings->files) {
      if (!settings->enabled) break;
      if (name == "stderr") {
        outputs.push_back(std::make_unique<Output>(std::cerr.rdbuf()));
      } else if (name == "stdout") {
        outputs.push_back(std::make_unique<Output>(std::cout.rdbuf()));
      } else {
        auto file = std::make_unique<std::filebuf>();
        if (!file->open(name, std::ios::out | std::ios::app)) {
          complaints.push_back("log file " + base::in_quotes(name) + ": cannot be opened for writing");
          continue;
        }
        outputs.push_back(std::make_unique<Output>(file.get()));
        outputs.back()->file = std::move(file);
      }
    }
    const auto mine = writing_.take();
    outputs_.swap(outputs);
    return complaints;
  }

  base::Guarded<Shared, base::Rank::log> shared_;
  base::Turn<base::Rank::log> writing_;  // of outputs_
  std::vector<std::unique_ptr<Output>> outputs_;
  base::Guarded<Mail, base::Rank::log> mail_;
  std::condition_variable given_;
};

}  // namespace

std::string detail::format_log_text(const char* format, ...) {
  va_list arguments;
  va_start(arguments, format);
  va_list again;
  va_copy(again, arguments);
  char stack[512];
  const int size = std::vsnprintf(stack, sizeof stack, format, arguments);
  va_end(arguments);
  std::string text;
  if (size > 0 && static_cast<std::size_t>(size) < sizeof stack) {
    text.assign(stack, static_cast<std::size_t>(size));
  } else if (size > 0) {
    text.resize(static_cast<std::size_t>(size) + 1);
    std::vsnprintf(text.data(), text.size(), format, again);
    text.pop_back();
  }
  va_end(again);
  return text;
}

LogSinkId addLogSink(int level, LogSink sink) { return Router::instance().add_sink(level, std::move(sink)); }
void removeLogSink(LogSinkId id) { Router::instance().remove_sink(id); }
std::vector<std::string> setLogSettings(const LogSettings& settings) { return Router::instance().set_settings(settings); }
void addLogStreamBuffer(std::streambuf* buffer) { Router::instance().add_buffer(buffer); }
void removeLogStreamBuffer(std::streambuf* buffer) { Router::instance().remove_buffer(buffer); }

Logger::Line::~Line() {
  if (logger_.isValid(level_)) logger_.write(level_, str());
}

bool Logger::setLevel(int level) {
  if (!is_level(level)) return false;
  own_level_ = level;
  return true;
}

bool Logger::setLevel(const char* level) {
  const auto parsed = parseLevel(level ? level : "");
  return parsed && setLevel(*parsed);
}

int Logger::getLevel() const { return own_level_ >= 0 ? own_level_ : from_base(base::log_level()); }

void Logger::setDateFormat(const char* format) {
  if (format) Router::instance().change_date_format(format);
}

bool Logger::isValid(int level) const {
  if (level <= RTL_SILENT || level > RTL_PARANOID) return false;
  return own_level_ >= 0 ? level <= own_level_ : base::is_logged(to_base(level));
}

void Logger::write(int level, const std::string& text) const {
  if (is_level(level)) Router::instance().route(level, name_, text, own_level_ >= 0);
}

int Logger::strToLevel(const char* text) { return parseLevel(text ? text : "").value_or(RTL_SILENT); }

std::optional<int> Logger::parseLevel(std::string_view text) {
  text = base::trim(text);
  for (int level = RTL_SILENT; level <= RTL_PARANOID; ++level) {
    if (base::equal_ignoring_case(text, level_names[level])) return level;
  }
  if (base::equal_ignoring_case(text, "NORMAL")) return RTL_INFO;  // a level of the first releases
  const auto number = base::parse_integer(text);
  if (number && is_level(static_cast<int>(std::clamp<std::int64_t>(*number, -1, 99)))) return static_cast<int>(*number);
  return std::nullopt;
}

const char* Logger::getLevelString(int level) { return is_level(level) ? level_names[level] : level_names[0]; }

}  // namespace RTC
