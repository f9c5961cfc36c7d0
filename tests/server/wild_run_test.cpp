// Worlds in the manner of those that people have (tests/worlds), run for ten seconds with every device subscribed: nothing sinks, flies or
// leaves the numbers, and what is wrong in a file is one line that names it.
#include <gmock/gmock.h>
#include <spdlog/fmt/fmt.h>

#include <filesystem>
#include <map>
#include <tuple>

#include "base/text.h"
#include "shm/requests.h"
#include "support/paths.h"
#include "support/simulation_fixture.h"
#include "world/world_loader.h"

namespace sim {
namespace {

using namespace test;
using testing::HasSubstr;

namespace fs = std::filesystem;

const fs::path folder = fs::path(paths::source_dir) / "tests/worlds";

LoadResult load(const fs::path& file) {
  auto loaded = load_world(file, ModelPath({folder, fs::path(paths::source_dir) / "worlds"}));
  if (loaded) return std::move(*loaded);
  ADD_FAILURE() << loaded.error().message;
  return {};
}

class Wild : public ::testing::TestWithParam<fs::path> {};

TEST_P(Wild, runs_for_ten_seconds) {
  LoadResult loaded = load(GetParam());
  const bool has_ground = std::any_of(loaded.world.models.begin(), loaded.world.models.end(), [](const ModelDef& model) {
    return model.is_static && !model.links.empty() && !model.links[0].collisions.empty() &&
           std::holds_alternative<PlaneShape>(model.links[0].collisions[0].geometry);
  });
  SimulationFixture f(std::move(loaded.world));
  std::vector<shm::Iface> ifaces;
  for (const auto& device : f.simulation->devices()) {
    // Pictures cost too much for a test of motion; boxes are made from them, when the renderer has drawn one.
    const shm::IfaceType type = device->iface().type();
    if (!shm::has_frames(type) && type != shm::IfaceType::boxes) ifaces.push_back(f.open(device->iface().type(), device->iface().name()));
  }
  f.run(10);
  auto& physics = f.simulation->physics();
  EXPECT_THAT(physics.take_complaints(), testing::IsEmpty());
  for (ModelId id = 0; id < physics.model_slots(); ++id) {
    if (!physics.exists(id) || physics.is_static(id)) continue;
    const Eigen::Vector3d p = physics.model_pose(id).translation();
    EXPECT_TRUE(p.allFinite()) << physics.def(id).name;
    EXPECT_LT(p.head<2>().norm(), 60) << physics.def(id).name << " at " << p.transpose();
    EXPECT_LT(p.z(), 10) << physics.def(id).name << " at " << p.transpose();
    bool has_shape = false;
    for (const auto& link : physics.def(id).links) has_shape = has_shape || !link.collisions.empty();
    if (has_ground && has_shape) {
      EXPECT_GT(p.z(), -0.5) << physics.def(id).name << " at " << p.transpose();
    }
  }
  for (auto& iface : ifaces) EXPECT_GT(iface.sequence(), 0U) << iface.name() << " has published nothing";
}

std::vector<fs::path> worlds() {
  std::vector<fs::path> found;
  for (const fs::path& where : {folder, folder / "faulty"}) {
    for (const auto& entry : fs::directory_iterator(where)) {
      if (entry.is_regular_file()) found.push_back(entry.path());
    }
  }
  std::sort(found.begin(), found.end());
  return found;
}

INSTANTIATE_TEST_SUITE_P(Worlds, Wild, ::testing::ValuesIn(worlds()), [](const auto& world) {
  std::string name = world.param.filename().string();
  for (char& c : name) c = c == '.' ? '_' : c;
  return name;
});

std::vector<std::string> lines_of(const std::string& file) {
  std::vector<std::string> lines;
  for (const Finding& finding : load(folder / file).findings) {
    std::string text = finding.text();
    if (const auto at = text.find("tests/worlds/"); at != std::string::npos) text.erase(0, at + 13);
    lines.push_back(text);
  }
  return lines;
}

TEST(FaultyWorlds, name_each_wrong_thing_in_one_line_with_its_place) {
  EXPECT_THAT(lines_of("faulty/signs.world"),
              testing::UnorderedElementsAre(
                  "faulty/signs.world:4: material script \"model://nowhere/scripts\" is not found",
                  HasSubstr("signs.world:4: material \"My/Sign\" is not known"),
                  HasSubstr("signs.world:5: mesh file \"model://nowhere/meshes/sign.dae\" of collision \"c\""),
                  HasSubstr("signs.world:6: model \"model://nowhere\" is not found"),
                  HasSubstr("signs.world:7: model \"https://fuel.gazebosim.org/1.0/OpenRobotics/models/Depot\" is not found"),
                  HasSubstr("signs.world:8: model \"__default__\" is not found"),
                  HasSubstr("signs.world:9: model \"model://nowhere\" is not found"),
                  HasSubstr("signs.world:9: <inertial> of link \"l\" of model \"half\" has a mass and no <inertia>"),
                  HasSubstr("signs.world:10: model \"model://nowhere\" is not found"), HasSubstr("signs.world:11: unknown element <torus>"),
                  HasSubstr("signs.world:11: shapes from images are not simulated"),
                  HasSubstr("signs.world:11: collision \"d\" of link \"l\" of model \"odd\" has no shape"),
                  testing::AllOf(HasSubstr("signs.world:12: height map"), HasSubstr("a flat ground is taken"))));
  EXPECT_THAT(
      lines_of("faulty/exotic.sdf"),
      testing::UnorderedElementsAre(HasSubstr("exotic.sdf:8: sensors of type \"custom\""), HasSubstr("exotic.sdf:9: projector \"p\""),
                                    HasSubstr("exotic.sdf:11: joint \"between_models\" joins models")));
}

TEST(FaultyWorlds, a_broken_mesh_is_one_line_of_the_simulator) {
  SimulationFixture f(load(folder / "faulty/signs.world").world);
  EXPECT_THAT(f.dropped, testing::ElementsAre(HasSubstr("broken.dae")));
}

TEST(JunkWorld, is_mended_as_it_was_meant) {
  const LoadResult result = load(folder / "junk.world");
  EXPECT_FALSE(result.dropped);
  EXPECT_EQ(result.world.name, "junk");
  for (const char* name : {"ground_plane", "no_inertia", "Tom & Jerry", "empty_pose", "entities", "Model", "degrees", "capital"}) {
    EXPECT_NE(result.world.model(name), nullptr) << name;
  }
  EXPECT_EQ(result.world.model("no_inertia")->pose.translation().z(), 0.5);
  EXPECT_EQ(result.world.model("Model")->joints.size(), 1U);
  EXPECT_EQ(result.world.lights.size(), 2U);
}

// --- what the tutorials of other simulators have

TEST(Populations, stand_where_their_distributions_say) {
  const WorldDef world = load(folder / "orchard.world").world;
  const auto all = [&](const std::string& start) {
    std::vector<Eigen::Vector3d> places;
    for (const ModelDef& model : world.models) {
      if (model.name.starts_with(start)) places.push_back(model.pose.translation());
    }
    return places;
  };
  const auto cans = all("can1_");
  ASSERT_EQ(cans.size(), 10U);
  for (const auto& p : cans) EXPECT_TRUE(std::abs(p.x()) <= 1 && std::abs(p.y()) <= 1 && std::abs(p.z()) <= 0.005) << p.transpose();
  const auto apples = all("apple_");
  ASSERT_EQ(apples.size(), 10U);
  for (const auto& p : apples) EXPECT_LE((p - Eigen::Vector3d(5, 0, 0.1)).head<2>().norm(), 1);
  EXPECT_EQ(all("post_").size(), 9U);
  const auto trunks = all("trunk_");
  ASSERT_EQ(trunks.size(), 12U);
  EXPECT_TRUE(trunks.front().isApprox(Eigen::Vector3d(-6, -0.75, 1), 1e-9));
  EXPECT_TRUE(trunks.back().isApprox(Eigen::Vector3d(-4, 0.75, 1), 1e-9));
  const auto row = all("x_");
  ASSERT_EQ(row.size(), 5U);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_TRUE(row[i].isApprox(Eigen::Vector3d(-1.6 + 0.8 * static_cast<double>(i), -5, 0.1), 1e-9));
  const auto pile = all("z_");
  ASSERT_EQ(pile.size(), 4U);
  EXPECT_TRUE(pile[3].isApprox(Eigen::Vector3d(-5, -5, 1.75), 1e-9));
  // The same in every run.
  const WorldDef again = load(folder / "orchard.world").world;
  for (std::size_t i = 0; i < world.models.size(); ++i) EXPECT_TRUE(world.models[i].pose.isApprox(again.models[i].pose, 0));
}

TEST(AutomaticInertia, is_that_of_the_solids) {
  const WorldDef world = load(folder / "harmonic.sdf").world;
  const auto link = [&](const char* model) { return world.model(model)->links.at(0); };
  EXPECT_NEAR(link("box").mass, 500, 1e-9);
  EXPECT_TRUE(link("box").inertia.isApprox(500.0 / 6 * Eigen::Matrix3d::Identity(), 1e-9));
  const double can = std::numbers::pi * 0.25 * 1000;
  EXPECT_NEAR(link("cylinder").mass, can, 1e-9);
  EXPECT_NEAR(link("cylinder").inertia(2, 2), can * 0.125, 1e-9);
  EXPECT_NEAR(link("cylinder").inertia(0, 0), can * (3 * 0.25 + 1) / 12, 1e-9);
  const double ball = 4.0 / 3 * std::numbers::pi * 0.125 * 1000;
  EXPECT_NEAR(link("sphere").mass, ball, 1e-9);
  EXPECT_NEAR(link("sphere").inertia(1, 1), 0.4 * ball * 0.25, 1e-9);
}

TEST(Roads, are_strips_that_can_be_seen_and_not_bumped_into) {
  const WorldDef world = load(folder / "town.world").world;
  const ModelDef* road = world.model("main_street");
  ASSERT_NE(road, nullptr);
  EXPECT_TRUE(road->is_static);
  EXPECT_EQ(road->links.at(0).visuals.size(), 7U) << "four corners and three strips";
  EXPECT_TRUE(road->links.at(0).collisions.empty());
}

TEST(Drives, of_all_spellings_turn_their_wheels) {
  SimulationFixture f(load(folder / "drives.world").world);
  std::vector<std::pair<std::string, shm::Iface>> drives;
  for (const auto& device : f.simulation->devices()) {
    if (device->iface().type() != shm::IfaceType::position2d) continue;
    drives.emplace_back(device->iface().name(), f.open(shm::IfaceType::position2d, device->iface().name()));
    ASSERT_TRUE(drives.back().second.command_velocity(0.2, 0, 0));
  }
  EXPECT_EQ(drives.size(), 13U);
  ASSERT_EQ(f.dropped.size(), 1U);
  EXPECT_NE(f.dropped[0].find("needs one driven wheel and its steering"), std::string::npos) << f.dropped[0] << ", the tricycle names none";
  f.run(3);
  for (auto& [name, drive] : drives) {
    ASSERT_TRUE(drive.read()) << name;
    const auto& sample = drive.sample<shm::Position2dSample>();
    EXPECT_NEAR(sample.odometry[0], 0.6, 0.11) << name << ", some speed up slowly";
    EXPECT_NEAR(sample.true_velocity[0], 0.2, 0.01) << name;
  }
}

// Wheels that are dragged sideways need more torque than 5 N m; neither gz-sim nor Gazebo classic's own skid drive has a limit, whatever
// an element that the latter does not read says.
//
// How fast Coulomb lets such a robot turn: wheels at (+-a, +-b) whose rims run at V = b * asked slip along by s = V - b * w and across by
// a * w when the robot turns with w. Every wheel is pulled against its slip with mu * N, so that the torque is gone when b * s = a * (a *
// w): w = asked * b^2 / (a^2 + b^2), whatever mu and N are. Here 0.576 of what is asked; rims 0.1 m wide make it a little less, and in the
// beginning the robot must get going, with mu * g / sqrt(a^2 + b^2).
TEST(Drives, turn_a_heavy_robot_on_four_wheels_as_fast_as_their_slip_lets_them) {
  std::string joints, links;
  for (const auto& [name, x, y] : {std::tuple{"lf", 0.3, 0.35}, {"lr", -0.3, 0.35}, {"rf", 0.3, -0.35}, {"rr", -0.3, -0.35}}) {
    links += fmt::format(
        "<link name='{0}'><pose>{1} {2} 0.15 -1.5708 0 0</pose><inertial><mass>2</mass><inertia><ixx>0.02</ixx><iyy>0.02</iyy><izz>0.02"
        "</izz></inertia></inertial><collision name='c'><geometry><cylinder><radius>0.15</radius><length>0.1</length></cylinder>"
        "</geometry></collision></link><joint name='{0}_joint' type='revolute'><parent>base</parent><child>{0}</child><axis>"
        "<xyz>0 0 1</xyz></axis></joint>",
        name, x, y);
  }
  const auto robot = [&](const std::string& plugin) {
    return "<model name='" + plugin + "'><pose>0 " + (plugin == "gz" ? "0" : "5") +
           " 0 0 0 0</pose><link name='base'><pose>0 0 0.2 0 0 0</pose><inertial><mass>30</mass><inertia><ixx>1</ixx><iyy>1</iyy>"
           "<izz>1</izz></inertia></inertial></link>" +
           links + "<plugin name='drive' filename='" + (plugin == "gz" ? "gz-sim-diff-drive-system" : "libSkidSteerDrivePlugin.so") +
           "'><left_joint>lf_joint</left_joint><left_joint>lr_joint</left_joint><right_joint>rf_joint</right_joint>"
           "<right_joint>rr_joint</right_joint>" +
           (plugin == "gz" ? "" : "<MaxForce>5</MaxForce>") + "</plugin></model>";
  };
  auto loaded = load_world_text(
      "<sdf version='1.9'><world name='w'><model name='ground'><static>true</static><link name='l'><collision name='c'><geometry><plane/>"
      "</geometry></collision></link></model>" +
          robot("gz") + robot("classic") + "</world></sdf>",
      folder, "w.sdf", ModelPath{});
  ASSERT_TRUE(loaded.ok()) << loaded.error().message;
  SimulationFixture f(std::move(loaded->world));
  for (const char* name : {"gz::drive", "classic::drive"}) {
    auto drive = f.open(shm::IfaceType::position2d, name);
    ASSERT_TRUE(drive.command_velocity(0, 0, 0.5));
    f.run(2);
    ASSERT_TRUE(drive.read());
    const auto& sample = drive.sample<shm::Position2dSample>();
    const double rate = 0.5 * 0.35 * 0.35 / (0.3 * 0.3 + 0.35 * 0.35);
    EXPECT_NEAR(shm::yaw_of(sample.true_pose), 2 * rate, 0.03 * 2 * rate) << name;
    EXPECT_NEAR(sample.true_velocity[2], rate, 0.03 * rate) << name;
    EXPECT_NEAR(sample.odometry[2], 1, 0.02) << name << ": the encoders know nothing of slip";
  }
}

TEST(Drives, that_are_not_simulated_are_one_line) {
  auto loaded = load_world_text(
      "<sdf version='1.9'><world name='w'><model name='cart'><link name='l'/><plugin name='drive' "
      "filename='libCartDemoPlugin.so'/></model></world></sdf>",
      folder, "w.sdf", ModelPath{});
  ASSERT_TRUE(loaded.ok()) << loaded.error().message;
  ASSERT_EQ(loaded->findings.size(), 1U);
  EXPECT_NE(loaded->findings[0].text().find("is not simulated"), std::string::npos) << loaded->findings[0].text();
}

}  // namespace
}  // namespace sim
