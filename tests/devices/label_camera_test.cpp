// Cameras that show labels, boxes and temperatures, against boxes whose place in the image is easy to calculate. The camera stands in the
// origin and looks along x with a view of 90 degrees: f = half its width.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <map>

#include "render/image.h"
#include "support/physics_fixture.h"
#include "support/simulation_fixture.h"
#include "world/world_loader.h"

namespace sim {
namespace {

using namespace test;

constexpr int width = 100, height = 80;

std::string camera(const std::string& type, const std::string& more = "", const std::string& plugin = "") {
  return "<gravity>0 8 0</gravity><model name='robot'><static>true</static><link name='l'><sensor name='eye' type='" + type +
         "'><update_rate>10</update_rate><camera><horizontal_fov>1.57079632679</horizontal_fov><image><width>100</width><height>80</"
         "height>" +
         (more.find("<format>") == std::string::npos ? "" : more) + "</image>" + (more.find("<format>") == std::string::npos ? more : "") +
         "<clip><near>0.1</near><far>50</far></clip></camera>" + plugin + "</sensor></link></model>";
}

std::string label(int number) {
  return "<plugin filename='gz-sim-label-system' name='gz::sim::systems::Label'><label>" + std::to_string(number) + "</label></plugin>";
}

// A cube of 1 m whose front is at x.
std::string cube(const std::string& name, double x, double y, const std::string& of_visual, const std::string& of_model) {
  return "<model name='" + name + "'><static>true</static><pose>" + std::to_string(x + 0.5) + " " + std::to_string(y) +
         " 0 0 0 0</pose><link name='l'><visual name='v'><geometry><box><size>1 1 1</size></box></geometry>" + of_visual +
         "</visual></link>" + of_model + "</model>";
}

struct Images : SimulationFixture {
  explicit Images(const std::string& world) : SimulationFixture(world_of_text(world)) { simulation->pictures().set_synchronous(true); }
  std::vector<std::uint8_t> image(const std::string& iface, double* unit = nullptr) {
    auto camera_iface = open(shm::IfaceType::camera, iface);
    run(0.1);
    const auto frame = camera_iface.hold();
    if (!frame) throw std::runtime_error("no frame of " + iface);
    if (unit != nullptr) *unit = frame->head().unit;
    const auto* data = reinterpret_cast<const std::uint8_t*>(frame->data().data());
    return {data, data + frame->data().size()};
  }
  std::vector<shm::Box> boxes() {
    auto iface = open(shm::IfaceType::boxes, "robot::eye");
    run(0.1);
    if (!iface.read()) throw std::runtime_error("no boxes");
    const auto* first = reinterpret_cast<const shm::Box*>(iface.sample_followers(0));
    return {first, first + iface.filled()};
  }
};

using Bytes = std::array<int, 3>;
Bytes at(const std::vector<std::uint8_t>& image, int x, int y) {
  const auto i = static_cast<std::size_t>(3 * (y * width + x));
  return {image[i], image[i + 1], image[i + 2]};
}

TEST(SegmentationCamera, shows_the_label_of_models_and_visuals_and_nothing_elsewhere) {
  Images f(camera("segmentation_camera") + cube("a", 2, 1.5, "", label(40)) + cube("b", 2, -1.5, label(255), "") + cube("c", 5, 0, "", ""));
  const auto image = f.image("robot::eye::labels_map");
  EXPECT_EQ(at(image, 20, 40), (Bytes{40, 40, 40}));
  EXPECT_EQ(at(image, 80, 40), (Bytes{255, 255, 255}));
  EXPECT_EQ(at(image, 50, 40), (Bytes{0, 0, 0}));
  EXPECT_EQ(at(image, 50, 5), (Bytes{0, 0, 0}));
}

// The near cube's front is 1 m wide at 2 m: 25 pixels about the middle.
TEST(SegmentationCamera, edges_are_sharp_and_where_they_belong) {
  Images f(camera("segmentation") + cube("near", 2, 0, "", label(9)));
  const auto image = f.image("robot::eye::labels_map");
  std::map<Bytes, int> counts;
  for (int x = 0; x < width; ++x) ++counts[at(image, x, 40)];
  EXPECT_EQ(counts, (std::map<Bytes, int>{{{0, 0, 0}, 75}, {{9, 9, 9}, 25}}));
  EXPECT_EQ(at(image, 36, 40), (Bytes{0, 0, 0}));
  EXPECT_EQ(at(image, 38, 40), (Bytes{9, 9, 9}));
  EXPECT_EQ(at(image, 61, 40), (Bytes{9, 9, 9}));
  EXPECT_EQ(at(image, 63, 40), (Bytes{0, 0, 0}));
}

TEST(SegmentationCamera, counts_the_objects_of_each_label) {
  Images f(camera("segmentation_camera", "<segmentation_type>panoptic</segmentation_type>") + cube("a", 2, 1.5, "", label(3)) +
           cube("b", 2, 0, "", label(8)) + cube("c", 2, -1.5, "", label(3)));
  const auto image = f.image("robot::eye::labels_map");
  EXPECT_EQ(at(image, 12, 40), (Bytes{0, 1, 3}));
  EXPECT_EQ(at(image, 50, 40), (Bytes{0, 1, 8}));
  EXPECT_EQ(at(image, 87, 40), (Bytes{0, 2, 3}));
}

TEST(SegmentationCamera, nested_models_have_the_label_of_the_nearest_model_around_them) {
  const auto part = [](const std::string& name, double y, const std::string& plugin) {
    return "<model name='" + name + "'><pose>2.5 " + std::to_string(y) +
           " 0 0 0 0</pose><link name='l'><visual name='v'><geometry><box><size>1 1 1</size></box></geometry></visual></link>" + plugin +
           "</model>";
  };
  Images f(camera("segmentation_camera") + "<model name='whole'><static>true</static>" + part("left", 1.5, "") +
           part("right", -1.5, label(2)) + label(1) + "</model>");
  const auto image = f.image("robot::eye::labels_map");
  EXPECT_EQ(at(image, 20, 40), (Bytes{1, 1, 1}));
  EXPECT_EQ(at(image, 80, 40), (Bytes{2, 2, 2}));
}

TEST(SegmentationCamera, the_coloured_map_has_one_colour_for_each_label_and_black_elsewhere) {
  Images f(camera("segmentation_camera") + cube("a", 2, 1.5, "", label(3)) + cube("b", 2, 0, "", label(8)) +
           cube("c", 2, -1.5, "", label(3)));
  const auto image = f.image("robot::eye::colored_map");
  EXPECT_EQ(at(image, 12, 40), at(image, 87, 40));
  EXPECT_NE(at(image, 12, 40), at(image, 50, 40));
  EXPECT_EQ(at(image, 50, 5), (Bytes{0, 0, 0}));
}

TEST(BoundingBoxCamera, a_visible_box_is_around_what_is_seen) {
  Images f(camera("boundingbox_camera") + cube("far", 4, 0, "", label(5)) +
           "<model name='screen'><static>true</static><pose>1 0.5 0 0 0 0</pose><link name='l'><visual name='v'><geometry><box>"
           "<size>0.01 1 5</size></box></geometry></visual></link></model>");
  const auto boxes = f.boxes();
  ASSERT_EQ(boxes.size(), 1U);
  EXPECT_EQ(boxes[0].label, 5U);
  EXPECT_STREQ(boxes[0].name, "far");
  // Its right half: from the middle to 0.5 m to the right at 4 m, which is 6.25 pixels; up and down as much.
  EXPECT_NEAR(boxes[0].center[0], 50 + 3.125, 0.6);
  EXPECT_NEAR(boxes[0].size[0], 6.25, 1);
  EXPECT_NEAR(boxes[0].center[1], 40, 0.6);
  EXPECT_NEAR(boxes[0].size[1], 12.5, 1);
  EXPECT_GT(boxes[0].pixels, 60U);
}

TEST(BoundingBoxCamera, a_full_box_is_around_all_of_an_object_of_which_something_is_seen) {
  Images f(camera("boundingbox_camera", "<box_type>full_2d</box_type>") + cube("far", 4, 0, "", label(5)) +
           cube("hidden", 6, 0.1, "", label(6)) +
           "<model name='screen'><static>true</static><pose>1 0.5 0 0 0 0</pose><link name='l'><visual name='v'><geometry><box>"
           "<size>0.01 1 5</size></box></geometry></visual></link></model>");
  const auto boxes = f.boxes();
  ASSERT_EQ(boxes.size(), 1U);
  EXPECT_NEAR(boxes[0].center[0], 50, 1e-3);
  EXPECT_NEAR(boxes[0].size[0], 12.5, 1e-3);
  EXPECT_NEAR(boxes[0].size[1], 12.5, 1e-3);
}

TEST(BoundingBoxCamera, a_full_box_ends_at_the_edge_of_the_image) {
  Images f(camera("boundingbox_camera", "<box_type>full_2d</box_type>") + cube("at_the_edge", 1, 1, "", label(5)));
  const auto boxes = f.boxes();
  ASSERT_EQ(boxes.size(), 1U);
  EXPECT_NEAR(boxes[0].center[0] - boxes[0].size[0] / 2, 0, 1e-3);
  EXPECT_NEAR(boxes[0].center[0] + boxes[0].size[0] / 2, 50 - 50 * 0.25, 1e-3);  // its far right edge: 0.5 m aside at 2 m
}

TEST(BoundingBoxCamera, an_oriented_box_turns_with_the_object) {
  Images f(camera("boundingbox_camera", "<box_type>3d</box_type>") +
           "<model name='beam'><static>true</static><pose>3 0.4 0.2 0 0 0.5</pose><link name='l'><visual name='v'><geometry><box>"
           "<size>1 0.2 0.4</size></box></geometry></visual></link>" +
           label(77) + "</model>");
  const auto boxes = f.boxes();
  ASSERT_EQ(boxes.size(), 1U);
  EXPECT_NEAR(boxes[0].pose.x, 3, 1e-6);
  EXPECT_NEAR(boxes[0].pose.y, 0.4, 1e-6);
  EXPECT_NEAR(boxes[0].pose.z, 0.2, 1e-6);
  EXPECT_NEAR(boxes[0].pose.qz, std::sin(0.25), 1e-6);
  EXPECT_NEAR(boxes[0].extent[0], 1, 1e-6);
  EXPECT_NEAR(boxes[0].extent[1], 0.2, 1e-6);
  EXPECT_NEAR(boxes[0].extent[2], 0.4, 1e-6);
}

// Something that is seen through, even behind the camera, takes a drawing of its own for what is seen where.
TEST(BoundingBoxCamera, one_drawing_and_two_give_the_same_boxes_and_the_same_image) {
  const std::string world = cube("near", 2, 0.4, "", label(5)) + cube("far", 4, -0.4, "", label(6)) + cube("other", 3, -2, "", "") +
                            cube("same", 5, 2, "", label(5));
  const auto bytes = [](const auto& frame) {
    const auto* data = reinterpret_cast<const std::uint8_t*>(frame->data().data());
    return std::vector<std::uint8_t>(data, data + frame->data().size());
  };
  const auto seen_in = [&](const std::string& content) {
    Images f(camera("boundingbox_camera") + content);
    auto image = f.open(shm::IfaceType::camera, "robot::eye");
    auto boxes = f.boxes();
    return std::pair(std::move(boxes), bytes(image.hold()));
  };
  const auto [first, one] = seen_in(world);
  const auto [second, two] = seen_in(world + cube("glass", -9, 0, "<transparency>0.5</transparency>", ""));
  ASSERT_EQ(first.size(), 3U);
  ASSERT_EQ(second.size(), first.size());
  for (std::size_t i = 0; i < first.size(); ++i) EXPECT_EQ(std::memcmp(&first[i], &second[i], sizeof first[i]), 0) << first[i].name;
  EXPECT_EQ(one, two);
  EXPECT_EQ(one, Images(camera("camera") + world).image("robot::eye"));
}

TEST(BoundingBoxCamera, boxes_are_those_of_the_image_of_the_same_time) {
  Images f(camera("boundingbox_camera") +
           "<model name='runner'><pose>3 -1 0 0 0 0</pose><link name='l'><visual name='v'><geometry><box>"
           "<size>0.2 0.2 0.2</size></box></geometry><material><emissive>1 0 0 1</emissive></material></visual></link>" +
           label(1) + "</model>");
  auto images = f.open(shm::IfaceType::camera, "robot::eye");
  auto boxes = f.open(shm::IfaceType::boxes, "robot::eye");
  for (int i = 0; i < 5; ++i) {
    f.run(0.1);
    const auto frame = images.hold();
    ASSERT_TRUE(frame && boxes.read());
    ASSERT_EQ(boxes.filled(), 1U);
    EXPECT_EQ(frame->head().stamp.sim_time_ns, boxes.sample<shm::Stamp>().sim_time_ns);
    const auto& box = *reinterpret_cast<const shm::Box*>(boxes.sample_followers(0));
    const auto* data = reinterpret_cast<const std::uint8_t*>(frame->data().data());
    const auto red = [&](double x) {
      return data[3 * (static_cast<std::size_t>(box.center[1]) * width + static_cast<std::size_t>(x))] > 200;
    };
    EXPECT_TRUE(red(box.center[0] - box.size[0] / 2 + 0.5) && red(box.center[0] + box.size[0] / 2 - 0.5));
  }
}

std::string warm(const std::string& heat) {
  return "<plugin filename='gz-sim-thermal-system' name='gz::sim::systems::Thermal'>" + heat + "</plugin>";
}

double kelvin(const std::vector<std::uint8_t>& image, int x, int y, double unit) {
  const auto i = static_cast<std::size_t>(2 * (y * width + x));
  return unit * (image[i] + 256 * image[i + 1]);
}

TEST(ThermalCamera, shows_temperatures_in_hundredths_of_a_kelvin_and_the_air_elsewhere) {
  double unit = 0;
  Images f(camera("thermal_camera") + cube("a", 2, 1.5, warm("<temperature>310.55</temperature>"), "") + cube("b", 2, -1.5, "", ""));
  const auto image = f.image("robot::eye", &unit);
  EXPECT_EQ(unit, 0.01);
  EXPECT_NEAR(kelvin(image, 20, 40, unit), 310.55, 0.006);
  EXPECT_NEAR(kelvin(image, 80, 40, unit), 288.15, 0.006);
  EXPECT_NEAR(kelvin(image, 50, 5, unit), 288.15, 0.006);
}

TEST(ThermalCamera, of_eight_bits_counts_in_steps_and_ends_at_its_range) {
  double unit = 0;
  Images f(camera("thermal", "<format>L8</format>",
                  "<plugin filename='gz-sim-thermal-sensor-system' name='gz::sim::systems::ThermalSensor'><min_temp>253.15</min_temp>"
                  "<max_temp>673.15</max_temp><resolution>3.0</resolution></plugin>") +
           cube("a", 2, 1.5, warm("<temperature>300</temperature>"), "") + cube("b", 2, -1.5, warm("<temperature>2000</temperature>"), ""));
  const auto image = f.image("robot::eye", &unit);
  EXPECT_EQ(unit, 3);
  EXPECT_EQ(image[40 * width + 20], 100);
  EXPECT_EQ(image[40 * width + 80], 224);
}

TEST(ThermalCamera, a_heat_signature_runs_from_the_lowest_temperature_to_the_highest) {
  Image halves{64, 64, {}};
  for (int i = 0; i < 64 * 64; ++i) {
    const std::uint8_t grey = i % 64 < 32 ? 0 : 255;
    halves.rgba.insert(halves.rgba.end(), {grey, grey, grey, 255});
  }
  const auto file = std::filesystem::temp_directory_path() / ("signature-" + std::to_string(::getpid()) + ".png");
  ASSERT_TRUE(write_png(halves, file));
  double unit = 0;
  Images f(
      camera("thermal_camera") +
      cube("a", 1, 0, warm("<heat_signature>" + file.string() + "</heat_signature><min_temp>280</min_temp><max_temp>320</max_temp>"), ""));
  const auto image = f.image("robot::eye", &unit);
  std::filesystem::remove(file);
  EXPECT_NEAR(kelvin(image, 35, 40, unit), 280, 0.5);
  EXPECT_NEAR(kelvin(image, 65, 40, unit), 320, 0.5);
}

// What is said of a world with a camera of 8 or 16 bits and this plugin in it, and a cube with that heat.
std::vector<std::string> lines_of(const std::string& format, const std::string& sensor, const std::string& heat) {
  const auto loaded = load_world_text(
      "<sdf version='1.9'><world name='w'>" +
          camera("thermal_camera", "<format>" + format + "</format>",
                 "<plugin filename='gz-sim-thermal-sensor-system' name='gz::sim::systems::ThermalSensor'>" + sensor + "</plugin>") +
          cube("a", 2, 1.5, warm(heat), "") + "</world></sdf>",
      {}, "w.sdf", ModelPath{});
  std::vector<std::string> lines;
  for (const Finding& finding : loaded->findings) lines.push_back(finding.message);
  return lines;
}

TEST(ThermalCamera, numbers_that_cannot_be_have_one_line_each) {
  const std::string usual = "<temperature>300</temperature>";
  EXPECT_THAT(lines_of("L16", "<min_temp>253.15</min_temp><max_temp>500</max_temp><resolution>0.01</resolution>", usual),
              testing::IsEmpty());
  for (const auto& [sensor, expected] : std::initializer_list<std::pair<const char*, const char*>>{
           {"<resolution>0</resolution>", "<resolution> of"},
           {"<resolution>fine</resolution>", "<resolution> of"},
           {"<resolution>0.5</resolution>", "must be 1 K or more with 8 bits, got 0.5"},
           {"<min_temp>-5</min_temp>", "<min_temp> of"},
           {"<min_temp>inf</min_temp>", "<min_temp> of"},
           {"<max_temp>nan</max_temp>", "<max_temp> of"},
           {"<max_temp>0</max_temp>", "<max_temp> of"},
           {"<min_temp>300</min_temp><max_temp>200</max_temp>", "got 300 and 200"},
           {"<min_temp>800</min_temp>", "and 765 K, the highest that it can show"}})
    EXPECT_THAT(lines_of("L8", sensor, usual), testing::ElementsAre(testing::HasSubstr(expected))) << sensor;
  for (const auto& [heat, expected] : std::initializer_list<std::pair<const char*, const char*>>{
           {"<temperature>-1</temperature>", "got \"-1\""},
           {"<temperature>warm</temperature>", "got \"warm\""},
           {"<temperature>1e6</temperature>", "got \"1e6\""},
           {"<min_temp>nan</min_temp><max_temp>300</max_temp>", "got \"nan to 300\""},
           {"<min_temp>310</min_temp><max_temp>300</max_temp>", "got \"310 to 300\""}})
    EXPECT_THAT(lines_of("L16", "", heat), testing::ElementsAre(testing::HasSubstr(expected))) << heat;
}

TEST(ThermalCamera, that_shares_its_name_with_a_camera_of_another_link_gets_a_number) {
  const auto link = [](const std::string& name, const std::string& type) {
    return "<link name='" + name + "'><sensor name='eye' type='" + type +
           "'><camera><image><width>16</width><height>12</height></image></camera></sensor></link>";
  };
  auto loaded = load_world_text("<sdf version='1.9'><world name='w'><model name='robot'><static>true</static>" + link("a", "camera") +
                                    link("b", "thermal_camera") + "</model></world></sdf>",
                                {}, "w.sdf", ModelPath{});
  ASSERT_TRUE(loaded);
  SimulationFixture f(std::move(loaded->world));
  EXPECT_TRUE(shm::Iface::open(own_server_id(), shm::IfaceType::camera, "robot::eye"));
  EXPECT_TRUE(shm::Iface::open(own_server_id(), shm::IfaceType::camera, "robot::eye_1"));
}

}  // namespace
}  // namespace sim
