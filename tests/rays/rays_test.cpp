// Ranges against analytic distances, and noise against statistics.
#include "rays/ray_scene.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>

#include "rays/noise.h"
#include "support/worlds.h"

namespace sim {
namespace {

using namespace test;
using Eigen::Vector3d;

// Nearest t >= 0 at which the ray meets a shape at the origin, infinite when it does not. Written from the equations, in doubles.
double nearest(std::initializer_list<double> ts) {
  double best = infinite;
  for (const double t : ts) {
    if (t >= 0 && t < best) best = t;
  }
  return best;
}

double to_sphere(const Vector3d& o, const Vector3d& d, double r) {
  const double b = o.dot(d), root = b * b - o.squaredNorm() + r * r;
  return root < 0 ? infinite : nearest({-b - std::sqrt(root), -b + std::sqrt(root)});
}

double to_box(const Vector3d& o, const Vector3d& d, const Vector3d& size) {
  double enter = -infinite, leave = infinite;
  for (int k = 0; k < 3; ++k) {
    double a = (-size[k] / 2 - o[k]) / d[k], b = (size[k] / 2 - o[k]) / d[k];
    if (a > b) std::swap(a, b);
    enter = std::max(enter, a);
    leave = std::min(leave, b);
  }
  return enter > leave ? infinite : nearest({enter, leave});
}

double to_cylinder(const Vector3d& o, const Vector3d& d, double r, double length) {
  double best = infinite;
  const double a = d.head<2>().squaredNorm(), b = o.head<2>().dot(d.head<2>()), c = o.head<2>().squaredNorm() - r * r, root = b * b - a * c;
  for (const double sign : {-1.0, 1.0}) {
    const double side = (-b + sign * std::sqrt(std::max(root, 0.0))) / a, end = (sign * length / 2 - o.z()) / d.z();
    if (root >= 0 && side >= 0 && std::abs(o.z() + side * d.z()) <= length / 2) best = std::min(best, side);
    if (end >= 0 && (o + end * d).head<2>().norm() <= r) best = std::min(best, end);
  }
  return best;
}

std::string write_tetrahedron(std::vector<Vector3d>& corners) {
  corners = {{-1, -1, -0.5}, {1.2, -0.8, -0.5}, {0.1, 1, -0.5}, {0, 0, 1}};
  const auto path = std::filesystem::temp_directory_path() / ("rtmsim-rays-test-" + std::to_string(getpid()) + ".obj");
  std::ofstream file(path);
  for (const auto& c : corners) file << "v " << c.x() << " " << c.y() << " " << c.z() << "\n";
  file << "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
  return path;
}

double to_triangle(const Vector3d& o, const Vector3d& d, const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const Vector3d n = (b - a).cross(c - a);
  const double t = n.dot(a - o) / n.dot(d);
  const Vector3d p = o + t * d;
  const bool inside = n.dot((b - a).cross(p - a)) >= 0 && n.dot((c - b).cross(p - b)) >= 0 && n.dot((a - c).cross(p - c)) >= 0;
  return inside ? nearest({t}) : infinite;
}

// Compares 20000 rays from around with `expected`; rays that graze an edge, where a hair decides between hit and miss, are left out.
void expect_exact(const GeometryDef& geometry, bool is_moving, const std::function<double(const Vector3d&, const Vector3d&)>& expected) {
  TriangleCache triangles;
  RayScene scene(triangles);
  std::vector<std::string> notes;
  const Eigen::Isometry3d pose = tilted(1.5, -2.2, 0.7, 0.4, -0.8, 1.1);
  const RayShape shape{&geometry, Eigen::Isometry3d::Identity(), 7};
  if (is_moving) {
    const auto id = scene.add_moving({&shape, 1}, Eigen::Isometry3d::Identity(), notes);
    scene.commit();
    scene.set_pose(id, pose);
  } else {
    scene.add_static({&shape, 1}, pose, notes);
  }
  scene.commit();
  ASSERT_TRUE(notes.empty()) << notes.front();
  std::mt19937 random(42);
  std::uniform_real_distribution<double> any(-1, 1);
  int compared = 0, hits = 0;
  double worst = 0;
  for (int i = 0; i < 1250; ++i) {
    const Vector3d from = Vector3d(any(random), any(random), any(random)).normalized() * (3 + 4 * std::abs(any(random)));
    std::vector<Eigen::Vector3f> directions;
    for (int k = 0; k < 16; ++k)
      directions.push_back((1.1 * Vector3d(any(random), any(random), any(random)) - from).normalized().cast<float>());
    const Beams beams(directions, 0, 30);
    std::vector<float> ranges(16), retros(16);
    Eigen::Isometry3d sensor = Eigen::Isometry3d::Identity();
    sensor.translation() = (pose * from).cast<float>().cast<double>();
    sensor.linear() = pose.linear();
    scene.trace(beams, sensor, ranges, retros);
    const Vector3d origin = pose.inverse() * sensor.translation();
    for (std::size_t k = 0; k < 16; ++k) {
      const Vector3d direction = beams.direction(k).cast<double>().normalized();
      const double truth = expected(origin, direction);
      bool grazes = false;
      for (const Vector3d& aside : {Vector3d(2e-5, 0, 0), Vector3d(0, 2e-5, 0), Vector3d(0, 0, 2e-5), Vector3d(-2e-5, 0, 0),
                                    Vector3d(0, -2e-5, 0), Vector3d(0, 0, -2e-5)}) {
        const double beside = expected(origin, (direction + aside).normalized());
        grazes = grazes || std::isfinite(beside) != std::isfinite(truth) || std::abs(beside - truth) > 0.005;
      }
      if (grazes) continue;
      ++compared;
      ASSERT_EQ(std::isfinite(ranges[k]), std::isfinite(truth))
          << "origin " << origin.transpose() << " direction " << direction.transpose();
      if (!std::isfinite(truth)) continue;
      ++hits;
      worst = std::max(worst, std::abs(ranges[k] - truth));
      EXPECT_EQ(retros[k], 7);
    }
  }
  EXPECT_LT(worst, 0.001);
  EXPECT_GT(compared, 15000);
  EXPECT_GT(hits, 1500);
}

TEST(Rays, boxes_are_exact) {
  const Vector3d size(1, 1.4, 0.6);
  for (const bool moving : {false, true}) expect_exact(BoxShape{size}, moving, [&](auto& o, auto& d) { return to_box(o, d, size); });
}
TEST(Rays, spheres_are_exact) {
  for (const bool moving : {false, true}) expect_exact(SphereShape{0.8}, moving, [&](auto& o, auto& d) { return to_sphere(o, d, 0.8); });
}
TEST(Rays, cylinders_are_exact) {
  for (const bool moving : {false, true})
    expect_exact(CylinderShape{0.5, 1.2}, moving, [&](auto& o, auto& d) { return to_cylinder(o, d, 0.5, 1.2); });
}
TEST(Rays, planes_are_exact) {
  expect_exact(PlaneShape{}, false, [&](auto& o, auto& d) {
    const double t = nearest({-o.z() / d.z()});
    return t < 29.9 ? t : infinite;
  });
}
TEST(Rays, meshes_are_exact) {
  std::vector<Vector3d> c;
  MeshShape mesh;
  mesh.path = write_tetrahedron(c);
  for (const bool moving : {false, true}) {
    expect_exact(mesh, moving, [&](auto& o, auto& d) {
      return nearest({to_triangle(o, d, c[0], c[2], c[1]), to_triangle(o, d, c[0], c[1], c[3]), to_triangle(o, d, c[1], c[2], c[3]),
                      to_triangle(o, d, c[2], c[0], c[3])});
    });
  }
  std::filesystem::remove(mesh.path);
}

TEST(Rays, a_sensor_looks_out_of_its_casing_but_sees_the_rest_of_its_robot) {
  TriangleCache triangles;
  RayScene scene(triangles);
  std::vector<std::string> notes;
  const GeometryDef casing = BoxShape{{0.1, 0.1, 0.1}}, mast = CylinderShape{0.05, 1}, wall = BoxShape{{0.1, 10, 10}};
  const std::array<RayShape, 2> robot{RayShape{&casing}, RayShape{&mast, at(0, 0.5, 0)}};
  const RayShape far_wall{&wall};
  scene.add_moving(robot, at(0, 0, 0), notes);
  scene.add_static({&far_wall, 1}, at(3.05, 0, 0), notes);
  scene.commit();
  Beams beams = Beams::fan(2, 0, std::numbers::pi / 2, 1, 0, 0, 0.02F, 10);
  std::vector<float> ranges(2);
  scene.trace(beams, at(0, 0, 0), ranges, {});
  EXPECT_NEAR(ranges[0], 0.05, 1e-4) << "the casing";
  scene.look_out_of(robot, at(0, 0, 0), beams);
  scene.trace(beams, at(0, 0, 0), ranges, {});
  EXPECT_NEAR(ranges[0], 3, 1e-4);
  EXPECT_NEAR(ranges[1], 0.45, 1e-4);
}

TEST(Rays, directions_with_a_component_of_almost_nothing_are_not_lost) {
  TriangleCache triangles;
  RayScene scene(triangles);
  std::vector<std::string> notes;
  const GeometryDef wall = BoxShape{{0.2, 2, 1}};
  const RayShape shape{&wall};
  scene.add_static({&shape, 1}, at(3.1, 0, 0.5), notes);
  scene.add_moving({&shape, 1}, at(-3.1, 0, 0.5, -3e-19), notes);
  scene.commit();
  const Beams beams = Beams::fan(181, -std::numbers::pi / 2, std::numbers::pi / 2, 1, 0, 0, 0, 8);
  for (const double turn : {0.0, std::numbers::pi}) {
    for (const double dust : {-2.4e-19, 2.4e-19, -1e-30, -1e-12}) {
      std::vector<float> ranges(181);
      scene.trace(beams, tilted(0, 3e-19, 0.31, dust, -4.9e-6, turn + dust), ranges, {});
      for (std::size_t i = 84; i < 97; ++i) ASSERT_NEAR(ranges[i], 3, 0.05) << "beam " << i << " dust " << dust;
    }
  }
}

TEST(Rays, bodies_are_seen_where_they_are_after_many_moves) {
  TriangleCache triangles;
  RayScene scene(triangles);
  std::vector<std::string> notes;
  const GeometryDef ball = SphereShape{0.5};
  const RayShape shape{&ball};
  const auto id = scene.add_moving({&shape, 1}, at(2, 0, 0), notes);
  const auto gone = scene.add_moving({&shape, 1}, at(-2, 0, 0), notes);
  for (int i = 0; i < 300; ++i) {
    const double x = 2 + 0.05 * i;
    scene.set_pose(id, at(x, 0, 0));
    scene.commit();
    const RayHit hit = scene.trace_one({0, 0, 0}, {1, 0, 0}, 0, 100);
    ASSERT_NEAR(hit.range, x - 0.5, 1e-4);
    ASSERT_NEAR(hit.normal.x(), -1, 1e-4);
  }
  EXPECT_NEAR(scene.trace_one({0, 0, 0}, {-1, 0, 0}, 0, 100).range, 1.5, 1e-4);
  scene.remove(gone);
  scene.commit();
  EXPECT_FALSE(std::isfinite(scene.trace_one({0, 0, 0}, {-1, 0, 0}, 0, 100).range));
}

TEST(Rays, no_beam_slips_through_the_edge_of_a_box) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> any(-1, 1);
  for (int i = 0; i < 400; ++i) {
    TriangleCache triangles;
    RayScene scene(triangles);
    std::vector<std::string> notes;
    const Vector3d size(0.5 + 0.3 * any(random), 0.5 + 0.3 * any(random), 0.8);
    const GeometryDef box = BoxShape{size};
    const RayShape shape{&box};
    // Every other one on the axis, an edge or a face to the front.
    const double yaw = i % 4 == 0 ? std::numbers::pi / 4 : i % 4 == 1 ? 0 : 3 * any(random);
    const Eigen::Isometry3d pose = at(3 + any(random), i % 4 < 2 ? 0 : any(random), 0.4, yaw);
    i % 8 < 4 ? scene.add_static({&shape, 1}, pose, notes) : scene.add_moving({&shape, 1}, pose, notes);
    scene.commit();
    Vector3d edge(100, 0, 0);
    for (int corner = 0; corner < 4; ++corner) {
      const Vector3d at_corner = pose * Vector3d((corner % 2 - 0.5) * size.x(), (corner / 2 - 0.5) * size.y(), 0);
      if (at_corner.head<2>().norm() < edge.head<2>().norm()) edge = at_corner;
    }
    const double truth = edge.head<2>().norm();
    const std::vector<Eigen::Vector3f> directions(16, Vector3d(edge.x(), edge.y(), 0).cast<float>().normalized());
    const Beams beams(directions, 0, 30);
    for (int k = 0; k < 100; ++k) {
      std::vector<float> ranges(16);
      scene.trace(beams, at(0, 0, 0.1 + 0.006 * k), ranges, {});
      ASSERT_NEAR(ranges[k % 16], truth, 0.001) << "box " << i << " yaw " << yaw;
    }
  }
}

TEST(Rays, see_a_cone_where_its_side_is) {
  TriangleCache triangles;
  RayScene scene(triangles);
  std::vector<std::string> notes;
  const GeometryDef cone = ConeShape{1, 2};
  const RayShape shape{&cone};
  scene.add_static({&shape, 1}, at(5, 0, 1), notes);
  scene.commit();
  const std::vector<Eigen::Vector3f> directions(16, Eigen::Vector3f::UnitX());
  const Beams beams(directions, 0, 30);
  for (const double z : {0.1, 0.5, 1.0, 1.9}) {
    std::vector<float> ranges(16);
    scene.trace(beams, at(0, 0, z), ranges, {});
    EXPECT_NEAR(ranges[0], 5 - (2 - z) / 2, 0.001) << z;
  }
}

// Few moving bodies and many are found in different ways.
TEST(Rays, a_crowd_is_seen_as_few_bodies_are) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(-1, 1);
  TriangleCache triangles;
  std::vector<std::string> notes;
  const GeometryDef ball = SphereShape{0.3}, box = BoxShape{{0.4, 0.6, 0.5}}, floor = PlaneShape{}, wall = BoxShape{{0.1, 30, 2}};
  const RayShape ball_shape{&ball, Eigen::Isometry3d::Identity(), 3, 0xff0000}, box_shape{&box, at(0.2, 0, 0), 5}, floor_shape{&floor},
      wall_shape{&wall};
  RayScene few(triangles), crowd(triangles);
  std::vector<RayBodyId> in_few, in_crowd;
  for (RayScene* scene : {&few, &crowd}) {
    scene->add_static({&floor_shape, 1}, at(0, 0, 0), notes);
    scene->add_static({&wall_shape, 1}, at(9, 0, 1), notes);
    for (int i = 0; i < 10; ++i)
      (scene == &few ? in_few : in_crowd).push_back(scene->add_moving({i % 2 == 0 ? &ball_shape : &box_shape, 1}, at(0, 0, 0), notes));
  }
  for (int i = 0; i < 60; ++i) crowd.add_moving({&ball_shape, 1}, at(-50 - i, 0, 0), notes);  // out of reach
  const Beams beams = Beams::fan(361, -3, 3, 3, -0.2, 0.3, 0, 15);
  std::vector<float> a(beams.size()), b(beams.size()), retro_a(beams.size()), retro_b(beams.size());
  int hits = 0, differ = 0;
  for (int round = 0; round < 50; ++round) {
    for (std::size_t i = 0; i < in_few.size(); ++i) {
      const Eigen::Isometry3d pose =
          tilted(8 * any(random), 8 * any(random), 0.5 + 0.5 * any(random), any(random), any(random), 3 * any(random));
      few.set_pose(in_few[i], pose);
      crowd.set_pose(in_crowd[i], pose);
    }
    few.commit();
    crowd.commit();
    const Eigen::Isometry3d sensor = tilted(0, 0, 0.6, 0.1 * any(random), 0.1 * any(random), any(random));
    few.trace(beams, sensor, a, retro_a);
    crowd.trace(beams, sensor, b, retro_b);
    for (std::size_t i = 0; i < beams.size(); ++i) {
      if (retro_a[i] > 0) ++hits;
      const bool is_same = (std::isinf(a[i]) && std::isinf(b[i])) || std::abs(a[i] - b[i]) < 1e-3F;
      if (!is_same || retro_a[i] != retro_b[i]) ++differ;  // silhouettes, by a hair
      const RayHit one = few.trace_one(sensor.translation(), sensor.linear() * beams.direction(i).cast<double>(), 0, 15);
      const RayHit other = crowd.trace_one(sensor.translation(), sensor.linear() * beams.direction(i).cast<double>(), 0, 15);
      if (one.retro != other.retro || one.color != other.color || (one.normal - other.normal).norm() > 0.01F) ++differ;
    }
  }
  EXPECT_GT(hits, 1500);
  EXPECT_LT(differ, 10);
}

constexpr auto interval = std::chrono::milliseconds(10);

// Gaussian, with a bias that drifts.
NoiseDef drifting() {
  NoiseDef def;
  def.kind = NoiseDef::Kind::gaussian;
  def.stddev = 0.05;
  def.bias_stddev = 0.2;
  def.dynamic_bias_stddev = 0.3;
  def.dynamic_bias_correlation_time = 0.5;
  return def;
}

TEST(Noise, of_a_time_does_not_depend_on_the_samples_before) {
  const RandomStream stream(3, "imu");
  Noise all(drifting(), stream, interval), few(drifting(), stream, interval);
  const auto at = [](Noise& noise, int sample) {
    noise.begin(sample * interval);
    return std::pair(noise.apply(1), noise.apply(2));
  };
  std::vector<std::pair<double, double>> each;
  for (int i = 0; i < 1000; ++i) each.push_back(at(all, i));
  EXPECT_NE(each[1].first, each[2].first);
  for (const int i : {5, 6, 300, 999, 7}) {
    EXPECT_EQ(at(few, i), each[static_cast<std::size_t>(i)]) << i;
    (void)few.apply(0);
  }
}

TEST(Noise, between_two_samples_has_the_bias_of_the_first) {
  NoiseDef def = drifting();
  def.stddev = 0;
  Noise noise(def, RandomStream(3, "imu"), interval);
  noise.begin(5 * interval);
  const double value = noise.apply(0);
  noise.begin(5 * interval + interval / 2);
  EXPECT_EQ(noise.apply(0), value);
  noise.begin(6 * interval);
  EXPECT_NE(noise.apply(0), value);
}

TEST(Noise, a_bias_that_drifts_has_the_deviation_and_the_correlation_time_asked_for) {
  NoiseDef def = drifting();
  def.stddev = def.bias_stddev = 0;
  Noise noise(def, RandomStream(3, "imu"), interval);
  constexpr int count = 400000, lag = 50;  // the correlation time
  std::vector<double> bias;
  for (int i = 0; i < count; ++i) {
    noise.begin(i * interval);
    bias.push_back(noise.apply(0));
  }
  double squares = 0, products = 0;
  for (int i = lag; i < count; ++i) {
    const auto now = static_cast<std::size_t>(i);
    squares += bias[now] * bias[now], products += bias[now] * bias[now - lag];
  }
  EXPECT_NEAR(std::sqrt(squares / (count - lag)), 0.3, 0.015);
  EXPECT_NEAR(products / squares, std::exp(-1), 0.05);
}

TEST(Noise, has_the_mean_and_deviation_asked_for) {
  NoiseDef def;
  def.kind = NoiseDef::Kind::gaussian;
  def.mean = 0.02;
  def.stddev = 0.05;
  Noise noise(def, RandomStream(1, "robot::laser"), interval);
  std::vector<float> ranges(100000, 5.0F);
  ranges[7] = std::numeric_limits<float>::infinity();
  noise.apply(ranges, 0);
  EXPECT_TRUE(std::isinf(ranges[7]));
  double sum = 0, squares = 0;
  int n = 0;
  for (const float range : ranges) {
    if (std::isinf(range)) continue;
    sum += range - 5, squares += (range - 5) * (range - 5), ++n;
  }
  const double mean = sum / n;
  EXPECT_NEAR(mean, 0.02, 0.001);
  EXPECT_NEAR(std::sqrt(squares / n - mean * mean), 0.05, 0.001);
}

TEST(Noise, gaussian_numbers_have_the_shape_of_the_bell) {
  RandomStream stream(5, "bell");
  constexpr int count = 2000000;
  double sums[5] = {};
  int beyond[6] = {};
  for (int i = 0; i < count; ++i) {
    const double x = stream.gaussian();
    for (int power = 1; power <= 4; ++power) sums[power] += std::pow(x, power) / count;
    for (int limit = 1; limit <= 5; ++limit) beyond[limit] += std::abs(x) > limit ? 1 : 0;
  }
  EXPECT_NEAR(sums[1], 0, 0.003);
  EXPECT_NEAR(sums[2], 1, 0.005);
  EXPECT_NEAR(sums[3], 0, 0.015);
  EXPECT_NEAR(sums[4], 3, 0.04);
  // Five standard deviations of each count.
  for (int limit = 1; limit <= 5; ++limit) {
    const double expected = count * std::erfc(limit / std::sqrt(2.0));
    EXPECT_NEAR(beyond[limit], expected, 5 * std::sqrt(expected) + 1) << "beyond " << limit;
  }
}

TEST(Noise, many_numbers_at_once_are_those_that_come_one_by_one) {
  RandomStream one(5, "bell"), all(5, "bell");
  std::vector<double> numbers(100000);
  all.fill(std::span(numbers).first(1001));
  all.fill(std::span(numbers).subspan(1001));
  for (std::size_t i = 0; i < numbers.size(); ++i) ASSERT_EQ(numbers[i], one.gaussian()) << i;
  EXPECT_EQ(all.next(), one.next());
}

TEST(Noise, rounds_to_the_nearest_step_and_halves_away_from_zero) {
  NoiseDef def;
  def.kind = NoiseDef::Kind::gaussian_quantized;
  def.precision = 0.25;
  Noise noise(def, RandomStream(1, "a"), interval);
  std::vector<float> ranges{0.125F, -0.125F, 0.124999F, 2.375F, -2.375F, 1e30F, -0.01F};
  noise.apply(ranges, 0);
  EXPECT_EQ(ranges, (std::vector<float>{0.25F, -0.25F, 0, 2.5F, -2.5F, 1e30F, 0}));
  EXPECT_TRUE(std::signbit(ranges[6]));
}

TEST(Noise, differs_by_seed_and_name_and_repeats_otherwise) {
  RandomStream a(1, "laser"), b(1, "laser"), other_name(1, "sonar"), other_seed(2, "laser");
  const auto first = a.next();
  EXPECT_EQ(first, b.next());
  EXPECT_NE(first, other_name.next());
  EXPECT_NE(first, other_seed.next());
  EXPECT_EQ(RandomStream(1, "laser").next(), 2522533932632556808U) << "must be the same on every machine";
  EXPECT_NE(RandomStream(1, "laser").at(1).next(), RandomStream(1, "laser").at(2).next());
}

TEST(Noise, ranges_are_multiples_of_the_resolution) {
  Noise noise({}, RandomStream(1, "laser"), interval);
  std::vector<float> ranges{1.2344F, 1.2346F};
  noise.apply(ranges, 0.001F);
  EXPECT_FLOAT_EQ(ranges[0], 1.234F);
  EXPECT_FLOAT_EQ(ranges[1], 1.235F);
}

}  // namespace
}  // namespace sim
