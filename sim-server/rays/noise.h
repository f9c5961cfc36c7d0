// Random numbers that are the same everywhere: a counter is hashed with a seed, so the n-th number of a stream needs none of those before.
// A value; one thread at a time.
#pragma once

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

  std::uint64_t next();
  double uniform();   // (0, 1)
  double gaussian();  // mean 0, standard deviation 1
  // With what as many calls of gaussian() return, in less time.
  void fill(std::span<double> numbers);

  std::uint64_t position() const { return counter_; }
  void restart() { counter_ = 0; }

 private:
  std::uint64_t key_ = 0, counter_ = 0;
};

// The noise of one quantity. Its bias is drawn when it is made.
class Noise {
 public:
  Noise() = default;
  Noise(const NoiseDef& def, RandomStream stream);

  // `dt` since the last call [s], for biases that drift.
  double apply(double value, double dt);
  // Ranges that are finite get noise and are quantised to multiples of `step` (0: not).
  void apply(std::span<float> ranges, float step);
  // The same as if it were made with this stream.
  Noise with(RandomStream stream) const { return {def_, stream}; }
  bool is_none() const { return def_.kind == NoiseDef::Kind::none; }
  const RandomStream& stream() const { return stream_; }

 private:
  NoiseDef def_;
  RandomStream stream_;
  double bias_ = 0;
};

}  // namespace sim
