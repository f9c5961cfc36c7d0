// Log lines of components, for viewers. A logger is attached to each component while there is a viewer. The
// newest thousand lines are kept, for new and for slow viewers. The loop's thread only; workers call the
// components.
#pragma once

#include <boost/asio/io_context.hpp>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "recording/logger_service.h"
#include "studio/signals.h"
#include "studio/workers.h"

namespace studio {

class LogBook {
 public:
  // The workers must live longer; `told`: there is a new line.
  LogBook(boost::asio::io_context& loop, const SignalSettings& settings, Workers& workers, std::function<void()> told);
  ~LogBook();

  // Of the simulation: lines of components by the wall clock are stamped with it.
  void set_time(std::chrono::nanoseconds now) { now_ = now; }
  // The event "system".
  void take_system(const Json& system);
  void set_watched(bool is_watched);
  // The event "logs" with the lines behind number `seen`, at most 200, which is then up to date; nothing when there are none.
  std::optional<std::string> event_since(std::uint64_t& seen) const;

 private:
  using Service = std::unique_ptr<recorder::LoggerService>;
  struct Component {
    Service service;
    bool is_attaching = false;
  };
  void add(Json line);
  void attach(const std::string& path);
  void detach(Component& component);

  boost::asio::io_context& loop_;
  const SignalSettings settings_;
  Workers& workers_;
  const std::function<void()> told_;
  std::chrono::nanoseconds now_{0};
  bool is_watched_ = false;
  std::map<std::string, Component> components_;  // by path
  std::deque<Json> lines_;
  std::uint64_t count_ = 0;                                     // of all lines that ever came
  std::shared_ptr<bool> lives_ = std::make_shared<bool>(true);  // what others post to the loop may come later than our end
};

}  // namespace studio
