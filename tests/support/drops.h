// Mesh bodies let fall onto each other, for what contacts do with their energy. Each body turns a closed outline about the z axis, so that
// a bowl, a lid, an open box (of four sides) or a thin plate is one row. Values; one thread.
#pragma once

#include <algorithm>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "support/physics_fixture.h"
#include "support/world_files.h"

namespace sim::test {

struct Outline {
  std::string name;
  int sides = 4;
  std::vector<std::pair<double, double>> points;  // (radius, height) [m], against the clock
};

// A triangle mesh with what its volume weighs at 500 kg/m^3.
struct Turned {
  std::vector<Eigen::Vector3d> places;
  std::vector<std::array<int, 3>> faces;
  double low = 0, high = 0;

  explicit Turned(const Outline& outline) {
    const int rows = static_cast<int>(outline.points.size());
    for (int s = 0; s < outline.sides; ++s) {
      const double angle = 2 * std::numbers::pi * (s + 0.5) / outline.sides;
      for (const auto& [r, z] : outline.points) places.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
    }
    for (int s = 0; s < outline.sides; ++s) {
      const int next = (s + 1) % outline.sides;
      for (int i = 0; i < rows; ++i) {
        const int k = (i + 1) % rows, a = s * rows + i, b = next * rows + i, c = next * rows + k, d = s * rows + k;
        if (outline.points[static_cast<std::size_t>(i)].first > 0) faces.push_back({a, b, c});
        if (outline.points[static_cast<std::size_t>(k)].first > 0) faces.push_back({a, c, d});
      }
    }
    low = std::min_element(outline.points.begin(), outline.points.end(), [](auto& a, auto& b) { return a.second < b.second; })->second;
    high = std::max_element(outline.points.begin(), outline.points.end(), [](auto& a, auto& b) { return a.second < b.second; })->second;
  }

  std::string obj() const {
    std::string text = "o body\n";
    for (const auto& p : places) text += "v " + std::to_string(p.x()) + " " + std::to_string(p.y()) + " " + std::to_string(p.z()) + "\n";
    for (const auto& f : faces)
      text += "f " + std::to_string(f[0] + 1) + " " + std::to_string(f[1] + 1) + " " + std::to_string(f[2] + 1) + "\n";
    return text;
  }

  void weigh(LinkDef& link) const {
    constexpr double density = 500;
    double volume = 0;
    Eigen::Vector3d first = Eigen::Vector3d::Zero();
    Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
    for (const auto& f : faces) {
      const Eigen::Vector3d &a = places[static_cast<std::size_t>(f[0])], &b = places[static_cast<std::size_t>(f[1])],
                            &c = places[static_cast<std::size_t>(f[2])];
      const double v = a.dot(b.cross(c)) / 6;
      const Eigen::Vector3d sum = a + b + c;
      volume += v;
      first += v / 4 * sum;
      second += v / 20 * (a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose());
    }
    link.mass = density * volume;
    link.center_of_mass = first / volume;
    const Eigen::Matrix3d spread = density * second - link.mass * link.center_of_mass * link.center_of_mass.transpose();
    link.inertia = spread.trace() * Eigen::Matrix3d::Identity() - spread;
  }
};

inline ModelDef turned_body(const WorldFiles& files, const Outline& outline, const std::string& name, const Eigen::Isometry3d& pose) {
  const Turned turned(outline);
  MeshShape mesh;
  mesh.path = files.write(outline.name + ".obj", turned.obj());
  ModelDef model = body(name, BoxShape{}, pose);
  model.links[0].collisions[0].geometry = mesh;
  turned.weigh(model.links[0]);
  return model;
}

// --- what falls

inline Outline crate_outline(double half, double height) {
  const double r = half * std::sqrt(2.0);
  return {"crate" + std::to_string(half), 4, {{0, 0}, {r, 0}, {r, height}, {0, height}}};
}
inline Outline open_box_outline(double half, double height, double wall) {
  const double r = half * std::sqrt(2.0), w = wall * std::sqrt(2.0);
  return {"box" + std::to_string(half), 4, {{0, 0}, {r, 0}, {r, height}, {r - w, height}, {r - w, wall}, {0, wall}}};
}
// Fits over an open box of that half width.
inline Outline lid_outline(double half, double rim, double wall) {
  const double r = (half + wall + 0.002) * std::sqrt(2.0), w = wall * std::sqrt(2.0);
  return {"lid" + std::to_string(half), 4, {{0, -wall}, {r - w, -wall}, {r - w, -rim}, {r, -rim}, {r, 0}, {0, 0}}};
}
inline Outline bowl_outline(double radius, double wall, int sides) {
  Outline outline{"bowl" + std::to_string(radius), sides, {}};
  for (int i = 0; i <= 6; ++i) {
    const double a = i * std::numbers::pi / 12;
    outline.points.emplace_back(radius * std::sin(a), radius - radius * std::cos(a));
  }
  for (int i = 6; i >= 0; --i) {
    const double a = i * std::numbers::pi / 12;
    outline.points.emplace_back((radius - wall) * std::sin(a), radius - (radius - wall) * std::cos(a));
  }
  return outline;
}
inline Outline plate_outline(double half, double thickness) {
  const double r = half * std::sqrt(2.0);
  return {"plate" + std::to_string(thickness), 4, {{0, 0}, {r, 0}, {r, thickness}, {0, thickness}}};
}
inline Outline ring_outline(double inner, double outer, double height) {
  return {"ring", 16, {{inner, 0}, {outer, 0}, {outer, height}, {inner, height}}};
}
inline Outline wedge_outline(double radius, double height) { return {"wedge", 3, {{0, 0}, {radius, 0}, {0, height}}}; }
inline Outline ball_outline(double radius) {
  Outline outline{"ball", 12, {}};
  for (int i = 0; i <= 6; ++i) {
    const double a = i * std::numbers::pi / 6;
    outline.points.emplace_back(i == 0 || i == 6 ? 0 : radius * std::sin(a), radius - radius * std::cos(a));
  }
  return outline;
}

// One body above another, which stands on the ground.
struct Drop {
  std::string name;
  Outline lower, upper;
  double height = 0.05;  // [m] that it falls; below 0: so deep it begins in the other
  double roll = 0, pitch = 0, aside = 0;
  bool is_lower_fixed = false;
};

inline std::vector<std::pair<Outline, Outline>> drop_pairs() {
  const Outline box = open_box_outline(0.15, 0.2, 0.01), crate = crate_outline(0.15, 0.2), bowl = bowl_outline(0.2, 0.02, 12),
                plate = plate_outline(0.2, 0.004);
  return {{box, lid_outline(0.15, 0.03, 0.008)},
          {box, open_box_outline(0.12, 0.15, 0.008)},
          {box, plate},
          {box, ball_outline(0.08)},
          {bowl, bowl_outline(0.2, 0.02, 12)},
          {bowl, crate_outline(0.06, 0.1)},
          {bowl, ball_outline(0.08)},
          {crate, plate},
          {crate, wedge_outline(0.1, 0.15)},
          {crate, ring_outline(0.08, 0.12, 0.05)},
          {crate, crate_outline(0.1, 0.12)},
          {plate, plate_outline(0.15, 0.003)},
          {wedge_outline(0.2, 0.2), ring_outline(0.05, 0.09, 0.04)}};
}

inline std::vector<Drop> drops_of(const Outline& lower, const Outline& upper) {
  std::vector<Drop> drops;
  for (const double height : {-0.5, 0.05, 0.3}) {
    for (const bool is_tilted : {false, true}) {
      for (const bool is_fixed : {false, true}) {
        Drop drop{"", lower, upper, height, 0, 0, 0, is_fixed};
        if (height < 0) drop.height = -0.5 * (Turned(upper).high - Turned(upper).low);
        if (is_tilted) drop.roll = 0.35, drop.pitch = -0.2, drop.aside = 0.04;
        drop.name = upper.name + " on " + lower.name +
                    (height < 0     ? " buried"
                     : height > 0.1 ? " 30cm"
                                    : " 5cm") +
                    (is_tilted ? " tilted" : "") + (is_fixed ? " fixed" : "");
        drops.push_back(drop);
      }
    }
  }
  return drops;
}

struct DropResult {
  double gain = 0;  // most of (energy now / energy at the start) - 1, with what half-buried bodies need to come out counted in at the start
  double lowest = 0;  // of any centre of mass [m]
  double speed = 0;   // of the faster one at the end [m/s]
  Eigen::Vector3d end{0, 0, 0};
};

inline double energy_of(const Physics& physics, ModelId model) {
  const LinkId link = physics.canonical_link(model);
  const LinkDef& def = physics.def(model).links[0];
  const Eigen::Vector3d centre = physics.center_of_mass(link);
  const Eigen::Matrix3d rotation = physics.link_pose(link).linear();
  const Eigen::Vector3d turn = rotation.transpose() * physics.link_twist(link).angular;
  return def.mass * (9.8 * centre.z() + 0.5 * physics.point_velocity(link, centre).squaredNorm()) + 0.5 * turn.dot(def.inertia * turn);
}

// `before_step` may push.
inline DropResult drop(const Drop& drop, double seconds, const std::function<void(Physics&)>& before_step = {}) {
  const WorldFiles files;
  const Turned lower(drop.lower), upper(drop.upper);
  Eigen::Isometry3d pose = tilted(drop.aside, 0.6 * drop.aside, 0, drop.roll, drop.pitch);
  double reach = 0;
  for (const auto& place : upper.places) reach = std::min(reach, (pose * place).z());
  pose.translation().z() = lower.high - lower.low - reach + drop.height;
  ModelDef below = turned_body(files, drop.lower, "lower", at(0, 0, -lower.low));
  below.is_static = drop.is_lower_fixed;
  PhysicsFixture f(world_of({ground(), below, turned_body(files, drop.upper, "upper", pose)}));
  if (!f.notes.empty() || !f.dropped.empty()) throw std::runtime_error("a body of a drop cannot be simulated");
  const auto energy = [&] { return energy_of(f.physics, 2) + (drop.is_lower_fixed ? 0 : energy_of(f.physics, 1)); };
  const double start = energy() + std::max(-drop.height, 0.0) * 9.8 * f.physics.def(2).links[0].mass;
  DropResult result;
  result.lowest = 1;
  while (static_cast<double>(f.physics.steps()) * 0.001 < seconds) {
    if (before_step) before_step(f.physics);
    f.physics.step();
    result.gain = std::max(result.gain, energy() / start - 1);
    result.lowest = std::min(result.lowest, f.position("upper").z());
  }
  result.end = f.position("upper");
  result.speed = f.physics.link_twist({2, 0}).linear.norm();
  return result;
}

}  // namespace sim::test
