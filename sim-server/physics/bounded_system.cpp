#include "physics/bounded_system.h"

#include <algorithm>
#include <cmath>

namespace sim {
namespace {

constexpr Eigen::Index block = 4;  // rows

}  // namespace

void BoundedSystem::resize(Eigen::Index size) {
  a.setZero(size, size);
  b.setZero(size);
  low.setZero(size);
  high.setZero(size);
  x.setZero(size);
  stride_ = size + block;
  if (factor_.size() < size * stride_) factor_.resize(size * stride_), solution_.resize(size);
  bounds.assign(static_cast<std::size_t>(size), Bound::free);
  solved_.clear();
  factored_.clear();
}

Bound better_bound(Bound bound, double x, double residual, double low, double high, double tolerance) {
  if (bound == Bound::free) {
    const double slack = 1e-9 * std::abs(x);
    return x < low - slack ? Bound::low : x > high + slack ? Bound::high : Bound::free;
  }
  if (low == high) return bound;
  return (bound == Bound::low ? residual < -tolerance : residual > tolerance) ? Bound::free : bound;
}

// Subtracts the effect of the rows at bounds from the right side.
void BoundedSystem::compute_right_side() {
  right_side_ = b;
  for (Eigen::Index k = 0; k < x.size(); ++k) {
    if (bounds[static_cast<std::size_t>(k)] != Bound::free && x[k] != 0) right_side_.noalias() -= x[k] * a.col(k);
  }
}

// Factors the free rows. The systems are small, so Eigen's optimizations for large ones take longer. A block of a column is computed in
// registers.
void BoundedSystem::factor_free() {
  using Block = Eigen::Array<double, block, 1>;
  const auto count = static_cast<Eigen::Index>(free_.size());
  const Eigen::Index stride = stride_;
  for (Eigen::Index j = 0; j < count; ++j) {
    double* to = factor_column(j);
    const double* from = a.col(free_[static_cast<std::size_t>(j)]).data();
    for (Eigen::Index i = j; i < count; ++i) to[i] = from[free_[static_cast<std::size_t>(i)]];
    to[count] = right_side_[free_[static_cast<std::size_t>(j)]];
    std::fill_n(to + count + 1, block - 1, 0.0);
    for (Eigen::Index i = j; i <= count; i += block) {
      Block sum = Eigen::Map<const Block>(to + i);
      const double* share = factor_.data() + j;
      const double* rows = factor_.data() + i;
      for (Eigen::Index k = j; k > 0; --k, share += stride, rows += stride) sum -= *share * Eigen::Map<const Block>(rows);
      Eigen::Map<Block>(to + i) = sum;
    }
    const double inverse = 1 / std::sqrt(to[j]);
    for (Eigen::Index i = j + 1; i <= count; i += 1) to[i] *= inverse;
    to[j] = inverse;
    solution_[j] = to[count];
  }
  factored_ = free_;
}

// Forward substitution with the existing factor.
void BoundedSystem::substitute_forward() {
  const auto count = static_cast<Eigen::Index>(free_.size());
  for (Eigen::Index j = 0; j < count; ++j) solution_[j] = right_side_[free_[static_cast<std::size_t>(j)]];
  for (Eigen::Index j = 0; j < count; ++j) {
    solution_[j] *= factor_column(j)[j];
    const Eigen::Index below = count - j - 1;
    solution_.segment(j + 1, below).noalias() -= solution_[j] * Eigen::Map<const Eigen::VectorXd>(factor_column(j) + j + 1, below);
  }
}

void BoundedSystem::substitute_backward() {
  const auto count = static_cast<Eigen::Index>(free_.size());
  for (Eigen::Index j = count - 1; j >= 0; --j) {
    const Eigen::Index below = count - j - 1;
    const Eigen::Map<const Eigen::VectorXd> factor(factor_column(j) + j + 1, below);
    solution_[j] = (solution_[j] - factor.dot(solution_.segment(j + 1, below))) * factor_column(j)[j];
  }
}

void BoundedSystem::solve_free() {
  bool has_moved = solved_ != bounds;  // a bound or its value changed
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
  compute_right_side();
  free_ == factored_ ? substitute_forward() : factor_free();
  substitute_backward();
  for (std::size_t i = 0; i < free_.size(); ++i) x[free_[i]] = solution_[static_cast<Eigen::Index>(i)];
}

// Changes the bounds of wrong rows. Returns the number of wrong rows.
std::size_t BoundedSystem::change_wrong_bounds(bool one_at_a_time) {
  std::size_t wrong = 0;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    Bound& bound = bounds[static_cast<std::size_t>(i)];
    const double residual = bound == Bound::free ? 0 : a.row(i).dot(x) - b[i];
    const Bound better = better_bound(bound, x[i], residual, low[i], high[i], 1e-12 + 1e-9 * std::abs(b[i]));
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
    if (change_wrong_bounds(round >= at_once) == 0) return true;
  }
  return false;
}

}  // namespace sim
