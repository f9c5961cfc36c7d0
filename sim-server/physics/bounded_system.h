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
  std::vector<Bound> bounds;  // the first guess, then the solution

  // Everything free and zero.
  void resize(Eigen::Index size);
  // Call it after resize() and setting the values, and again after changes of the bounds. Block principal pivoting, then one row at a time
  // if that cycles. False if that does not end either.
  bool solve();

 private:
  void compute_right_side();
  void factor_free();
  void substitute_forward();
  void substitute_backward();
  void solve_free();
  std::size_t change_wrong_bounds(bool one_at_a_time);
  double* factor_column(Eigen::Index free) { return factor_.data() + free * stride_; }

  std::vector<Bound> solved_;                  // bounds for which `x` was computed, with their values
  std::vector<Eigen::Index> free_, factored_;  // rows; the rows of the factor `factor_`
  // Cholesky factor of the free rows, with 1 / the diagonal. Below it a row with the right side, then zeros that fill the last block of
  // rows. The storage is reused.
  Eigen::VectorXd factor_;
  Eigen::Index stride_ = 0;
  Eigen::VectorXd solution_, right_side_;
};

// The bound to which a row at `bound` should change, for its force x and its remaining velocity.
Bound better_bound(Bound bound, double x, double residual, double low, double high, double tolerance);

}  // namespace sim
