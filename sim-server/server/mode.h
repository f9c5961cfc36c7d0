// The mode of simulated time: paused, running, or executing the steps that a client requested and then paused again. The stepping thread
// only.
#pragma once

#include <cstdint>
#include <utility>

namespace sim {

class Mode {
 public:
  explicit Mode(bool is_paused) : is_paused_(is_paused) {}

  bool stands_still() const { return is_paused_ && steps_to_do_ == 0; }
  // Will stand still when the steps that were asked for are done.
  bool is_paused() const { return is_paused_; }
  // Makes steps that a client wants as fast as possible, whatever the wall clock says.
  bool hurries() const { return steps_to_do_ > 0 && !are_steps_paced_; }

  void run() { is_paused_ = false; }
  // Steps under way are still made; end_steps() drops them.
  void pause() { is_paused_ = true; }
  void make_steps(std::uint64_t steps, bool are_paced) {
    is_paused_ = true;
    steps_to_do_ = steps;
    are_steps_paced_ = are_paced;
  }
  // A step has been made; true for the last of those that were asked for.
  bool count_step() { return steps_to_do_ > 0 && --steps_to_do_ == 0; }
  // How many were still to be made.
  std::uint64_t end_steps() { return std::exchange(steps_to_do_, 0); }

 private:
  bool is_paused_;
  std::uint64_t steps_to_do_ = 0;
  bool are_steps_paced_ = false;
};

}  // namespace sim
