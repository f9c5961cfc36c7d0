#include "physics/bounded_system.h"

#include <cmath>

namespace sim {

void BoundedSystem::resize(Eigen::Index size) {
  a.setZero(size, size);
  b.setZero(size);
  low.setZero(size);
  high.setZero(size);
  x.setZero(size);
  if (part_.rows() < size) part_.resize(size, size), found_.resize(size);
  bounds.assign(static_cast<std::size_t>(size), Bound::free);
  solved_.clear();
}

Bound better_bound(Bound bound, double x, double left_over, double low, double high, double tolerance) {
  if (bound == Bound::free) {
    const double slack = 1e-9 * std::abs(x);
    return x < low - slack ? Bound::low : x > high + slack ? Bound::high : Bound::free;
  }
  if (low == high) return bound;
  return (bound == Bound::low ? left_over < -tolerance : left_over > tolerance) ? Bound::free : bound;
}

// Of the rows that are free, with what those at bounds do to them: the lower half of the matrix, and the right side.
void BoundedSystem::gather_free() {
  rest_ = b;
  for (Eigen::Index k = 0; k < x.size(); ++k) {
    if (bounds[static_cast<std::size_t>(k)] != Bound::free && x[k] != 0) rest_.noalias() -= x[k] * a.col(k);
  }
  const auto count = static_cast<Eigen::Index>(free_.size());
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Index row = free_[static_cast<std::size_t>(i)];
    found_[i] = rest_[row];
    const double* from = a.col(row).data();
    double* to = part_.col(i).data();
    for (Eigen::Index k = i; k < count; ++k) to[k] = from[free_[static_cast<std::size_t>(k)]];
  }
}

// Cholesky's factor in place, and with it the solution. The systems are small: what Eigen does to be fast with large ones takes longer.
void BoundedSystem::solve_part() {
  const auto count = static_cast<Eigen::Index>(free_.size());
  for (Eigen::Index j = 0; j < count; ++j) {
    const Eigen::Index below = count - j - 1;
    auto column = part_.col(j).segment(j + 1, below);
    const double inverse = 1 / std::sqrt(part_(j, j));
    part_(j, j) = inverse;
    column *= inverse;
    found_[j] *= inverse;
    found_.segment(j + 1, below).noalias() -= found_[j] * column;
    for (Eigen::Index k = j + 1; k < count; ++k)
      part_.col(k).segment(k, count - k).noalias() -= part_(k, j) * part_.col(j).segment(k, count - k);
  }
  for (Eigen::Index j = count - 1; j >= 0; --j) {
    const Eigen::Index below = count - j - 1;
    found_[j] = (found_[j] - part_.col(j).segment(j + 1, below).dot(found_.segment(j + 1, below))) * part_(j, j);
  }
}

void BoundedSystem::solve_free() {
  bool has_moved = solved_ != bounds;  // a bound, or its value
  free_.clear();
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const Bound bound = bounds[static_cast<std::size_t>(i)];
    if (bound == Bound::free) {
      free_.push_back(i);
      continue;
    }
    const double value = bound == Bound::low ? low[i] : high[i];
    has_moved = has_moved || x[i] != value;
    x[i] = value;
  }
  if (!has_moved) return;
  solved_ = bounds;
  gather_free();
  solve_part();
  for (std::size_t i = 0; i < free_.size(); ++i) x[free_[i]] = found_[static_cast<Eigen::Index>(i)];
}

// Returns how many are wrong.
std::size_t BoundedSystem::turn_wrong(bool one_at_a_time) {
  std::size_t wrong = 0;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    Bound& bound = bounds[static_cast<std::size_t>(i)];
    const double left_over = bound == Bound::free ? 0 : a.row(i).dot(x) - b[i];
    const Bound better = better_bound(bound, x[i], left_over, low[i], high[i], 1e-12 + 1e-9 * std::abs(b[i]));
    if (better == bound) continue;
    ++wrong;
    if (!one_at_a_time || wrong == 1) bound = better;
  }
  return wrong;
}

bool BoundedSystem::solve() {
  constexpr int at_once = 20;
  const int most = at_once + 10 * static_cast<int>(x.size());
  for (int round = 0; round < most; ++round) {
    solve_free();
    if (turn_wrong(round >= at_once) == 0) return true;
  }
  return false;
}

}  // namespace sim
