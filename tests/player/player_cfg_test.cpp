// Configuration files of Player as people have them: which device of which model each port gets.
#include "player_cfg.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

namespace gateway::configurations {
namespace {

using enum shm::IfaceType;

const std::vector<ListedIface> world{
    {position2d, "r0::position2d", "r0"}, {laser, "r0::laser", "r0"},        {laser, "r0::rear", "r0"},        {sonar, "r0::sonar", "r0"},
    {camera, "r0::camera", "r0"},         {camera, "r0::eyes::right", "r0"}, {camera, "r0::eyes::left", "r0"}, {truth, "r0", "r0"},
    {position2d, "r1::position2d", "r1"}, {laser, "r1::laser", "r1"},        {battery, "r1::battery", "r1"}};

class PlayerConfig : public testing::Test {
 protected:
  PlayerConfig() { std::filesystem::create_directories(folder); }
  ~PlayerConfig() override { std::filesystem::remove_all(folder); }

  void write(const std::string& name, const std::string& text) const { std::ofstream(folder / name) << text; }
  std::string served(const std::string& text) {
    write("robots.cfg", text);
    notes.clear();
    missing.clear();
    const auto ports = read_player_config((folder / "robots.cfg").string(), notes);
    if (!ports) return ports.error().message.substr(folder.string().size() + 1);
    std::string shown;
    for (const auto& plan : plan_by_config(*ports, world, missing)) {
      shown += std::to_string(plan.port) + ":";
      for (const auto& device : plan.devices) {
        if (device.address.interface == player::Interface::simulation) continue;
        shown += " " + player::to_text(device.address) + "=" + device.iface + (device.companion.empty() ? "" : "+" + device.companion);
      }
      shown += "\n";
    }
    return shown;
  }

  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / ("player_cfg_" + std::to_string(getpid()));
  std::vector<std::string> notes, missing;
};

TEST_F(PlayerConfig, of_stage_names_models) {
  EXPECT_EQ(served(R"(
# a robot of Stage
driver
(
  name "stage"
  provides ["simulation:0" ]
  plugin "stageplugin"
  worldfile "simple.world"
)
driver
(
  name "stage"
  provides ["position2d:0" "laser:0" "laser:1" "ranger:0" "ranger:2"]
  model "r0"
)
driver ( name "stage" provides ["6666:position2d:0" "6666:laser:0" "6666:power:0"] model "r1" alwayson 1 )
)"),
            "6665: position2d:0=r0::position2d laser:0=r0::laser laser:1=r0::rear ranger:0=r0::laser ranger:2=r0::rear\n"
            "6666: position2d:0=r1::position2d laser:0=r1::laser power:0=r1::battery\n");
  EXPECT_EQ(notes, std::vector<std::string>());
  EXPECT_EQ(missing, std::vector<std::string>());
}

TEST_F(PlayerConfig, what_shows_the_world_and_what_shows_two_things) {
  EXPECT_EQ(served(R"(
driver ( name "mapfile" provides ["map:0"] filename "cave.png" resolution 0.05 )
driver ( name "stage" provides ["planner:0" "graphics2d:0" "stereo:0" "stereo:1"] model "r0" )
)"),
            "6665: map:0=world planner:0=r0::position2d+r0 graphics2d:0=r0::position2d stereo:0=r0::eyes::left+r0::eyes::right\n");
  EXPECT_EQ(notes.size(), 1U);
  EXPECT_NE(notes.at(0).find("map:0 is the map of the simulated world, not \"cave.png\""), std::string::npos) << notes.at(0);
  EXPECT_EQ(missing, std::vector<std::string>{"stereo:1 of port 6665: no such device of model \"r0\""});
  EXPECT_NE(served("driver ( name \"mapfile\" provides [\"map:0\"] )\ndriver ( name \"mapfile\" provides [\"map:0\"] )")
                .find("map:0 of port 6665 appears twice"),
            std::string::npos);
}

TEST_F(PlayerConfig, of_gazebo_names_ifaces_or_models) {
  EXPECT_EQ(served(R"(
driver ( name "gazebo" provides ["simulation:0"] plugin "libgazeboplugin" server_id "default" )
driver ( name "gazebo" provides ["position2d:0"] gz_id "r0::position2d" )
driver ( name "gazebo" provides ["laser:0"] gz_id "r0::rear::laser_iface_0" )
driver ( name "gz_camera" provides ["camera:0"] gz_id "r0" )
)"),
            "6665: position2d:0=r0::position2d laser:0=r0::rear camera:0=r0::camera\n");
}

TEST_F(PlayerConfig, may_include_and_define) {
  write("common.inc", "define robot driver ( name \"stage\" provides [\"position2d:0\"] model \"r1\" )\nunit_angle \"degrees\"\n");
  EXPECT_EQ(served("include \"common.inc\"\nrobot ( model \"r0\" )\nrobot ( provides [\"7000:position2d:1\"] )\n"),
            "6665: position2d:0=r0::position2d\n7000: position2d:1=r1::position2d\n");
}

TEST_F(PlayerConfig, says_what_is_not_served) {
  EXPECT_EQ(served(R"(driver ( name "stage" provides ["position2d:0" "speech:0" "gps:0"] model "r0" )
driver ( name "vfh" provides ["position2d:1"] requires ["position2d:0" "laser:0"] safety_dist 0.1 )
)"),
            "6665: position2d:0=r0::position2d\n");
  ASSERT_EQ(notes.size(), 2U);
  EXPECT_TRUE(notes[0].ends_with("robots.cfg:1: interface speech is not served")) << notes[0];
  EXPECT_TRUE(notes[1].ends_with("robots.cfg:2: driver \"vfh\" is not started here; not served: position2d:1")) << notes[1];
  EXPECT_EQ(missing, std::vector<std::string>{"gps:0 of port 6665: no such device of model \"r0\""});
}

TEST_F(PlayerConfig, errors_name_the_line) {
  EXPECT_EQ(served("driver ( name \"stage\" provides [\"laser\"] model \"r0\" )"),
            "robots.cfg:1: expected an address as in laser:0 or 6665:laser:0, got \"laser\"");
  EXPECT_EQ(served("\ndriver ( name \"stage\" provides [\"lazer:0\"] model \"r0\" )"), "robots.cfg:2: \"lazer\" is no interface of Player");
  EXPECT_EQ(served("driver (\n name \"stage"), "robots.cfg:2: a text has no closing quote");
  EXPECT_EQ(served("driver (\n name \"stage\""), "robots.cfg:1: a bracket ( is not closed");
  EXPECT_EQ(served("driver ( name )"), "robots.cfg:1: key \"name\" has no value");
  EXPECT_EQ(served("driver ( provides [\"laser:0\" )"), "robots.cfg:1: a list [ is not closed");
  EXPECT_EQ(served("driver ( name \"stage\" provides [\"laser:0\"] )"), "robots.cfg:1: laser:0: the driver has no model (or gz_id)");
  EXPECT_EQ(served("driver ( model \"r0\" provides [\"laser:0\" \"laser:0\"] )"), "robots.cfg:1: laser:0 of port 6665 appears twice");
  EXPECT_EQ(served("driver ( name \"amcl\" provides [\"localize:0\"] )"),
            "robots.cfg: no driver provides a device of a simulator (name \"stage\" or \"gazebo\", model or gz_id)");
  EXPECT_EQ(served("include \"robots.cfg\"\n"), "robots.cfg:1: include: files include each other");
  EXPECT_EQ(served("include \"nowhere.cfg\"\n"), "nowhere.cfg: can't be read");
}

TEST_F(PlayerConfig, is_recognised) {
  for (const char* text : {"driver\n(\n", "# x\ndriver(name \"stage\")", "include \"a.cfg\"\n", "define r driver ()"}) {
    write("a.cfg", text);
    EXPECT_TRUE(is_of_player((folder / "a.cfg").string())) << text;
  }
  write("a.yaml", "ports:\n- port: 1\n");
  EXPECT_FALSE(is_of_player((folder / "a.yaml").string()));
}

}  // namespace
}  // namespace gateway::configurations
