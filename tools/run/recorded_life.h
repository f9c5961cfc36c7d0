// Repeats the changes that were made to a component while it was recorded: parameters, activation, deactivation, reset. One thread at a
// time.
//
// A change that took effect in tick t is requested at the end of the tick before, so the component applies it at the start of its next
// tick. A change between two ticks is made while the simulation is paused there.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/result.h"
#include "system/component_view.h"

namespace recorder {

struct RecordedChange {
  enum class Kind { configure, activate, deactivate, reset } kind = Kind::configure;
  std::chrono::nanoseconds time{0};
  bool is_in_tick = true;
  std::string set{};                                          // of parameters
  std::vector<std::pair<std::string, std::string>> values{};  // by parameter
};

struct RecordedLife {
  bool is_recorded = false;
  std::optional<RecordedChange> configuration;  // at the beginning
  std::string state;                            // at the beginning; empty: not known
  std::vector<RecordedChange> changes;

  // Of the channels /rtc/COMPONENT/state and /rtc/COMPONENT/configuration.
  static base::Result<RecordedLife> read(const std::string& file, const std::string& component);
  // A parameter is left as it is.
  void forget(const std::string& parameter);
  // Only what happened in ticks, or only the rest.
  RecordedLife part(bool is_in_tick) const;
};

class LifePlayer {
 public:
  explicit LifePlayer(RecordedLife life) : life_(std::move(life)) {}

  // The component as it was at first, before time moves. An error names what it rejects.
  base::Result<void> begin(const tools::ComponentView& component);
  // The time of the change that is to be made next.
  std::optional<std::chrono::nanoseconds> next() const;
  // All changes up to this time.
  base::Result<void> go_on(std::chrono::nanoseconds until);
  std::size_t done() const { return done_; }

 private:
  base::Result<void> make(const RecordedChange& change);

  RecordedLife life_;
  tools::ComponentView component_;
  std::size_t next_ = 0, done_ = 0;
};

}  // namespace recorder
