#include "devices/drives/traction.h"

#include <spdlog/fmt/fmt.h>

#include <cmath>

#include "devices/angle.h"

namespace sim {
namespace {

constexpr double block = 0.25;        // [s]
constexpr double least_speed = 0.02;  // [m/s] below which nothing is judged
constexpr int slip_blocks = 12;       // before it is told

}  // namespace

double Traction::length(const Path& path) const { return std::hypot(path.forward, path.aside) + std::abs(path.turn) * separation_ / 2; }

bool Traction::follow(const std::array<double, 3>& wanted, const Travel& rolled, double dt) {
  wanted_.forward += wanted[0] * dt;
  wanted_.aside += wanted[1] * dt;
  wanted_.turn += wanted[2] * dt;
  rolled_.forward += rolled.forward;
  rolled_.aside += rolled.aside;
  rolled_.turn += rolled.turn;
  block_time_ += dt;
  return block_time_ >= block || !has_start_;
}

std::string Traction::look(const Eigen::Isometry3d& pose) {
  std::string line;
  if (has_start_) {
    Path moved;
    moved.forward = (pose.translation() - block_start_.translation()).head<2>().norm();
    moved.turn = wrapped(yaw_of(pose) - yaw_of(block_start_));
    // Faster than two places can tell.
    if (std::abs(rolled_.turn) > 3) moved.turn = rolled_.turn;
    line = close_block(moved);
  }
  has_start_ = true;
  block_start_ = pose;
  block_time_ = 0;
  wanted_ = rolled_ = {};
  return line;
}

std::string Traction::close_block(const Path& moved) {
  const double wanted = length(wanted_), least = least_speed * block_time_;
  stalled_blocks_ = wanted > least && length(moved) < 0.2 * wanted ? stalled_blocks_ + 1 : 0;
  const double rolled = is_skid_ ? std::abs(rolled_.forward) : length(rolled_);
  if (!(rolled > least)) return {};  // says nothing about their grip
  if (length(moved) > 0.5 * rolled) {
    slipped_blocks_ = 0;
    slipped_rolled_ = slipped_moved_ = {};
    return {};
  }
  slipped_rolled_ = {slipped_rolled_.forward + std::hypot(rolled_.forward, rolled_.aside), slipped_rolled_.turn + rolled_.turn};
  slipped_moved_ = {slipped_moved_.forward + moved.forward, slipped_moved_.turn + moved.turn};
  if (++slipped_blocks_ != slip_blocks) return {};
  return fmt::format(
      "the wheels slip: in {:g} s they rolled {:.2f} m and turned {:.2f} rad, the robot moved {:.2f} m and turned {:.2f} rad",
      slip_blocks * block, slipped_rolled_.forward, slipped_rolled_.turn, slipped_moved_.forward, slipped_moved_.turn);
}

void Traction::restart() {
  has_start_ = false;
  block_time_ = 0;
  wanted_ = rolled_ = slipped_rolled_ = slipped_moved_ = {};
  stalled_blocks_ = slipped_blocks_ = 0;
}

}  // namespace sim
