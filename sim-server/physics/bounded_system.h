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
  void find_rest();
  void factor_free();
  void find_forward();
  void find_backward();
  void solve_free();
  std::size_t turn_wrong(bool one_at_a_time);
  double* column(Eigen::Index free) { return part_.data() + free * stride_; }

  std::vector<Bound> solved_;                  // for which `x` is right, with the values of the bounds
  std::vector<Eigen::Index> free_, factored_;  // rows; those that `part_` is the factor of
  // Storage is kept. Of the free rows: Cholesky's factor, with 1 / the diagonal, and below it a row with the right side, then zeros, which
  // whole blocks of rows are computed with.
  Eigen::VectorXd part_;
  Eigen::Index stride_ = 0;
  Eigen::VectorXd found_, rest_;
};

// Where a row that is at `bound` ought to be, with its force and the velocity that it leaves over.
Bound better_bound(Bound bound, double x, double left_over, double low, double high, double tolerance);

}  // namespace sim
