// The world's part of a run's hash log (base/hash_log.h): each model and each device whose state has changed since the last entry. At fixed
// moments of simulated time; without a period when participants are called, as they see the world then, at most each 0.01 s, and each 0.1 s
// when they are called less often. The stepping thread only.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/hash_log.h"
#include "base/result.h"
#include "devices/device.h"
#include "physics/hash.h"
#include "server/simulation.h"

namespace sim {

class WorldHashes {
 public:
  // Every `period`, or every step when that is longer.
  static base::Result<WorldHashes> open(const std::string& path, std::optional<std::chrono::nanoseconds> period);

  // Before anybody's tick at this moment. `has_turn`: whether a participant is called now; nothing when there is none. Changes nothing.
  void record(const Simulation& simulation, std::optional<bool> has_turn);
  // After a reset.
  void restart();
  // False when not everything could be written.
  bool finish() { return log_.finish(); }

 private:
  WorldHashes(std::string path, base::HashLogWriter log, std::optional<std::chrono::nanoseconds> period);
  struct Leaf {
    std::string type, name;  // of the device; of the model, without a type. The number may have been another's.
    std::uint32_t key = 0;
    std::uint64_t hash = 0;
    bool is_known = false;
    bool is_named = false;               // type and name are those of this arrangement of the world
    std::vector<std::uint64_t> state{};  // as of the last entry
  };
  Leaf& leaf(std::vector<Leaf>& leaves, std::size_t index);
  void name(Leaf& leaf, std::string_view type, std::string_view name);
  void look_at_names_again(std::uint64_t arrangement);
  bool is_new(Leaf& leaf);
  void record_models(const Simulation& simulation);
  void record_devices(const Simulation& simulation);

  std::string path_;
  base::HashLogWriter log_;
  bool follows_turns_;
  Schedule schedule_;       // the earliest
  Schedule without_turns_;  // the latest
  StateHash state_;         // of one leaf after the other
  std::vector<Leaf> models_, devices_;
  std::uint64_t arrangement_ = 0;
};

}  // namespace sim
