// Every numeric element of every type of sensor with impossible values: one line each, no sample that is no number, no endless load.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "server/describe.h"
#include "shm/iface_json.h"
#include "support/simulation_fixture.h"
#include "world/world_loader.h"

namespace sim {
namespace {

using namespace test;

constexpr std::array values{"nan", "inf", "-1", "0", "1e9", "1e300"};

struct Element {
  std::string path;  // from the sensor, or from what Type::around opens
  std::string good;  // the values that mean something: no line
};
using Elements = std::vector<Element>;

Elements operator+(Elements a, const Elements& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

Elements noise(const std::string& path = "") {
  Elements all{{"mean", "-1 0"},
               {"stddev", "0"},
               {"bias_mean", "-1 0"},
               {"bias_stddev", "0"},
               {"dynamic_bias_stddev", "0"},
               {"dynamic_bias_correlation_time", "0 1e9"},
               {"precision", "0"}};
  for (Element& one : all) one.path = path + (path.empty() ? "" : "/") + "noise/" + one.path;
  return all;
}
// Of scans and images, which have no more.
Elements short_noise() { return {{"noise/mean", "-1 0"}, {"noise/stddev", "0"}}; }
Elements noises(const std::string& path) {
  const std::string at = path.empty() ? "" : path + "/";
  return noise(at + "x") + noise(at + "y") + noise(at + "z");
}
Elements scan_elements() {
  return Elements{{"scan/horizontal/samples", ""},
                  {"scan/horizontal/resolution", ""},
                  {"scan/horizontal/min_angle", "-1 0"},
                  {"scan/horizontal/max_angle", "0"},
                  {"scan/vertical/samples", "0"},
                  {"scan/vertical/resolution", ""},
                  {"scan/vertical/min_angle", "-1 0"},
                  {"scan/vertical/max_angle", "0"},
                  {"range/min", "0"},
                  {"range/max", ""},
                  {"range/resolution", "0"}} +
         short_noise();
}
Elements camera_elements() {
  return Elements{{"horizontal_fov", ""},
                  {"image/width", ""},
                  {"image/height", ""},
                  {"clip/near", ""},
                  {"clip/far", "1e9"},
                  {"distortion/k1", "-1 0"},
                  {"distortion/k2", "-1 0"},
                  {"distortion/k3", "-1 0"},
                  {"distortion/p1", "-1 0"},
                  {"distortion/p2", "-1 0"},
                  {"distortion/center", "-1 0 1e9"},
                  {"lens/cutoff_angle", "0"},
                  {"lens/env_texture_size", ""},
                  {"lens/custom_function/c1", "-1"},
                  {"lens/custom_function/c2", "-1"},
                  {"lens/custom_function/c3", "-1 0"},
                  {"lens/custom_function/f", "1e9"}} +
         short_noise();
}
Elements radio_elements() {
  return {{"frequency", "1e9"}, {"min_frequency", "0"}, {"max_frequency", "1e9"},
          {"gain", "-1 0"},     {"power", "-1 0"},      {"sensitivity", "-1 0"}};
}

struct Type {
  std::string name, around;  // the element of the sensor that the paths begin in
  std::string base;          // of that element
  Elements elements;
};

void PrintTo(const Type& type, std::ostream* out) { *out << type.name; }

std::vector<Type> types() {
  const std::string image = "<image><width>8</width><height>6</height></image>";
  const std::string beams =
      "<arrangement degrees='true'><beam id='1'><rotation>45</rotation><tilt>30</tilt></beam><beam id='2'><rotation>135</rotation><tilt>30"
      "</tilt></beam><beam id='3'><rotation>-90</rotation><tilt>30</tilt></beam></arrangement>";
  const Elements position = noise("position_sensing/horizontal") + noise("position_sensing/vertical");
  const Elements velocity = noise("velocity_sensing/horizontal") + noise("velocity_sensing/vertical");
  std::vector<Type> all{
      {"ray", "ray", "", scan_elements()},
      {"gpu_lidar", "lidar", "", scan_elements()},
      {"contact", "contact", "<collision>c</collision>", {}},
      {"imu", "imu", "",
       noises("angular_velocity") + noises("linear_acceleration") + Elements{{"orientation_reference_frame/custom_rpy", "-1 0 1e9"}}},
      {"gps", "gps", "", position + velocity},
      {"navsat", "navsat", "", position + velocity},
      {"sonar", "sonar", "", {{"min", "0"}, {"max", "1e9"}, {"radius", "0"}}},
      {"force_torque", "force_torque", "", noises("force") + noises("torque")},
      {"altimeter", "altimeter", "", noise("vertical_position") + noise("vertical_velocity")},
      {"magnetometer", "magnetometer", "", noises("")},
      {"air_pressure", "air_pressure", "", noise("pressure") + Elements{{"reference_altitude", "-1 0"}}},
      {"air_speed", "air_speed", "", noise("pressure")},
      {"logical_camera", "logical_camera", "", {{"near", "0"}, {"far", "inf 1e9 1e300"}, {"horizontal_fov", ""}, {"aspect_ratio", "1e9"}}},
      {"fiducial", "fiducial", "",
       Elements{{"range/min", "0"}, {"range/max", "inf 1e9 1e300"}, {"horizontal_fov", ""}} + noise("position") + noise("orientation")},
      {"rfid", "rfid", "", {{"range", ""}, {"angle", ""}}},
      {"rfidtag", "rfidtag", "", {}},
      {"wireless_receiver", "transceiver", "", radio_elements()},
      {"wireless_transmitter", "transceiver", "", radio_elements()},
      {"dvl", "gz:dvl", beams,
       Elements{{"minimum_range", "0"}, {"maximum_range", ""}, {"reference_frame", "-1 0 1e9"}} + noise("tracking/bottom_mode")},
      {"ins", "gz:ins", "", position + velocity + noise("orientation_sensing/attitude") + noise("orientation_sensing/heading")},
      {"wheel_encoders", "gz:wheel_encoders", "<joint>j</joint>", {{"ticks", "1e9"}, {"gear_ratio", ""}}},
      {"localization", "gz:localization", "", noise("position") + noise("heading") + Elements{{"hypotheses", ""}}}};
  for (const char* camera : {"camera", "wideanglecamera", "depth_camera", "rgbd_camera", "multicamera", "segmentation_camera",
                             "boundingbox_camera", "thermal_camera"})
    all.push_back({camera, "camera", image, camera_elements()});
  return all;
}

// Elements that mean something only beside another one.
std::string opened(const std::string& name) {
  if (name == "noise") return "<noise type='gaussian_quantized'>";
  if (name == "lens") return "<lens><type>custom</type>";
  if (name == "orientation_reference_frame") return "<orientation_reference_frame><localization>CUSTOM</localization>";
  return "<" + name + ">";
}
std::string nested(const std::string& path, const std::string& text) {
  const auto slash = path.find('/');
  const std::string name = path.substr(0, slash);
  return opened(name) + (slash == std::string::npos ? text : nested(path.substr(slash + 1), text)) + "</" + name + ">";
}

struct Case {
  std::string sensor, path, value;
  bool is_good;
};

std::string sensor_with(const Type& type, const Case& one) {
  const bool is_of_sensor = one.path == "update_rate" || one.path == "pose";
  std::string text = one.value;
  if (one.path == "pose" || one.path == "reference_frame") text += " 0 0 0 0 0";
  if (one.path.ends_with("custom_rpy")) text += " 0 0";
  if (one.path.ends_with("center")) text += " 0.5";
  const bool is_custom = type.around.starts_with("gz:");
  const std::string base = one.path.starts_with("image") ? "" : type.base;
  return "<sensor name='" + one.sensor + "' type='" + (is_custom ? "custom' gz:type='" + type.name : type.name) + "'>" +
         (is_of_sensor ? nested(one.path, text) : "") + "<" + type.around + ">" + base + (is_of_sensor ? "" : nested(one.path, text)) +
         "</" + type.around + "></sensor>";
}

std::vector<Case> cases_of(const Type& type) {
  std::vector<Case> cases;
  for (const Element& element : type.elements + Elements{{"update_rate", "0"}, {"pose", "-1 0 1e9"}}) {
    for (const char* value : values) {
      const bool is_good = (" " + element.good + " ").find(" " + std::string(value) + " ") != std::string::npos;
      cases.push_back({"n" + std::to_string(cases.size() + 100), element.path, value, is_good});
    }
  }
  return cases;
}

LoadResult world_of_cases(const Type& type, const std::vector<Case>& cases) {
  std::string sensors;
  for (const Case& one : cases) sensors += sensor_with(type, one);
  const bool is_of_joint = type.name == "force_torque";
  auto loaded = load_world_text(
      "<sdf version='1.9' xmlns:gz='http://gazebosim.org/schema'><world name='w'><spherical_coordinates><surface_model>EARTH_WGS84"
      "</surface_model><latitude_deg>36</latitude_deg><longitude_deg>140</longitude_deg><elevation>20</elevation></spherical_coordinates>"
      "<model name='m'><link name='l'><collision name='c'><geometry><sphere><radius>0.1</radius></sphere></geometry></collision>" +
          (is_of_joint ? "" : sensors) +
          "</link><link name='k'/><joint name='j' type='revolute'><parent>l</parent><child>k</child><axis><xyz>0 0 1</xyz><limit>"
          "<lower>-1</lower><upper>1</upper></limit></axis>" +
          (is_of_joint ? sensors : "") + "</joint></model></world></sdf>",
      {}, "w.sdf", ModelPath{});
  if (!loaded) throw std::runtime_error(loaded.error().message);
  return std::move(*loaded);
}

// Of frames of depths the pixels; JSON has null for what is no number.
void expect_numbers(shm::Iface& iface) {
  if (shm::has_frames(iface.type())) {
    const auto frame = iface.hold();
    if (!frame || static_cast<shm::Format>(frame->head().format) != shm::Format::depth_float) return;
    const auto* depths = reinterpret_cast<const float*>(frame->data().data());
    for (std::size_t i = 0; i < frame->data().size() / sizeof(float); ++i) EXPECT_FALSE(std::isnan(depths[i])) << iface.name();
    return;
  }
  if (!iface.read()) return;
  // Infinite: nothing was hit.
  if (iface.type() == shm::IfaceType::laser || iface.type() == shm::IfaceType::sonar) {
    const auto ranges = iface.type() == shm::IfaceType::laser ? iface.laser_scan().ranges : iface.sonar_scan().ranges;
    for (const float range : ranges) EXPECT_FALSE(std::isnan(range)) << iface.name();
    return;
  }
  for (const auto& values : {simctl::sample_json(iface), simctl::info_json(iface)}) {
    std::string text = values.dump();
    // Of these infinity means something, too: a view or a range without an end, no echo.
    for (const std::string may_be_infinite : {"\"far\":null", "\"max_range\":null", "\"range\":null"}) {
      for (std::size_t at; (at = text.find(may_be_infinite)) != std::string::npos;) text.erase(at, may_be_infinite.size());
    }
    EXPECT_EQ(text.find("null"), std::string::npos) << iface.name() << ": " << text;
  }
}

class SensorNonsense : public testing::TestWithParam<Type> {};

TEST_P(SensorNonsense, gets_one_line_and_no_sample_that_is_no_number) {
  const Type& type = GetParam();
  const std::vector<Case> cases = cases_of(type);
  LoadResult loaded = world_of_cases(type, cases);
  for (const Case& one : cases) {
    std::vector<std::string> lines;
    for (const Finding& finding : loaded.findings) {
      if (finding.message.find("\"" + one.sensor + "\"") != std::string::npos) lines.push_back(finding.message);
    }
    EXPECT_EQ(lines.size(), one.is_good ? 0 : 1) << one.path << " " << one.value << (lines.empty() ? "" : ": " + lines.front());
  }
  SimulationFixture f(std::move(loaded.world));
  f.simulation->pictures().set_synchronous(true);
  std::vector<shm::Iface> ifaces;
  const auto list = nlohmann::json::parse(list_text(*f.simulation));
  for (const auto& one : list["ifaces"]) ifaces.push_back(f.open(*shm::parse_type(one["type"].get<std::string>()), one["name"]));
  f.run(0.003);
  for (shm::Iface& iface : ifaces) expect_numbers(iface);
}

INSTANTIATE_TEST_SUITE_P(types, SensorNonsense, testing::ValuesIn(types()), [](const auto& given) { return given.param.name; });

}  // namespace
}  // namespace sim
