// Files that are no SDFormat worlds but mean one: pictures of walls, models without a world, worlds of Stage.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/world_files.h"
#include "world/floor_plan.h"
#include "world/foreign_file.h"

namespace sim {
namespace {

using testing::HasSubstr;

// '#': a wall. A grey map as robots write it.
std::string picture_of(const std::vector<std::string>& rows) {
  std::string text = "P5\n# by a test\n" + std::to_string(rows[0].size()) + " " + std::to_string(rows.size()) + "\n255\n";
  for (const auto& row : rows)
    for (const char c : row) text += c == '#' ? '\0' : '\xff';
  return text;
}

TEST(FloorPlan, dark_pixels_become_as_few_boxes_as_rows_allow) {
  const std::vector<std::string> rows{"#####", "#...#", "#...#", "###.#"};
  std::vector<bool> dark;
  for (const auto& row : rows)
    for (const char c : row) dark.push_back(c == '#');
  const std::vector<PixelBox> expected{{0, 0, 5, 1}, {0, 1, 1, 3}, {4, 1, 1, 3}, {1, 3, 2, 1}};
  EXPECT_EQ(boxes_of(dark, 5, 4), expected);
  EXPECT_TRUE(boxes_of({false, false}, 2, 1).empty());
}

TEST(FloorPlan, an_included_picture_is_a_model_of_walls) {
  const WorldFiles files;
  files.write("plan.pgm", picture_of({"####", "#..#", "#..."}));
  const LoadResult result = files.load(
      "<include><uri>plan.pgm</uri><name>house</name><pose>10 0 0 0 0 0</pose><resolution>0.5</resolution><height>2</height></include>");
  ASSERT_EQ(result.world.models.size(), 1U) << all_findings(result);
  EXPECT_TRUE(result.findings.empty()) << all_findings(result);
  const ModelDef& house = result.world.models[0];
  EXPECT_EQ(house.name, "house");
  EXPECT_TRUE(house.is_static);
  ASSERT_EQ(house.links.size(), 1U);
  ASSERT_EQ(house.links[0].collisions.size(), 3U);
  EXPECT_EQ(house.links[0].visuals.size(), 3U);
  const Eigen::AlignedBox3d box = box_of(house, house.pose);
  EXPECT_TRUE(box.min().isApprox(Eigen::Vector3d(9, -0.75, 0))) << box.min().transpose();
  EXPECT_TRUE(box.max().isApprox(Eigen::Vector3d(11, 0.75, 2))) << box.max().transpose();
  // The upper row of the picture is the north wall.
  const auto& north = house.links[0].collisions[0];
  EXPECT_TRUE(north.pose.translation().isApprox(Eigen::Vector3d(0, 0.5, 1))) << north.pose.translation().transpose();
  EXPECT_TRUE(std::get<BoxShape>(north.geometry).size.isApprox(Eigen::Vector3d(2, 0.5, 2)));
}

TEST(FloorPlan, the_size_of_the_whole_picture_will_do_and_an_included_model_can_have_one) {
  const WorldFiles files;
  files.write("plan.pgm", picture_of({"##", ".#"}));
  files.write_model("hall", "<model name='hall'><static>true</static><include><uri>../plan.pgm</uri><size>8 4 3</size></include></model>");
  const LoadResult result = files.load("<include><uri>model://hall</uri></include>");
  ASSERT_EQ(result.world.models.size(), 1U) << all_findings(result);
  const Eigen::AlignedBox3d box = box_of(result.world.models[0], Eigen::Isometry3d::Identity());
  EXPECT_TRUE(box.sizes().isApprox(Eigen::Vector3d(8, 4, 1))) << box.sizes().transpose();
}

TEST(FloorPlan, what_cannot_be_used_is_named_and_left_out) {
  const WorldFiles files;
  files.write("plan.pgm", picture_of({"##", ".#"}));
  files.write("white.pgm", picture_of({"..", ".."}));
  files.write("cut.pgm", picture_of({"##", ".#"}).substr(0, 25));
  const auto include = [](const std::string& file, const std::string& more) {
    return "<include><uri>" + file + "</uri>" + more + "</include>";
  };
  const LoadResult result = files.load(
      include("plan.pgm", "") + include("plan.pgm", "<resolution>-1</resolution>") +
      include("plan.pgm", "<resolution>1</resolution><height>tall</height>") + include("white.pgm", "<resolution>1</resolution>") +
      include("cut.pgm", "<resolution>1</resolution>") + include("gone.png", "<resolution>1</resolution>"));
  EXPECT_TRUE(result.world.models.empty());
  ASSERT_EQ(result.findings.size(), 6U) << all_findings(result);
  EXPECT_EQ(result.world.missing_parts, 6U);
  const std::vector<std::string> expected{
      "floor plan \"plan.pgm\" is left out: <resolution> (size of a pixel) or <size> (x y of the picture) is expected, in metres",
      "<resolution> of floor plan \"plan.pgm\" must be a positive number, got \"-1\"",
      "<height> of floor plan \"plan.pgm\" must be a positive number, got \"tall\"",
      "floor plan \"white.pgm\" has no dark pixel and is left out",
      "cut off",
      "floor plan \"gone.png\" is not found and is left out"};
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_THAT(result.findings[i].text(), HasSubstr(expected[i]));
}

TEST(ForeignFile, worlds_of_stage_and_files_of_player_are_told_what_to_do) {
  const WorldFiles files;
  const auto message = [&](const std::string& text) {
    const auto result = files.load_text(text);
    return result ? std::string("loaded") : result.error().message;
  };
  const std::string stage = "w.sdf: is a world of Stage; SDFormat is expected. docs/stage.md shows how to write such a world in SDFormat";
  EXPECT_EQ(message("# a world\ninclude \"pioneer.inc\"\nwindow( size [ 635 666 ] )\n"), stage);
  EXPECT_EQ(message("define block model\n(\n  size [0.5 0.5 0.5]\n)\n"), stage);
  EXPECT_EQ(message("interval_sim 100\nfloorplan\n(\n  bitmap \"cave.png\"\n)\n"), stage);
  EXPECT_THAT(message("driver\n(\n  name \"stage\"\n  plugin \"stageplugin\"\n)\n"), HasSubstr("is a configuration file of Player"));
  EXPECT_THAT(message("hello\n"), testing::Not(HasSubstr("Stage")));
  EXPECT_FALSE(foreign_file("<sdf><!-- window( --></sdf>"));
  EXPECT_FALSE(foreign_file(""));
}

// Robots on a terrain that could not be read fell for ever.
TEST(FlatGround, stands_for_height_maps_that_cannot_be_read) {
  const WorldFiles files;
  files.write("dem.tif", "II*");
  const auto ground = [](const std::string& file) {
    return "<model name='m'><static>true</static><link name='l'><collision name='c'><geometry><heightmap><uri>" + file +
           "</uri><size>20 10 3</size><pos>1 2 -4</pos></heightmap></geometry></collision></link></model>";
  };
  for (const std::string file : {"dem.tif", "gone.png"}) {
    const LoadResult result = files.load(ground(file));
    ASSERT_EQ(result.world.models.size(), 1U) << all_findings(result);
    ASSERT_EQ(result.findings.size(), 1U) << all_findings(result);
    EXPECT_THAT(result.findings[0].text(), testing::AllOf(HasSubstr(file), HasSubstr("a flat ground is taken")));
    ASSERT_EQ(result.world.models[0].links[0].collisions.size(), 1U);
    const CollisionDef& collision = result.world.models[0].links[0].collisions[0];
    ASSERT_TRUE(std::holds_alternative<PlaneShape>(collision.geometry)) << file;
    EXPECT_EQ(std::get<PlaneShape>(collision.geometry).size, Eigen::Vector2d(20, 10));
    EXPECT_EQ(collision.pose.translation(), Eigen::Vector3d(1, 2, -4));
  }
}

TEST(ModelAlone, a_file_that_holds_a_model_is_opened_on_a_floor) {
  const WorldFiles files;
  const auto result = files.load_text(
      "<sdf version='1.9'><model name='ball'><pose>1 0 0.2 0 0 0</pose><link name='l'><collision name='c'><geometry><sphere>"
      "<radius>0.5</radius></sphere></geometry></collision></link></model></sdf>");
  ASSERT_TRUE(result.ok()) << result.error().message;
  EXPECT_TRUE(result->findings.empty()) << all_findings(*result);
  ASSERT_EQ(result->world.models.size(), 2U);
  EXPECT_EQ(result->world.name, "ball");
  EXPECT_EQ(result->world.lights.size(), 1U);
  const ModelDef& ball = *result->world.model("ball");
  EXPECT_TRUE(ball.pose.translation().isApprox(Eigen::Vector3d(1, 0, 0.5))) << ball.pose.translation().transpose();
  EXPECT_TRUE(result->world.model("floor")->is_static);
}

TEST(ModelAlone, a_urdf_robot_too_and_what_is_above_the_floor_stays_there) {
  const WorldFiles files;
  const auto result = files.load_text(
      "<robot name='r'><link name='base'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial>"
      "<collision><origin xyz='0 0 2'/><geometry><box size='1 1 1'/></geometry></collision></link></robot>");
  ASSERT_TRUE(result.ok()) << result.error().message;
  ASSERT_NE(result->world.model("r"), nullptr);
  EXPECT_NEAR(result->world.model("r")->pose.translation().z(), 0, 1e-12);
  EXPECT_THAT(files.load_text("<sdf version='1.9'><light name='l' type='point'/></sdf>").error().message,
              HasSubstr("a <world> or a <model> is expected in it"));
}

}  // namespace
}  // namespace sim
