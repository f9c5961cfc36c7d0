// How the follower finds its leader in a scan, keeps it, loses it, and how fast it drives then.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "leader_tracker.h"
#include "steering.h"

namespace follow {
namespace {

constexpr double pi = std::numbers::pi, max_range = 8;

struct Disc {
  double x, y, radius;
};

// What a scanner with 361 beams over half a circle sees of discs; from the origin, along x.
class Scene {
 public:
  explicit Scene(const std::vector<Disc>& discs) {
    for (std::size_t i = 0; i < ranges_.size(); ++i) {
      const double angle = -pi / 2 + static_cast<double>(i) * step;
      for (const Disc& disc : discs) {
        const double along = disc.x * std::cos(angle) + disc.y * std::sin(angle),
                     beside = disc.x * std::sin(angle) - disc.y * std::cos(angle);
        if (along <= 0 || std::abs(beside) >= disc.radius) continue;
        ranges_[i] = std::min(ranges_[i], static_cast<float>(along - std::sqrt(disc.radius * disc.radius - beside * beside)));
      }
    }
  }
  Scan scan() const { return {-pi / 2, step, max_range, ranges_}; }

 private:
  static constexpr double step = pi / 360;
  std::vector<float> ranges_ = std::vector<float>(361, static_cast<float>(max_range));
};

constexpr Pose origin{};

TEST(Clusters, things_that_stand_apart_are_told_apart) {
  const Scene scene({{2, 0, 0.2}, {1, 1, 0.15}, {1, -1, 0.1}});
  const auto clusters = find_clusters(scene.scan(), origin, 0.15);
  ASSERT_EQ(clusters.size(), 3U);
  EXPECT_NEAR(clusters[0].centre.y, -0.93, 0.03);
  EXPECT_NEAR(clusters[1].centre.x, 1.83, 0.03);
  EXPECT_NEAR(clusters[1].width, 0.4, 0.03);
  EXPECT_GT(clusters[2].first, clusters[1].last);
}

TEST(Clusters, scan_without_hits_and_empty_scan_have_none) {
  EXPECT_TRUE(find_clusters(Scene({}).scan(), origin, 0.15).empty());
  EXPECT_TRUE(find_clusters({0, 0.1, 8, {}}, origin, 0.15).empty());
}

TEST(Clusters, place_of_the_scanner_on_the_robot_counts) {
  const Scene scene({{2, 0, 0.2}});
  const auto clusters = find_clusters(scene.scan(), {0.1, 0.5, pi / 2}, 0.15);
  ASSERT_EQ(clusters.size(), 1U);
  EXPECT_NEAR(clusters[0].centre.x, 0.1, 0.01);
  EXPECT_NEAR(clusters[0].centre.y, 2.33, 0.03);
}

TEST(Tracker, starts_with_the_nearest_thing_of_fitting_width_ahead) {
  LeaderTracker tracker;
  const Scene scene({{0.8, -1, 0.05}, {1.2, 0, 0.7}, {1.8, 1.8, 0.2}, {3, -2.5, 0.2}, {0, 1, 0.2}});
  const auto leader = tracker.update(scene.scan(), origin, origin, 1);
  ASSERT_TRUE(leader);  // not what is too thin, too wide, or beside
  EXPECT_NEAR(leader->distance, std::hypot(1.8, 1.8) - 0.17, 0.05);
  EXPECT_NEAR(leader->bearing, pi / 4, 0.02);
}

TEST(Tracker, keeps_to_its_leader_when_something_else_comes_nearer) {
  LeaderTracker tracker;
  ASSERT_TRUE(tracker.update(Scene({{2, 0, 0.2}}).scan(), origin, origin, 1));
  const auto leader = tracker.update(Scene({{2.1, 0.1, 0.2}, {1, -0.6, 0.2}}).scan(), origin, origin, 1.1);
  ASSERT_TRUE(leader);
  EXPECT_NEAR(leader->distance, 1.93, 0.05);
}

TEST(Tracker, own_turns_do_not_move_the_leader) {
  LeaderTracker tracker;
  ASSERT_TRUE(tracker.update(Scene({{2, 0, 0.2}, {1.6, 1.2, 0.2}}).scan(), origin, origin, 1));
  // Half a radian to the left: both things are that much further to the right.
  const double c = std::cos(0.5), s = std::sin(0.5);
  const Scene turned({{2 * c, -2 * s, 0.2}, {1.6 * c + 1.2 * s, -1.6 * s + 1.2 * c, 0.2}});
  const auto leader = tracker.update(turned.scan(), origin, {0, 0, 0.5}, 1.2);
  ASSERT_TRUE(leader);
  EXPECT_NEAR(leader->bearing, -0.5, 0.02);
}

TEST(Tracker, leader_that_jumps_away_or_hides_is_lost_and_found_again_near_where_it_was) {
  LeaderTracker tracker;
  ASSERT_TRUE(tracker.update(Scene({{2, 0, 0.2}}).scan(), origin, origin, 1));
  EXPECT_FALSE(tracker.update(Scene({{4, 0, 0.2}}).scan(), origin, origin, 1.1));
  EXPECT_NEAR(*tracker.unseen(1.5), 0.5, 1e-9);
  EXPECT_TRUE(tracker.update(Scene({{2.9, 0, 0.2}}).scan(), origin, origin, 2));  // it may have driven half a metre meanwhile
  EXPECT_FALSE(tracker.update(Scene({{6, 1, 0.2}}).scan(), origin, origin, 4));
  EXPECT_TRUE(tracker.update(Scene({{6, 1, 0.2}}).scan(), origin, origin, 8));  // any leader will do by now
}

// A new simulator, a reset, an odometry that somebody has set: where the leader was says nothing, and the wait for it makes its gate wide.
TEST(Tracker, odometry_that_jumps_makes_it_look_for_any_leader_ahead) {
  const Scene scene({{1.2, 0, 0.2}, {2, 1.6, 0.3}});
  for (const Pose& before : {Pose{2.6, 1.8, 0}, Pose{0, 0, 1}, Pose{0, 0, -3}}) {
    LeaderTracker tracker;
    ASSERT_TRUE(tracker.update(Scene({{2, 0, 0.2}}).scan(), origin, before, 1));
    const auto leader = tracker.update(scene.scan(), origin, origin, 1.1);
    ASSERT_TRUE(leader) << before.x << ' ' << before.a;
    EXPECT_NEAR(leader->distance, 1.03, 0.05);
    EXPECT_NEAR(leader->bearing, 0, 0.02);
  }
  LeaderTracker tracker;  // of a server whose time goes back
  ASSERT_TRUE(tracker.update(Scene({{2, 1.6, 0.3}}).scan(), origin, origin, 100));
  const auto leader = tracker.update(scene.scan(), origin, origin, 1);
  ASSERT_TRUE(leader);
  EXPECT_NEAR(leader->distance, 1.03, 0.05);
  // Fast and late is no jump.
  ASSERT_TRUE(tracker.update(Scene({{2, 1.6, 0.3}, {1.2, 0, 0.2}}).scan(), origin, {0.3, 0, 0.4}, 1.4));
}

TEST(Tracker, wall_beside_the_leader_is_not_taken_for_it) {
  LeaderTracker tracker;
  ASSERT_TRUE(tracker.update(Scene({{2, 0, 0.2}}).scan(), origin, origin, 1));
  EXPECT_FALSE(tracker.update(Scene({{5, 0, 3}}).scan(), origin, origin, 1.1));
  EXPECT_EQ(LeaderTracker().unseen(1), std::nullopt);
}

TEST(Towards, drives_after_the_leader_within_its_limits) {
  const SteeringSettings settings;
  const auto velocity = [&](double distance, double bearing) { return towards({distance, bearing, 0, 0}, settings); };
  EXPECT_NEAR(velocity(1.1, 0).forward, 0.18, 1e-9);
  EXPECT_NEAR(velocity(1.1, 0.2).turn, 0.32, 1e-9);
  EXPECT_EQ(velocity(5, 0).forward, 0.5);
  EXPECT_EQ(velocity(5, 1.5).turn, 1.0);
  EXPECT_EQ(velocity(5, -1.5).turn, -1.0);
  EXPECT_EQ(velocity(0.8, 0).forward, 0);  // it never reverses
  EXPECT_EQ(velocity(0.3, 0).forward, 0);
  EXPECT_EQ(velocity(2, 2).forward, 0);  // the leader is behind
}

TEST(Around, only_what_is_near_and_not_the_leader_is_avoided) {
  const SteeringSettings settings;
  const auto decide = [&](const std::vector<Disc>& others) {
    std::vector<Disc> all = others;
    all.push_back({0.45, 0, 0.1});
    const Scene scene(all);
    const auto clusters = find_clusters(scene.scan(), origin, 0.15);
    for (const Cluster& cluster : clusters) {
      if (std::abs(cluster.centre.y) < 0.05) return around(scene.scan(), {0.35, 0, cluster.first, cluster.last}, settings);
    }
    throw std::runtime_error("no leader");
  };
  EXPECT_FALSE(decide({}));
  EXPECT_FALSE(decide({{0.5, 0.8, 0.1}}));
  const auto left = decide({{0.1, 0.5, 0.1}});
  ASSERT_TRUE(left);
  EXPECT_LT(left->turn, 0);  // away from it
  const auto right = decide({{0.1, -0.5, 0.1}});
  ASSERT_TRUE(right);
  EXPECT_GT(right->turn, 0);
  const auto both = decide({{0.1, 0.5, 0.1}, {0.1, -0.5, 0.1}});
  ASSERT_TRUE(both);
  EXPECT_NEAR(both->turn, 0, 0.05);
  EXPECT_EQ(both->forward, 0);
}

}  // namespace
}  // namespace follow
