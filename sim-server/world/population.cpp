#include "world/population.h"

#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <string>

#include "base/random.h"
#include "base/text.h"
#include "world/xml_file.h"
#include "world/xml_values.h"

namespace sim {

namespace {

constexpr int max_models = 10000;

// Equal on every machine, unlike the distributions of the standard library.
class Dice {
 public:
  explicit Dice(const std::string& name) {
    for (const char c : name) state_ = (state_ ^ static_cast<unsigned char>(c)) * 1099511628211U;
  }
  // From 0 to below 1.
  double roll() { return base::unit_interval(base::mix64(state_ += base::mix64_step)); }

 private:
  std::uint64_t state_ = 14695981039346656037U;
};

struct Region {
  bool is_round = false;
  Eigen::Vector3d size{1, 1, 1};  // of a cylinder: diameter, diameter, length

  // From coordinates 0..1.
  Eigen::Vector3d at(double u, double v, double w) const {
    if (!is_round) return size.cwiseProduct(Eigen::Vector3d(u - 0.5, v - 0.5, w - 0.5));
    const double radius = size.x() / 2 * std::sqrt(u), angle = 2 * std::numbers::pi * v;
    return {radius * std::cos(angle), radius * std::sin(angle), size.z() * (w - 0.5)};
  }
};

std::optional<Region> region_of(pugi::xml_node population) {
  if (population.child("box")) return Region{false, vector3_at(population, "box/size", {1, 1, 1})};
  if (!population.child("cylinder")) return std::nullopt;
  const double diameter = 2 * number_at(population, "cylinder/radius", 1);
  return Region{true, {diameter, diameter, number_at(population, "cylinder/length", 1)}};
}

std::vector<Eigen::Vector3d> grid(int rows, int columns, const Eigen::Vector3d& step) {
  std::vector<Eigen::Vector3d> points;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      points.emplace_back((column - (columns - 1) / 2.0) * step.x(), (row - (rows - 1) / 2.0) * step.y(), 0);
    }
  }
  return points;
}

// As even as it gets for any number, in boxes and in discs: the sequence of multiples of the plastic number.
std::vector<Eigen::Vector3d> evenly(int count, const Region& region) {
  constexpr double plastic = 1.32471795724474602596;
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < count; ++i) {
    const double u = std::fmod(0.5 + (i + 1) / plastic, 1.0), v = std::fmod(0.5 + (i + 1) / (plastic * plastic), 1.0);
    points.push_back(region.at(u, v, 0.5));
  }
  return points;
}

}  // namespace

std::vector<Eigen::Isometry3d> places_of(pugi::xml_node population, Complaints& complaints) {
  const auto refuse = [&](const std::string& why) {
    complaints.drop(population, describe(population) + " " + why + " and is left out");
    return std::vector<Eigen::Isometry3d>{};
  };
  const std::string kind = text_at(population, "distribution/type", "random");
  const int count = integer_at(population, "model_count", 1);
  const int rows = integer_at(population, "distribution/rows", 1), columns = integer_at(population, "distribution/cols", 1);
  const bool is_grid = kind == "grid";
  const bool is_right =
      is_grid ? rows >= 1 && columns >= 1 && static_cast<double>(rows) * columns <= max_models : count >= 1 && count <= max_models;
  if (!is_right) return refuse("must have from 1 to " + std::to_string(max_models) + " models");
  const std::optional<Region> region = region_of(population);
  if (!region && !is_grid) return refuse("has neither a <box> nor a <cylinder>");
  std::vector<Eigen::Vector3d> points;
  const auto middle = [&](int i) { return (i + 0.5) / count; };
  if (is_grid) {
    points = grid(rows, columns, vector3_at(population, "distribution/step", {0.5, 0.5, 0}));
  } else if (kind == "uniform") {
    points = evenly(count, *region);
  } else if (kind == "linear-x" || kind == "linear-y" || kind == "linear-z") {
    const int axis = kind.back() - 'x';
    for (int i = 0; i < count; ++i) points.emplace_back((middle(i) - 0.5) * region->size[axis] * Eigen::Vector3d::Unit(axis));
  } else if (kind == "random") {
    Dice dice(population.attribute("name").value());
    for (int i = 0; i < count; ++i) {
      const double u = dice.roll(), v = dice.roll();
      points.push_back(region->at(u, v, dice.roll()));
    }
  } else {
    return refuse("has the unknown distribution " + base::in_quotes(kind));
  }
  std::vector<Eigen::Isometry3d> places;
  for (const Eigen::Vector3d& point : points) places.emplace_back(Eigen::Translation3d(point));
  return places;
}

}  // namespace sim
