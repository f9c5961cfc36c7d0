// Random numbers that are the same everywhere: a counter is hashed with a seed, so the n-th number of a stream needs none of those before.
// The noise of a sample is that of its time: how many samples were taken before it makes no difference. Values; one thread at a time.
#pragma once

#include <chrono>
#include <cstdint>
#include <span>
#include <string_view>

#include "world/world_def.h"

namespace sim {

class RandomStream {
 public:
  RandomStream() = default;
  // A stream of its own for each seed and name.
  RandomStream(std::uint64_t seed, std::string_view name);
  // A stream of its own for each number. What was drawn from this one makes no difference.
  RandomStream at(std::uint64_t number) const;
  RandomStream at(std::chrono::nanoseconds time) const { return at(static_cast<std::uint64_t>(time.count())); }

  std::uint64_t next();
  double uniform();   // (0, 1)
  double gaussian();  // mean 0, standard deviation 1
  // With what as many calls of gaussian() return, in less time.
  void fill(std::span<double> numbers);

 private:
  std::uint64_t key_ = 0, counter_ = 0;
};

// The noise of one quantity.
class Noise {
 public:
  Noise() = default;
  // `interval` between samples: a bias that drifts changes once in each.
  Noise(const NoiseDef& def, const RandomStream& stream, std::chrono::nanoseconds interval);

  // Before the values of a sample of this simulated time. A bias that drifts catches up: one draw for each interval since the last call.
  void begin(std::chrono::nanoseconds time);
  double apply(double value);
  // Ranges that are finite get noise and are quantised to multiples of `step` (0: not).
  void apply(std::span<float> ranges, float step);
  // The same as if it were made with this stream.
  Noise with(const RandomStream& stream) const { return {def_, stream, interval_}; }

 private:
  bool is_none() const { return def_.kind == NoiseDef::Kind::none; }
  bool drifts() const { return def_.dynamic_bias_stddev > 0 && def_.dynamic_bias_correlation_time > 0 && interval_.count() > 0; }
  void drift_to(std::uint64_t interval);

  NoiseDef def_;
  RandomStream all_, sample_;  // the second: that of the sample's time
  RandomStream drift_;         // one stream for each interval
  std::chrono::nanoseconds interval_{0};
  double first_bias_ = 0, bias_ = 0;
  std::uint64_t drifted_ = 0;  // intervals that are in bias_
};

}  // namespace sim
