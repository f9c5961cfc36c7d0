// Actors: skins that bend, animations of them, and where way points and steps lead.
#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "devices/actor_motion.h"
#include "support/paths.h"
#include "support/simulation_fixture.h"
#include "support/studio.h"

namespace sim {
namespace {

using namespace test;

const std::string cow = std::string(paths::source_dir) + "/worlds/models/cow/meshes/walking_cow.dae";

Eigen::Isometry3d put(double x, double y, double z, double yaw = 0) { return test::at(x, y, z, yaw, 0.0, 0.0); }

Eigen::Vector3f place(const Vertex& vertex) { return Eigen::Map<const Eigen::Vector3f>(vertex.position.data()); }

SkinFile read_cow(double scale = 1) {
  auto file = read_skin_file(cow, scale);
  if (!file) throw std::runtime_error(file.error().message);
  return std::move(*file);
}
SkinAnimation cow_steps(const Skin& skin, double scale = 1) {
  auto steps = read_skin_animation(cow, scale, skin);
  if (!steps) throw std::runtime_error(steps.error().message);
  return std::move(*steps);
}

// A file that lives as long as the test.
struct TextFile {
  std::string path;
  TextFile(const std::string& ending, const std::string& text)
      : path(std::filesystem::temp_directory_path() / ("actor_test_" + std::to_string(::getpid()) + ending)) {
    std::ofstream(path) << text;
  }
  ~TextFile() { std::filesystem::remove(path); }
};

TEST(Skin, vertices_follow_their_bones_by_their_shares) {
  Skin skin;
  skin.scale = 2;
  Eigen::Affine3d up = Eigen::Affine3d::Identity();
  up.translation() = Eigen::Vector3d(0, 0, 1);
  skin.nodes = {{"low", -1, Eigen::Affine3d::Identity()}, {"high", 0, up}};
  skin.bones = {{0, Eigen::Affine3d(Eigen::Scaling(2.0))}, {1, Eigen::Affine3d(Eigen::Scaling(2.0)) * up.inverse()}};
  for (const float z : {0.5F, 1.5F, 2.0F}) skin.vertices.push_back({{0, 0, z}, {1, 0, 0}, {0, 0}});
  skin.weights = {{{0, 0, 0, 0}, {1, 0, 0, 0}}, {{1, 0, 0, 0}, {0.5F, 0.5F, 0, 0}}, {{1, 0, 0, 0}, {1, 0, 0, 0}}};
  SkinAnimation animation;
  animation.length = 1;
  SkinAnimation::Track track;
  track.node = 1;
  track.rotation_times = {0, 1};
  track.rotations = {Eigen::Quaterniond::Identity(), Eigen::Quaterniond(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitY()))};
  animation.tracks = {track};
  std::vector<Vertex> bent;
  bend(skin, bone_poses(skin, &animation, 1, false), bent);
  EXPECT_TRUE(place(bent[0]).isApprox(Eigen::Vector3f(0, 0, 1), 1e-5F)) << place(bent[0]).transpose();
  EXPECT_TRUE(place(bent[1]).isApprox(Eigen::Vector3f(0.5F, 0, 2.5F), 1e-5F)) << "half way: " << place(bent[1]).transpose();
  EXPECT_TRUE(place(bent[2]).isApprox(Eigen::Vector3f(2, 0, 2), 1e-5F)) << place(bent[2]).transpose();
  EXPECT_NEAR(bent[2].normal[2], -1, 1e-5);
  bend(skin, bone_poses(skin, &animation, 0.5, false), bent);
  EXPECT_NEAR(place(bent[2]).x(), 2 * std::sin(M_PI / 4), 1e-5);
  bend(skin, bone_poses(skin, nullptr, 0.5, false), bent);
  EXPECT_TRUE(place(bent[2]).isApprox(Eigen::Vector3f(0, 0, 4), 1e-5F)) << "at rest: " << place(bent[2]).transpose();
}

TEST(Skin, at_rest_it_is_the_mesh_without_limbs) {
  MeshShape shape;
  shape.path = std::filesystem::path(cow).replace_filename("cow.obj");
  shape.scale.setConstant(0.5);
  const auto plain = read_mesh_file(shape);
  ASSERT_TRUE(plain.ok());
  const SkinFile skin = read_cow(0.5);
  EXPECT_EQ(skin.skin.bones.size(), 11U);
  EXPECT_EQ(skin.mesh.indices.size(), plain->mesh.indices.size());
  EXPECT_LT((skin.mesh.bounds.min() - plain->mesh.bounds.min()).norm(), 1e-3F);
  EXPECT_LT((skin.mesh.bounds.max() - plain->mesh.bounds.max()).norm(), 1e-3F);
  EXPECT_EQ(skin.mesh.parts.size(), plain->mesh.parts.size());
}

TEST(Skin, a_round_of_steps_leads_as_far_as_it_says) {
  const SkinFile skin = read_cow(0.5);
  const SkinAnimation steps = cow_steps(skin.skin, 0.5);
  EXPECT_NEAR(steps.length, 1.25, 1e-3);
  EXPECT_NEAR(steps.stride, 0.5, 1e-3);
  EXPECT_NEAR(time_at_distance(steps, 0.125), 0.3125, 1e-3);
  EXPECT_NEAR(time_at_distance(steps, 7 * 0.5 + 0.125), 0.3125, 1e-3) << "in a later round";
  EXPECT_NEAR(time_at_distance(steps, 0), 0, 1e-6);
}

TEST(Skin, feet_go_to_and_fro_below_a_body_that_stays) {
  const SkinFile skin = read_cow();
  const SkinAnimation steps = cow_steps(skin.skin);
  float most = 0, trunk = 0, lifted = 0;
  std::vector<Vertex> bent;
  for (int i = 0; i < 20; ++i) {
    bend(skin.skin, bone_poses(skin.skin, &steps, steps.length * i / 20, true), bent);
    for (std::size_t v = 0; v < bent.size(); ++v) {
      const Eigen::Vector3f rest = place(skin.mesh.vertices[v]), way = place(bent[v]) - rest;
      if (rest.z() < 0.1F) most = std::max(most, std::abs(way.x())), lifted = std::max(lifted, way.z());
      if (rest.z() > 1.1F && std::abs(rest.x()) < 0.5F) trunk = std::max(trunk, way.norm());
    }
  }
  EXPECT_GT(most, 0.2F);
  EXPECT_GT(lifted, 0.05F);
  EXPECT_LT(trunk, 0.05F);
  bend(skin.skin, bone_poses(skin.skin, &steps, steps.length, false), bent);
  EXPECT_NEAR(place(bent[0]).x() - place(skin.mesh.vertices[0]).x(), 1.0F, 0.05F) << "without a way of its own it goes";
}

TEST(Skin, animations_of_other_files_move_the_nodes_that_they_name) {
  const TextFile file(
      ".bvh",
      "HIERARCHY\nROOT hips\n{\n OFFSET 0 0 0\n CHANNELS 6 Xposition Yposition Zposition Zrotation Yrotation Xrotation\n"
      " JOINT neck\n {\n  OFFSET 0.8 0 0.15\n  CHANNELS 3 Zrotation Yrotation Xrotation\n  End Site\n  {\n   OFFSET 0.3 0 0\n  }\n }\n}\n"
      "MOTION\nFrames: 3\nFrame Time: 0.5\n0 0 1 0 0 0 0 0 0\n0.5 0 1 0 0 0 90 0 0\n1 0 1 0 0 0 0 0 0\n");
  const SkinFile skin = read_cow();
  const auto nod = read_skin_animation(file.path, 1, skin.skin);
  ASSERT_TRUE(nod.ok()) << nod.error().message;
  EXPECT_EQ(nod->tracks.size(), 2U);
  EXPECT_NEAR(nod->length, 1, 1e-6);
  EXPECT_NEAR(nod->stride, 1, 1e-6);
  const auto poses = bone_poses(skin.skin, &*nod, 0.5, true);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const std::string& name = skin.skin.nodes[skin.skin.bones[i].node].name;
    const double yaw = std::atan2(poses[i].linear()(1, 0), poses[i].linear()(0, 0));
    EXPECT_NEAR(yaw, name == "neck" ? M_PI / 2 : 0, 1e-5) << name;
  }
}

TEST(Skin, what_does_not_fit_is_refused_with_a_reason) {
  const SkinFile skin = read_cow();
  const TextFile other(
      ".bvh",
      "HIERARCHY\nROOT tail_of_a_fish\n{\n OFFSET 0 0 0\n CHANNELS 3 Zrotation Yrotation Xrotation\n End Site\n {\n  OFFSET 1 0 0\n }\n}\n"
      "MOTION\nFrames: 2\nFrame Time: 0.5\n0 0 0\n9 0 0\n");
  EXPECT_THAT(read_skin_animation(other.path, 1, skin.skin).error().message, testing::HasSubstr("moves no part of the skin"));
  EXPECT_FALSE(read_skin_animation("/nowhere/walk.dae", 1, skin.skin).ok());
  EXPECT_FALSE(read_skin_file("/nowhere/walk.dae", 1).ok());
  const auto still = read_skin_animation(std::filesystem::path(cow).replace_filename("cow.obj"), 1, skin.skin);
  EXPECT_THAT(still.error().message, testing::HasSubstr("has no animation"));
}

ActorDef walker() {
  ActorDef actor;
  actor.name = "walker";
  actor.skin = cow;
  actor.animations = {{"stand", cow, 1, false}, {"walk", cow, 1, true}};
  actor.trajectories = {{0, "walk", 1, {{0, put(0, 0, 0)}, {4, put(2, 0, 0)}, {8, put(2, 4, 0, M_PI / 2)}}},
                        {1, "stand", 1, {{0, put(2, 4, 0)}, {2, put(2, 4, 0)}}}};
  return actor;
}

TEST(ActorMotion, knows_place_way_and_animation_of_each_moment) {
  const ActorMotion motion(walker());
  const auto early = motion.at(2);
  EXPECT_TRUE(early.pose.translation().isApprox(Eigen::Vector3d(1, 0, 0), 1e-9)) << early.pose.translation().transpose();
  EXPECT_NEAR(early.distance, 1, 1e-9);
  EXPECT_EQ(early.animation, 1U);
  EXPECT_NEAR(motion.at(6).distance, 4, 1e-9) << "round the corner";
  const auto standing = motion.at(9.5);
  EXPECT_EQ(standing.animation, 0U);
  EXPECT_NEAR(standing.seconds, 1.5, 1e-9) << "since that trajectory began";
  EXPECT_NEAR(standing.distance, 6, 1e-9);
  EXPECT_NEAR(motion.at(12).distance, 7, 1e-9) << "the second round goes on from the first";
  EXPECT_NEAR(motion.at(12).pose.translation().x(), 1, 1e-9);
}

TEST(ActorMotion, begins_late_ends_once_or_never_begins) {
  ActorDef actor = walker();
  actor.pose = put(5, 5, 0);
  actor.delay_start = 3;
  actor.loop = false;
  EXPECT_NEAR(ActorMotion(actor).at(2).pose.translation().x(), 5, 1e-9);
  EXPECT_NEAR(ActorMotion(actor).at(5).pose.translation().x(), 1, 1e-9);
  EXPECT_NEAR(ActorMotion(actor).at(99).pose.translation().y(), 4, 1e-9);
  EXPECT_NEAR(ActorMotion(actor).at(99).distance, 6, 1e-9);
  actor.auto_start = false;
  EXPECT_NEAR(ActorMotion(actor).at(50).pose.translation().x(), 5, 1e-9);
  actor.trajectories.clear();
  EXPECT_EQ(ActorMotion(actor).at(50).animation, 0U) << "without a way it plays its first animation";
  actor.trajectories = {{0, "swim", 1, {{0, put(0, 0, 0)}, {1, put(1, 0, 0)}}}};
  actor.auto_start = true;
  EXPECT_EQ(ActorMotion(actor).at(3.5).animation, std::nullopt);
}

// A camera beside the actor, at the height of its legs.
struct Pasture : SimulationFixture {
  using SimulationFixture::SimulationFixture;
  Image picture(double seconds, double y = 0) { return picture_from(put(0, y - 4, 0.6, M_PI / 2), seconds); }
  Image picture_from(const Eigen::Isometry3d& eye, double seconds) {
    const Snapshot world = simulation->pictures().snapshot(std::chrono::nanoseconds(std::llround(seconds * 1e9)));
    const View view = View::pinhole(eye, 0.8, 160, 120);
    if (auto drawn = shared_renderer().draw(world.scene, *world.poses, view); !drawn) throw std::runtime_error(drawn.error().message);
    Image image{view.width, view.height, std::vector<std::uint8_t>(static_cast<std::size_t>(view.width * view.height) * 4)};
    shared_renderer().read_rgba(image.rgba);
    return image;
  }
};

int difference(const Image& a, const Image& b) {
  int count = 0;
  for (std::size_t i = 0; i < a.rgba.size(); i += 4) count += std::abs(a.rgba[i] - b.rgba[i]) > 40 ? 1 : 0;
  return count;
}

WorldDef pasture(std::vector<ActorDef> actors) {
  WorldDef world = dark_world();
  world.scene.ambient = {1, 1, 1, 1};
  world.actors = std::move(actors);
  return world;
}

TEST(Actor, its_limbs_move_in_the_picture_and_are_the_same_each_time) {
  ActorDef actor = walker();
  actor.trajectories = {{0, "stand", 0, {{0, put(0, 0, 0)}, {100, put(0, 0, 0)}}}};
  Pasture field(pasture({actor}));
  const Image first = field.picture(0.0);
  EXPECT_GT(difference(first, field.picture(0.3)), 150);
  EXPECT_GT(difference(field.picture(0.3), field.picture(0.6)), 150);
  EXPECT_EQ(first.rgba, field.picture(0.0).rgba);
  EXPECT_LT(difference(first, field.picture(1.25)), 5) << "a whole round later";
  EXPECT_TRUE(field.simulation->pictures().snapshot(std::chrono::nanoseconds(0)).scene->actors[0].animations[0]) << "it was read";
}

// The sun stands low behind it; the camera sees the ground where the shadows of its legs fall, and nothing of itself.
TEST(Actor, the_shadows_of_its_limbs_move_with_them) {
  ActorDef actor = walker();
  actor.trajectories = {{0, "stand", 0, {{0, put(0, 0, 0)}, {100, put(0, 0, 0)}}}};
  WorldDef world = pasture({actor});
  world.scene.ambient = {0, 0, 0, 1};
  world.lights.push_back(sun({0, 1, -0.4}, {0.8F, 0.8F, 0.8F, 1}, true));
  world.models.push_back(one_visual_model("floor", PlaneShape{{0, 0, 1}, {40, 40}}, put(0, 0, 0), plain_material({1, 1, 1, 1})));
  Pasture field(world);
  const Eigen::Isometry3d from_above = test::at(0, 1.1, 2, M_PI / 2, M_PI / 2, 0);
  const auto shadows = [&](double seconds) { return field.picture_from(from_above, seconds); };
  const Image first = shadows(0.0);
  const auto dark = [](const Image& image) {
    int count = 0;
    for (std::size_t i = 0; i < image.rgba.size(); i += 4) count += image.rgba[i] < 40 ? 1 : 0;
    return count;
  };
  EXPECT_GT(dark(first), 300);
  EXPECT_GT(difference(first, shadows(0.3)), 150);
  EXPECT_LT(difference(first, shadows(1.25)), 5) << "a whole round later";
  world.lights.clear();
  world.scene.ambient = {1, 1, 1, 1};
  const Image ground = Pasture(world).picture_from(from_above, 0);
  for (std::size_t i = 0; i < ground.rgba.size(); i += 4) ASSERT_EQ(ground.rgba[i], ground.rgba[0]) << "more than the ground is seen";
}

TEST(Actor, two_with_one_skin_each_have_their_own_steps) {
  ActorDef one = walker(), other = walker();
  one.trajectories = {{0, "stand", 0, {{0, put(0, 0, 0)}, {100, put(0, 0, 0)}}}};
  other.name = "other";
  other.pose = put(0, 20, 0);
  other.delay_start = 0.6;
  other.trajectories = {{0, "stand", 0, {{0, put(0, 20, 0)}, {100, put(0, 20, 0)}}}};
  Pasture field(pasture({one, other}));
  EXPECT_GT(difference(field.picture(0.3, 0), field.picture(0.3, 20)), 150);
  EXPECT_LT(difference(field.picture(0.3, 0), field.picture(0.9, 20)), 60) << "but for edges: it stands elsewhere";
}

TEST(Actor, it_steps_as_far_as_it_goes_and_stands_when_it_stands) {
  ActorDef actor = walker();
  // The same place on three ways: after a whole metre, after one and a half, and after nothing.
  const auto arrive = [&](double from) {
    actor.trajectories = {{0, "walk", 1, {{0, put(from, 0, 0)}, {1, put(0, 0, 0)}, {50, put(0, 0, 0)}}}};
    return Pasture(pasture({actor})).picture(7);
  };
  const Image whole = arrive(-1), half = arrive(-1.5), rest = arrive(0);
  EXPECT_GT(difference(whole, half), 150);
  EXPECT_LT(difference(whole, rest), 20);
}

TEST(Actor, it_is_not_among_what_bodies_meet) {
  Assets assets;
  const auto seen = Scene::build(pasture({walker()}), assets), met = Scene::build(pasture({walker()}), assets, Scene::Content::collisions);
  EXPECT_FALSE(seen->drawables.empty());
  EXPECT_TRUE(met->drawables.empty());
  EXPECT_EQ(met->links.size(), seen->links.size());
}

TEST(Actor, one_whose_skin_or_animation_is_missing_is_seen_all_the_same) {
  ActorDef actor = walker();
  actor.animations[0].path = "/nowhere/walk.dae";
  actor.trajectories = {{0, "stand", 0, {{0, put(0, 0, 0)}, {100, put(0, 0, 0)}}}};
  Pasture still(pasture({actor}));
  EXPECT_LT(difference(still.picture(0), still.picture(0.3)), 1);
  EXPECT_GT(difference(still.picture(0), Pasture(pasture({})).picture(0)), 1000);
  actor.skin = "/nowhere/cow.dae";
  const Image box = Pasture(pasture({actor})).picture(0);
  int magenta = 0;
  for (std::size_t i = 0; i < box.rgba.size(); i += 4)
    magenta += box.rgba[i] > 200 && box.rgba[i + 1] < 60 && box.rgba[i + 2] > 200 ? 1 : 0;
  EXPECT_GT(magenta, 50);
}

}  // namespace
}  // namespace sim
