#include "campaign/rows/rows.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>

#include "base/content_hash.h"
#include "base/random.h"
#include "campaign/results/statistics.h"
#include "campaign/rows/samples.h"
#include "support/paths.h"

namespace campaign {
namespace {

namespace fs = std::filesystem;

// Each of `pieces` equal parts of each coordinate has as many points as every other.
void expect_even(const std::vector<std::vector<double>>& points, std::size_t pieces) {
  for (std::size_t d = 0; d < points.front().size(); ++d) {
    std::vector<std::size_t> counts(pieces);
    for (const auto& point : points) ++counts[static_cast<std::size_t>(point[d] * static_cast<double>(pieces))];
    EXPECT_EQ(counts, std::vector<std::size_t>(pieces, points.size() / pieces)) << "dimension " << d;
  }
}

TEST(Samples, of_a_latin_hypercube_are_one_in_each_piece) { expect_even(*unit_samples(Plan::Sampling::latin, 50, 4, 7), 50); }

TEST(Samples, of_sobol_are_even_in_every_dimension) {
  expect_even(*unit_samples(Plan::Sampling::sobol, 256, max_sobol_dimensions, 3), 256);
  EXPECT_FALSE(unit_samples(Plan::Sampling::sobol, 4, max_sobol_dimensions + 1, 3));
}

TEST(Samples, are_the_same_for_the_same_seed_only) {
  for (const auto how : {Plan::Sampling::random, Plan::Sampling::latin, Plan::Sampling::sobol}) {
    EXPECT_EQ(*unit_samples(how, 8, 3, 1), *unit_samples(how, 8, 3, 1));
    EXPECT_NE(*unit_samples(how, 8, 3, 1), *unit_samples(how, 8, 3, 2));
  }
}

TEST(Samples, fill_their_range) {
  EXPECT_DOUBLE_EQ(in_range({Range::Kind::uniform, 2, 4}, 0.25), 2.5);
  EXPECT_DOUBLE_EQ(in_range({Range::Kind::log, 0.01, 100}, 0.5), 1);
  EXPECT_NEAR(in_range({Range::Kind::normal, 10, 2}, 0.975), 13.919927969, 1e-8);
}

TEST(PassRates, have_wilsons_interval) {
  const auto rate = wilson(8, 10);
  EXPECT_NEAR(rate.low, 0.4901625, 1e-6);
  EXPECT_NEAR(rate.high, 0.9433178, 1e-6);
  EXPECT_DOUBLE_EQ(wilson(10, 10).high, 1);
  EXPECT_DOUBLE_EQ(wilson(0, 10).low, 0);
}

TEST(ContentHashes, of_a_device_are_refused) {
  base::ContentHash hash;
  EXPECT_FALSE(hash.add_file("/dev/zero"));
}

TEST(ContentHashes, tell_pieces_apart) {
  const auto of = [](const std::vector<std::string>& pieces) {
    base::ContentHash hash;
    for (const auto& piece : pieces) hash.add(piece);
    return hash.text();
  };
  EXPECT_NE(of({"ab", "c"}), of({"a", "bc"}));
  EXPECT_NE(of({""}), of({}));
  EXPECT_EQ(of({"ab", "c"}), of({"ab", "c"}));
}

TEST(Footprints, have_distances) {
  const Polygon square = hull({{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0.5, 0.5}});
  EXPECT_EQ(square.size(), 4U);
  const Polygon other = hull({{3, 0}, {4, 0}, {4, 1}, {3, 1}});
  EXPECT_DOUBLE_EQ(distance(square, other), 2);
  EXPECT_DOUBLE_EQ(distance(square, hull({{0.4, 0.4}, {0.6, 0.4}, {0.5, 0.6}})), 0);
  EXPECT_DOUBLE_EQ(distance(square, hull({{2, 2}, {3, 2}, {3, 3}})), std::sqrt(2.0));
}

class Worlds : public testing::Test {
 protected:
  Worlds() : folder_(fs::path(testing::TempDir()) / ("rows_" + std::to_string(getpid()))) {}
  ~Worlds() override { fs::remove_all(folder_); }
  static WorldSurvey survey(const std::string& file, const std::vector<std::string>& resource_paths = {}) {
    auto survey = survey_world(file, resource_paths, {});
    EXPECT_TRUE(survey) << survey.error().message;
    return std::move(survey.value());
  }
  static std::string file() { return std::string(paths::source_dir) + "/worlds/obstacle_course.sdf"; }
  static std::map<std::string, SurveyedModel> models() { return survey(file()).models; }
  static WorldFile world() {
    static const auto here = survey(file());
    auto read = WorldFile::read(file(), here);
    return std::move(read.value());
  }
  static std::string refusal(const std::string& path, const std::string& value) {
    auto changed = world();
    const auto set = changed.set(path, value);
    return set ? "" : set.error().message;
  }
  fs::path folder_;
};

TEST_F(Worlds, are_changed_by_path_in_copies_of_their_files) {
  auto changed = world();
  for (const auto& [path, value] : {std::pair("model/pioneer2dx/pose/x", "1.5"),
                                    {"model/box_0/pose", "1 2 0.5"},
                                    {"model/pioneer2dx/mass", "18"},
                                    {"model/pioneer2dx/friction", "0.3"},
                                    {"model/pioneer2dx/sensor/laser/noise", "0.07"},
                                    {"model/pioneer2dx/sensor/laser/rate", "20"},
                                    {"world/step", "0.002"}}) {
    const auto set = changed.set(path, value);
    EXPECT_TRUE(set) << set.error().message;
  }
  const auto written = changed.write(folder_.string());
  ASSERT_TRUE(written) << written.error().message;
  const auto again = survey((folder_ / "world.sdf").string(), {changed.folder()});
  const auto& models = again.models;
  EXPECT_DOUBLE_EQ(models.at("pioneer2dx").pose.translation().x(), 1.5);
  EXPECT_DOUBLE_EQ(models.at("pioneer2dx").pose.translation().y(), -4.5);
  EXPECT_DOUBLE_EQ(models.at("box_0").pose.translation().y(), 2);
  EXPECT_EQ(models.size(), Worlds::models().size());
  std::string all;
  for (const auto& file : again.files) {
    std::ifstream in(file);
    all.append(std::istreambuf_iterator<char>(in), {});
  }
  for (const char* text :
       {"<stddev>0.07</stddev>", "<update_rate>20</update_rate>", "<mu>0.3</mu>", "<max_step_size>0.002</max_step_size>"})
    EXPECT_NE(all.find(text), std::string::npos) << text;
}

TEST_F(Worlds, have_lights_that_are_included) {
  auto changed = world();
  const auto set = changed.set("light/sun/intensity", "0.25");
  ASSERT_TRUE(set) << set.error().message;
  ASSERT_TRUE(changed.set("light/sun/direction", "0 0 -1"));
  ASSERT_TRUE(changed.write(folder_.string()));
  std::ifstream in(folder_ / "world.sdf");
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  EXPECT_NE(text.find("<intensity>0.25</intensity>"), std::string::npos);
  EXPECT_NE(text.find("<direction>0 0 -1</direction>"), std::string::npos);
  EXPECT_EQ(text.find("model://sun"), std::string::npos);
  EXPECT_EQ(refusal("light/moon/intensity", "1"), "light/moon/intensity: the world has no light \"moon\"; lights: sun");
  // What the light is belongs to what the world is made of.
  std::string files;
  for (const auto& file : survey(file()).files) files += file + " ";
  EXPECT_NE(files.find("sun/model.sdf"), std::string::npos) << files;
}

TEST_F(Worlds, have_no_other_values) {
  EXPECT_EQ(refusal("model/nobody/pose", "1 2 0").substr(0, 52), "model/nobody/pose: the world has no model \"nobody\"; ");
  EXPECT_EQ(refusal("model/pioneer2dx/sensor/nose/noise", "1"),
            "model/pioneer2dx/sensor/nose/noise: model pioneer2dx has no sensor \"nose\"");
  EXPECT_EQ(refusal("model/pioneer2dx/pose/x", "far"), "model/pioneer2dx/pose/x: must hold finite numbers, got \"far\"");
  EXPECT_EQ(refusal("model/pioneer2dx/colour", "1"),
            "model/pioneer2dx/colour: of a model pose, mass, friction and sensor/NAME/... can be set");
  EXPECT_EQ(refusal("world/step", "0"), "world/step: must be more than 0, got \"0\"");
}

TEST_F(Worlds, have_footprints_of_their_models) {
  const auto models = Worlds::models();
  const auto wall = footprint(models.at("wall_north").outline, models.at("wall_north").pose);
  const auto robot = footprint(models.at("pioneer2dx").outline, Eigen::Isometry3d(Eigen::Translation3d(0, 5, 0)));
  // The wall is 0.15 m thick at y = 6; the robot's wheels reach 0.165 + 0.0825 m to the side.
  EXPECT_NEAR(distance(robot, wall), 6 - 0.075 - 5 - 0.2475, 2e-3);
}

TEST_F(Worlds, are_placed_as_a_row_sets_them) {
  Row row;
  row.values = {{"model/box_0/pose", "1 2 0.5"}, {"model/box_1/pose", "1 2 3 0.1 0.2 0.3"}, {"model/box_2/pose/roll", "0.4"}};
  const auto before = models();
  const auto placed = placed_models(row, before);
  const auto expect_pose = [&](const char* name, const std::vector<double>& numbers) {
    EXPECT_TRUE(placed.at(name).pose.isApprox(to_pose(numbers), 1e-9)) << name;
  };
  expect_pose("box_0", {1, 2, before.at("box_0").pose.translation().z(), 0, 0, 0.5});
  expect_pose("box_1", {1, 2, 3, 0.1, 0.2, 0.3});
  const Eigen::Isometry3d old = before.at("box_2").pose;
  const double yaw = std::atan2(old.linear()(1, 0), old.linear()(0, 0));
  expect_pose("box_2", {old.translation().x(), old.translation().y(), old.translation().z(), 0.4, 0, yaw});
}

TEST_F(Worlds, that_do_not_load_say_what_the_simulator_says) {
  fs::create_directories(folder_);
  std::ofstream(folder_ / "robot.sdf") << "<sdf version='1.9'/>";
  const auto none = survey_world((folder_ / "robot.sdf").string(), {}, {});
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().message.find("a <world> or a <model> is expected in it"), std::string::npos) << none.error().message;
}

TEST_F(Worlds, make_rows_of_a_grid_of_samples_and_of_seeds) {
  Plan plan;
  plan.repeat = 2;
  plan.seed = 10;
  plan.samples = 3;
  plan.axes = {{"a", {"1", "2"}, {}}, {"b", {}, Range{Range::Kind::uniform, 0, 1}}, {"c", {"x", "y"}, {}}};
  const auto rows = RowMaker::make(plan, models());
  ASSERT_TRUE(rows);
  ASSERT_EQ(rows->count(), 24U);
  std::set<std::string> all;
  for (std::size_t i = 1; i <= rows->count(); ++i) {
    const auto row = rows->row(i);
    ASSERT_TRUE(row);
    EXPECT_TRUE(row->seed == 10 || row->seed == 11);
    std::string text = std::to_string(row->seed);
    for (const auto& [name, value] : row->values) text += " " + value;
    all.insert(text);
  }
  EXPECT_EQ(all.size(), 24U);
}

TEST_F(Worlds, scatter_models_without_touching) {
  Plan plan;
  plan.repeat = 20;
  plan.scatters.push_back({{"box_1", "box_2", "cylinder_3"}, {-3, -3, 3, 3}, 0.1, true});
  const auto standing = models();
  const auto rows = RowMaker::make(plan, standing);
  ASSERT_TRUE(rows);
  for (std::size_t i = 1; i <= rows->count(); ++i) {
    const auto row = rows->row(i);
    ASSERT_TRUE(row) << row.error().message;
    const auto models = placed_models(*row, standing);
    for (const char* name : {"box_1", "box_2", "cylinder_3"}) {
      const auto mine = footprint(models.at(name).outline, models.at(name).pose);
      for (const auto& [other, model] : models) {
        if (other == name) continue;
        EXPECT_GT(distance(mine, footprint(model.outline, model.pose)), 0.1) << name << " and " << other;
      }
    }
  }
  plan.scatters[0].region.x2 = plan.scatters[0].region.y2 = -2.9;
  EXPECT_FALSE(RowMaker::make(plan, models())->row(1));
}

}  // namespace
}  // namespace campaign
