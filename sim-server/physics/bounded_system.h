// A small symmetric, positive definite system with bounds: find x within [low, high] so that a x - b is 0 where x is inside, not negative
// where it is at its low bound and not positive where it is at its high one. Values; one thread at a time.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace sim {

enum class Bound : std::uint8_t { free, low, high };

struct BoundedSystem {
  Eigen::MatrixXd a;
  Eigen::VectorXd b, low, high;
  Eigen::VectorXd x;
  std::vector<Bound> bounds;  // to begin with and found

  // Everything free and zero.
  void resize(Eigen::Index size);
  // After resize() and the values; again after other bounds. By block principal pivoting, and one by one where that goes round in circles.
  // False when that does not end either.
  bool solve();

 private:
  void gather_free();
  void solve_part();
  void solve_free();
  std::size_t turn_wrong(bool one_at_a_time);

  std::vector<Bound> solved_;  // for which `x` is right, with the values of the bounds
  // Of the free rows; storage is kept.
  std::vector<Eigen::Index> free_;
  Eigen::MatrixXd part_;
  Eigen::VectorXd found_, rest_;
};

// Where a row that is at `bound` ought to be, with its force and the velocity that it leaves over.
Bound better_bound(Bound bound, double x, double left_over, double low, double high, double tolerance);

}  // namespace sim
