// Volumes below a plane, against the formulas of school.
#include "physics/displacement.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/worlds.h"

namespace sim {
namespace {

using test::tilted;

const Eigen::Vector3d up(0, 0, 1);

Displacement shape(const GeometryDef& geometry) {
  TriangleCache triangles;
  auto made = Displacement::of(geometry, triangles);
  if (!made) throw std::runtime_error("no volume");
  return std::move(*made);
}

Eigen::Vector3d middle(const Displacement::Part& part) { return part.moment / part.volume; }

TEST(Displacement, of_a_level_box_is_its_part_below) {
  const auto box = shape(BoxShape{{2, 1, 0.6}});
  EXPECT_NEAR(box.whole().volume, 1.2, 1e-12);
  const auto part = box.below(up, -0.05);
  EXPECT_NEAR(part.volume, 2 * 0.25, 1e-12);
  EXPECT_TRUE(middle(part).isApprox(Eigen::Vector3d(0, 0, -0.175), 1e-12)) << middle(part).transpose();
  EXPECT_EQ(box.below(up, 0.3).volume, box.whole().volume);
  EXPECT_EQ(box.below(up, -0.3).volume, 0);
}

TEST(Displacement, of_a_box_on_its_edge_is_a_prism) {
  const auto box = shape(BoxShape{{1, 1, 1}});
  const Eigen::Vector3d normal = Eigen::Vector3d(1, 0, 1).normalized();
  const double depth = 0.2;  // of the edge
  const auto part = box.below(normal, -std::sqrt(0.5) + depth);
  EXPECT_NEAR(part.volume, depth * depth, 1e-12);
  EXPECT_NEAR(normal.dot(middle(part)), -std::sqrt(0.5) + 2 * depth / 3, 1e-12);
}

TEST(Displacement, of_balls_and_ellipsoids_is_a_cap) {
  const auto ball = shape(SphereShape{0.5});
  EXPECT_NEAR(ball.whole().volume, std::numbers::pi / 6, 1e-12);
  const auto half = ball.below(Eigen::Vector3d(0.6, 0, 0.8), 0);
  EXPECT_NEAR(half.volume, std::numbers::pi / 12, 1e-12);
  EXPECT_TRUE(middle(half).isApprox(-0.375 * 0.5 * Eigen::Vector3d(0.6, 0, 0.8), 1e-12));
  const double cap = 0.1;
  EXPECT_NEAR(ball.below(up, -0.5 + cap).volume, std::numbers::pi * cap * cap * (1.5 - cap) / 3, 1e-12);
  const auto egg = shape(EllipsoidShape{{1, 2, 3}});
  EXPECT_NEAR(egg.below(up, 0).volume, 4 * std::numbers::pi, 1e-9);
  EXPECT_NEAR(middle(egg.below(up, 0)).z(), -0.375 * 3, 1e-12);
}

TEST(Displacement, of_cylinders_and_capsules_has_their_volume) {
  const auto cylinder = shape(CylinderShape{0.3, 2});
  EXPECT_NEAR(cylinder.whole().volume, std::numbers::pi * 0.09 * 2, 1e-9);
  EXPECT_NEAR(cylinder.below(up, 0.5).volume, std::numbers::pi * 0.09 * 1.5, 1e-9);
  EXPECT_NEAR(cylinder.below({1, 0, 0}, 0).volume, std::numbers::pi * 0.09, 1e-9);
  EXPECT_NEAR(cylinder.below({1, 0, 0}, -0.15).volume, 2 * 0.09 * (std::acos(0.5) - 0.5 * std::sqrt(0.75)), 2e-4);
  const auto capsule = shape(CapsuleShape{0.2, 1});
  EXPECT_NEAR(capsule.whole().volume, std::numbers::pi * (0.04 + 4.0 / 3 * 0.008), 2e-4);
}

// A hollow without a lid, as the hulls of files are, and the same closed: turned in all directions, far beyond one block of faces.
TEST(Displacement, of_many_faces_is_that_of_the_few) {
  const auto fine = shape(PolylineShape{{[] {
                                          std::vector<Eigen::Vector2d> corners;
                                          for (int side = 0; side < 4; ++side) {
                                            const Eigen::Vector2d from =
                                                std::array{Eigen::Vector2d(-1, -0.5), Eigen::Vector2d(1, -0.5), Eigen::Vector2d(1, 0.5),
                                                           Eigen::Vector2d(-1, 0.5)}[static_cast<std::size_t>(side)];
                                            const Eigen::Vector2d to =
                                                std::array{Eigen::Vector2d(1, -0.5), Eigen::Vector2d(1, 0.5), Eigen::Vector2d(-1, 0.5),
                                                           Eigen::Vector2d(-1, -0.5)}[static_cast<std::size_t>(side)];
                                            for (int i = 0; i < 100; ++i) corners.emplace_back(from + (to - from) * i / 100);
                                          }
                                          return corners;
                                        }()},
                                        0.6});
  const auto coarse = shape(BoxShape{{2, 1, 0.6}});
  EXPECT_NEAR(fine.whole().volume, 1.2, 1e-9);
  for (const auto& turn : {tilted(0, 0, 0, 0.3, -0.2), tilted(0, 0, 0, 2, 1, 0.4), tilted(0, 0, 0, 0, 0)}) {
    const Eigen::Vector3d normal = turn.linear().row(2);
    for (const double height : {-0.4, -0.1, 0.0, 0.25, 0.5}) {
      const auto a = fine.below(normal, height + 0.3 * normal.z()), b = coarse.below(normal, height);
      EXPECT_NEAR(a.volume, b.volume, 1e-9);
      EXPECT_LT((a.moment - Eigen::Vector3d(0, 0, 0.3) * a.volume - b.moment).norm(), 1e-9);
    }
  }
}

TEST(Displacement, planes_have_none) {
  TriangleCache triangles;
  EXPECT_FALSE(Displacement::of(PlaneShape{}, triangles));
}

}  // namespace
}  // namespace sim
