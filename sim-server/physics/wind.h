// The wind of the world: at once and steady as the world says, or as the plugin WindEffects of gz-sim makes it, which rises with time
// constants and swings. It follows from the number of steps alone, so that no state hash needs it. One thread at a time; between two
// step() calls any thread may read air().
#pragma once

#include <cstdint>

#include "world/body_force_defs.h"

namespace sim {

struct Air {
  Eigen::Vector3d wind{0, 0, 0};  // [m/s]
  double scale = 1;               // of the force on a link: mass times velocity against the wind [1/s]
  bool is_steady = true;          // it does not change any more
};

class Wind {
 public:
  Wind(const WindDef& def, double dt);
  // To the next step of `dt`.
  void step();
  void reset();
  const Air& air() const { return air_; }

 private:
  WindDef def_;
  double dt_;
  std::uint64_t steps_ = 0;
  double risen_ = 0, risen_vertical_ = 0;  // fractions of the whole wind
  Air air_;
};

}  // namespace sim
