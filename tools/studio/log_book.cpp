#include "studio/log_book.h"

#include <algorithm>
#include <boost/asio/post.hpp>
#include <set>

#include "system/remote.h"
#include "system/session.h"

namespace studio {
namespace {

constexpr std::size_t max_lines = 1000;
constexpr std::size_t max_at_once = 200;
constexpr double longest_simulation = 1e9;  // [s] later stamps are of the wall clock
constexpr std::size_t longest_line = 4000;  // [bytes]

const char* level_text(OpenRTM::LogLevel level) {
  switch (level) {
    case OpenRTM::RTM_ERROR:
      return "ERROR";
    case OpenRTM::RTM_WARN:
      return "WARN";
    case OpenRTM::RTM_INFO:
    case OpenRTM::RTM_NORMAL:
      return "INFO";
    default:
      return "DEBUG";
  }
}

Json line_json(const OpenRTM::LogRecord& record) {
  return {{"time", record.time.sec + record.time.nsec * 1e-9},
          {"level", level_text(record.level)},
          {"source", record.loggername.in()},
          {"text", std::string(record.message.in()).substr(0, longest_line)}};
}

}  // namespace

LogBook::LogBook(boost::asio::io_context& loop, const SignalSettings& settings, Workers& workers, std::function<void()> told)
    : loop_(loop), settings_(settings), workers_(workers), told_(std::move(told)) {}

LogBook::~LogBook() {
  *lives_ = false;
  for (auto& [path, component] : components_) detach(component);
}

void LogBook::add(Json line) {
  if (line["time"] > longest_simulation && now_.count() > 0) line["time"] = std::chrono::duration<double>(now_).count();
  lines_.push_back(std::move(line));
  if (lines_.size() > max_lines) lines_.pop_front();
  ++count_;
  told_();
}

void LogBook::attach(const std::string& path) {
  auto& component = components_[path];
  if (component.service || component.is_attaching) return;
  const auto take = [this, &loop = loop_, lives = lives_](const OpenRTM::LogRecord& record) {
    boost::asio::post(loop, [this, lives, line = line_json(record)]() mutable {
      if (*lives) add(std::move(line));
    });
  };
  component.is_attaching = workers_.give([this, &loop = loop_, lives = lives_, settings = settings_, path, take] {
    const tools::CallLimit limited(settings.call_limit);
    const auto found = tools::Session(settings.orb, settings.name_server, settings.call_limit).component(path, {});
    auto service =
        std::make_shared<Service>(found && !CORBA::is_nil(found->object) ? recorder::LoggerService::of_log(*found, take) : nullptr);
    boost::asio::post(loop, [this, lives, path, service] {
      const auto known = *lives ? components_.find(path) : decltype(components_.find(path))();
      if (!*lives || known == components_.end()) return;
      known->second.is_attaching = false;
      known->second.service = std::move(*service);
      if (!is_watched_) detach(known->second);
    });
  });
}

// By a worker: the component may hang.
void LogBook::detach(Component& component) {
  if (!component.service) return;
  (void)workers_.give([service = std::make_shared<Service>(std::move(component.service)), limit = settings_.call_limit] {
    const tools::CallLimit limited(limit);
    service->reset();
  });
}

void LogBook::take_system(const Json& system) {
  std::set<std::string> there;
  for (const Json& component : system.value("components", Json::array())) {
    if (component.value("problem", "").empty()) there.insert(component.value("path", ""));
  }
  for (auto known = components_.begin(); known != components_.end();) {
    if (there.contains(known->first)) {
      ++known;
      continue;
    }
    detach(known->second);
    known = components_.erase(known);
  }
  for (const auto& path : there) {
    components_.try_emplace(path);
    if (is_watched_) attach(path);
  }
}

void LogBook::set_watched(bool is_watched) {
  if (is_watched == is_watched_) return;
  is_watched_ = is_watched;
  for (auto& [path, component] : components_) is_watched ? attach(path) : detach(component);
}

std::optional<std::string> LogBook::event_since(std::uint64_t& seen) const {
  const auto fresh = std::min<std::uint64_t>({count_ - std::min(seen, count_), lines_.size(), max_at_once});
  seen = count_;
  if (fresh == 0) return std::nullopt;
  Json list = Json::array();
  for (auto line = lines_.end() - static_cast<std::ptrdiff_t>(fresh); line != lines_.end(); ++line) list.push_back(*line);
  return to_text({{"op", "logs"}, {"lines", std::move(list)}});
}

}  // namespace studio
