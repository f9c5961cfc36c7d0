// Sensors of sound, air, radio and wheels, and fused estimates, against the truth.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "shm/client.h"
#include "support/physics_fixture.h"
#include "support/simulation_fixture.h"

namespace sim {
namespace {

using namespace test;
using shm::IfaceType;

constexpr double degree = std::numbers::pi / 180;

constexpr const char* bottom =
    "<gravity>0 0 0</gravity><model name='bottom'><static>1</static><link name='l'><collision "
    "name='c'><geometry><plane/></geometry></collision></link></model>";

std::string moving(const std::string& pose, const std::string& sensors) {
  return "<model name='m'><pose>" + pose +
         "</pose><link name='l'><inertial><mass>1</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia></inertial>" + sensors +
         "</link></model>";
}

std::string dvl(const std::string& noise = "", const std::string& more = "") {
  std::string beams;
  for (const char* rotation : {"45", "135", "-45", "-135"})
    beams += "<beam><aperture>2</aperture><rotation>" + std::string(rotation) + "</rotation><tilt>30</tilt></beam>";
  return "<sensor name='dvl' type='custom' gz:type='dvl'><update_rate>10</update_rate><gz:dvl><type>phased_array</type><arrangement "
         "degrees='true'>" +
         beams + "</arrangement><tracking><bottom_mode><when>best</when>" + noise + "</bottom_mode></tracking>" + more +
         "</gz:dvl></sensor>";
}

shm::DvlSample dvl_of(SimulationFixture& f, const Twist& twist, double seconds = 0.1) {
  auto iface = f.open(IfaceType::dvl, "m::dvl");
  const auto model = f.simulation->physics().find("m").value();
  EXPECT_TRUE(f.simulation->physics().set_model_twist(model, twist));
  f.run(seconds);
  EXPECT_TRUE(iface.read());
  return iface.sample<shm::DvlSample>();
}

TEST(Dvl, measures_its_velocity_against_the_bottom_in_its_own_frame) {
  SimulationFixture f(world_of_text(bottom + moving("0 0 10 0 0 1.5707963268", dvl())));
  const auto sample = dvl_of(f, {{0.5, 1.5, -0.25}, {0, 0, 0}});
  EXPECT_EQ(sample.locked, 4U);
  EXPECT_EQ(sample.has_velocity, 1U);
  // It looks north: what is north for the world is ahead.
  EXPECT_NEAR(sample.velocity[0], 1.5, 1e-6);
  EXPECT_NEAR(sample.velocity[1], -0.5, 1e-6);
  EXPECT_NEAR(sample.velocity[2], -0.25, 1e-6);
  EXPECT_NEAR(sample.range, (10 - 0.025) / std::cos(29 * degree), 0.01) << "the nearest that the cone of a beam meets";
}

TEST(Dvl, tells_its_velocity_in_the_reference_frame) {
  SimulationFixture f(world_of_text(bottom + moving("0 0 10 0 0 0", dvl("", "<reference_frame>0 0 0 0 0 1.5707963268</reference_frame>"))));
  const auto sample = dvl_of(f, {{1, 0, 0}, {0, 0, 0}});
  EXPECT_NEAR(sample.velocity[0], 0, 1e-6);
  EXPECT_NEAR(sample.velocity[1], -1, 1e-6);
}

TEST(Dvl, loses_the_bottom_out_of_its_reach) {
  SimulationFixture f(world_of_text(bottom + moving("0 0 10 0 0 0", dvl("", "<maximum_range>8</maximum_range>"))));
  const auto sample = dvl_of(f, {{1, 0, 0}, {0, 0, 0}});
  EXPECT_EQ(sample.locked, 0U);
  EXPECT_EQ(sample.has_velocity, 0U);
  EXPECT_TRUE(std::isinf(sample.range));
  EXPECT_EQ(sample.velocity[0], 0);
}

TEST(Dvl, has_the_noise_of_its_beams_with_the_covariance_that_it_tells) {
  SimulationFixture f(world_of_text(bottom + moving("0 0 10 0 0 0", dvl("<noise type='gaussian'><stddev>0.02</stddev></noise>"))));
  auto iface = f.open(IfaceType::dvl, "m::dvl");
  double sum = 0, squares = 0, told = 0;
  constexpr int count = 400;
  for (int i = 0; i < count; ++i) {
    f.run(0.1);
    ASSERT_TRUE(iface.read());
    const auto& sample = iface.sample<shm::DvlSample>();
    sum += sample.velocity[0], squares += sample.velocity[0] * sample.velocity[0];
    told = sample.covariance[0];
  }
  // Four beams with sin(30) cos(45) of x each: variance 0.02^2 / (4 * 0.125).
  EXPECT_NEAR(told, 0.0004 / 0.5, 1e-9);
  EXPECT_NEAR(squares / count - std::pow(sum / count, 2), told, 0.25 * told);
}

TEST(AirSpeed, is_the_dynamic_pressure_of_the_air_ahead) {
  SimulationFixture f(world_of_text("<gravity>0 0 0</gravity><wind><linear_velocity>-5 0 0</linear_velocity></wind>" +
                                    moving("0 0 1000 0 0 0", "<sensor name='pitot' type='air_speed'/>")));
  auto iface = f.open(IfaceType::air_speed, "m::pitot");
  const auto model = f.simulation->physics().find("m").value();
  ASSERT_TRUE(f.simulation->physics().set_model_twist(model, {{15, 0, 0}, {0, 0, 0}}));
  f.run(0.1);
  ASSERT_TRUE(iface.read());
  const double temperature = 288.15 - 6.5, density = 1.225 / std::pow(288.15 / temperature, 4.256);
  EXPECT_NEAR(iface.sample<shm::AirSpeedSample>().temperature, temperature, 1e-6);
  EXPECT_NEAR(iface.sample<shm::AirSpeedSample>().pressure, 0.5 * density * 400, 1e-3);
  ASSERT_TRUE(f.simulation->physics().set_model_twist(model, {{-15, 0, 0}, {0, 0, 0}}));
  f.run(0.1);
  ASSERT_TRUE(iface.read());
  EXPECT_NEAR(iface.sample<shm::AirSpeedSample>().pressure, -0.5 * density * 100, 1e-3);
}

TEST(Ins, tells_place_velocity_and_a_yaw_that_is_0_in_the_east) {
  SimulationFixture f(
      world_of_text("<gravity>0 0 "
                    "0</gravity><spherical_coordinates><surface_model>EARTH_WGS84</surface_model><latitude_deg>36</"
                    "latitude_deg><longitude_deg>140</longitude_deg>"
                    "<elevation>25</elevation><heading_deg>90</heading_deg></spherical_coordinates>" +
                    moving("100 0 2 0 0 0.5", "<sensor name='ins' type='custom' gz:type='ins'/>")));
  auto iface = f.open(IfaceType::ins, "m::ins");
  ASSERT_TRUE(f.simulation->physics().set_model_twist(f.simulation->physics().find("m").value(), {{0, 2, 0}, {0, 0, 0}}));
  f.run(0.1);
  ASSERT_TRUE(iface.read());
  const auto& sample = iface.sample<shm::InsSample>();
  EXPECT_NEAR(std::remainder(sample.orientation[2] - (0.5 + std::numbers::pi / 2), 2 * std::numbers::pi), 0, 1e-9)
      << "the world's x axis points north";
  EXPECT_GT(sample.latitude, 36.0008);
  EXPECT_NEAR(sample.altitude, 27, 0.01);
  EXPECT_NEAR(sample.height, 2, 1e-9);
  EXPECT_NEAR(sample.velocity[0], -2, 1e-6);
}

std::string tag(const std::string& name, const std::string& pose, const std::string& content = "") {
  return "<model name='" + name + "'><static>1</static><pose>" + pose + "</pose><link name='l'><sensor name='tag' type='rfidtag'>" +
         content + "</sensor></link></model>";
}

std::vector<std::string> tags_read(const std::string& reader, const std::string& around) {
  SimulationFixture f(
      world_of_text("<model name='m'><static>1</static><pose>0 0 1 0 0 0</pose><link name='l'><sensor name='reader' type='rfid'>" + reader +
                    "</sensor></link></model>" + around));
  auto iface = f.open(IfaceType::rfid, "m::reader");
  f.run(0.01);
  EXPECT_TRUE(iface.read());
  std::vector<std::string> ids;
  for (const auto& one : iface.elements<shm::RfidTag>()) ids.emplace_back(one.id);
  return ids;
}

TEST(Rfid, reads_tags_in_reach_the_nearest_first) {
  const std::string around = tag("far", "0.9 0 1 0 0 0") +
                             tag("near", "-0.5 0 1 0 0 0", "<gz:rfidtag><id>E200-17</id><data>shelf 3</data></gz:rfidtag>") +
                             tag("out", "0 1.1 1 0 0 0");
  EXPECT_EQ(tags_read("", around), (std::vector<std::string>{"E200-17", "far::tag"}));
  EXPECT_EQ(tags_read("<gz:rfid><angle>1.0</angle></gz:rfid>", around), std::vector<std::string>{"far::tag"})
      << "the other one is behind it";
  EXPECT_EQ(tags_read("<gz:rfid><range>3</range><angle>3.2</angle></gz:rfid>", around), (std::vector<std::string>{"far::tag", "out::tag"}));
}

TEST(Rfid, reads_through_walls_unless_it_needs_sight) {
  const std::string around = tag("hidden", "0.9 0 1 0 0 0") +
                             "<model name='wall'><static>1</static><pose>0.5 0 1 0 0 0</pose><link name='l'><collision "
                             "name='c'><geometry><box><size>0.1 2 2</size></box></geometry></collision></link></model>";
  EXPECT_EQ(tags_read("", around).size(), 1U);
  EXPECT_EQ(tags_read("<gz:rfid><line_of_sight>1</line_of_sight></gz:rfid>", around).size(), 0U);
}

TEST(Rfid, writes_a_tag_in_its_reach_for_all_readers_until_a_reset) {
  SimulationFixture f(world_of_text(
      "<model name='m'><static>1</static><pose>0 0 1 0 0 0</pose><link name='l'><sensor name='a' type='rfid'/><sensor name='b' "
      "type='rfid'/>"
      "<sensor name='imu' type='imu'/></link></model>" +
      tag("near", "-0.5 0 1 0 0 0", "<gz:rfidtag><id>E200-17</id><data>shelf 3</data></gz:rfidtag>") + tag("out", "0 1.1 1 0 0 0")));
  auto other = f.open(IfaceType::rfid, "m::b");
  const auto data = [&] {
    f.run(0.01);
    EXPECT_TRUE(other.read());
    return std::string(other.elements<shm::RfidTag>()[0].data);
  };
  EXPECT_EQ(data(), "shelf 3");
  Device& reader = *f.simulation->device("m::a");
  const std::uint64_t before = f.simulation->hash();
  EXPECT_TRUE(reader.write_tag("E200-17", "shelf 4"));
  EXPECT_NE(f.simulation->hash(), before);
  EXPECT_EQ(data(), "shelf 4");
  const auto message = [](const base::Result<void>& written) { return written ? std::string("written") : written.error().message; };
  EXPECT_EQ(message(reader.write_tag("out::tag", "x")), "m::a has no tag \"out::tag\" in reach; it has E200-17");
  EXPECT_EQ(message(f.simulation->device("m::imu")->write_tag("E200-17", "x")), "m::imu is no reader of RFID tags");
  EXPECT_EQ(data(), "shelf 4");
  ASSERT_TRUE(f.simulation->reset(f.notes));
  EXPECT_EQ(data(), "shelf 3");
}

TEST(Wireless, receives_what_free_space_leaves_and_less_behind_a_wall) {
  const std::string wall =
      "<model name='wall'><static>1</static><pose>5 0 1 0 0 0</pose><link name='l'><collision name='c'><geometry><box><size>0.1 2 "
      "2</size></box></geometry></collision></link></model>";
  for (const bool is_blocked : {false, true}) {
    SimulationFixture f(world_of_text(
        "<model name='m'><static>1</static><pose>0 0 1 0 0 0</pose><link name='l'><sensor name='radio' "
        "type='wireless_receiver'/></link></model>"
        "<model name='base'><static>1</static><pose>10 0 1 0 0 0</pose><link name='l'><sensor name='ap' "
        "type='wireless_transmitter'><transceiver><essid>lab</essid></transceiver></sensor>"
        "<sensor name='other' type='wireless_transmitter'><transceiver><frequency>5180</frequency></transceiver></sensor></link></model>" +
        (is_blocked ? wall : "")));
    auto iface = f.open(IfaceType::wireless, "m::radio");
    f.run(0.01);
    ASSERT_TRUE(iface.read());
    ASSERT_EQ(iface.elements<shm::Radio>().size(), 1U) << "the other one is out of its band";
    const auto& radio = iface.elements<shm::Radio>()[0];
    EXPECT_STREQ(radio.essid, "lab");
    EXPECT_STREQ(radio.transmitter, "base::ap");
    EXPECT_EQ(radio.is_blocked, is_blocked ? 1U : 0U);
    EXPECT_NEAR(radio.level, 14.5 + 2.5 + 2.5 - 60.203 - (is_blocked ? 20 : 0), 0.01);
  }
}

TEST(Wheels, count_the_ticks_that_a_wheel_has_turned) {
  SimulationFixture f(world_of_text(
      "<gravity>0 0 0</gravity><model name='m'><link name='l'><inertial><mass>10</mass></inertial><sensor name='wheels' "
      "type='custom' gz:type='wheel_encoders'><gz:wheel_encoders>"
      "<joint>j</joint><ticks>500</ticks><gear_ratio>2</gear_ratio></gz:wheel_encoders></sensor></link>"
      "<joint name='fixed' type='fixed'><parent>world</parent><child>l</child></joint>"
      "<link name='wheel'><inertial><mass>1</mass><inertia><ixx>.01</ixx><iyy>.01</iyy><izz>.01</izz></inertia></inertial><collision "
      "name='c'><geometry><sphere><radius>0.1</radius></sphere></geometry></collision></link>"
      "<joint name='j' type='revolute'><parent>l</parent><child>wheel</child><axis><xyz>0 0 1</xyz></axis></joint></model>"));
  auto iface = f.open(IfaceType::wheels, "m::wheels");
  EXPECT_EQ(iface.info<shm::WheelsInfo>().ticks, 1000);
  EXPECT_EQ(iface.info_elements<shm::Wheel>()[0].radius, 0.1);
  const auto model = f.simulation->physics().find("m").value();
  for (int i = 0; i < 2000; ++i) {
    f.simulation->physics().set_motor({model, 1}, 0, 5, 1000);
    f.run(0.001);
  }
  ASSERT_TRUE(iface.read());
  const auto& encoder = iface.elements<shm::WheelState>()[0];
  EXPECT_NEAR(encoder.angle, 10, 0.02) << "more than a turn";
  EXPECT_EQ(encoder.ticks, std::floor(encoder.ticks));
  EXPECT_NEAR(encoder.angle, encoder.ticks / 1000 * 2 * std::numbers::pi, 1e-9);
  EXPECT_NEAR(encoder.speed, 5, 1e-3);
}

TEST(Wheels, of_a_joint_that_is_not_there_are_left_out_with_a_line) {
  SimulationFixture f(
      world_of_text("<model name='m'><link name='l'><sensor name='w' type='custom' "
                    "gz:type='wheel_encoders'><gz:wheel_encoders><joint>nowhere</joint></gz:wheel_encoders></sensor></link></model>"));
  ASSERT_EQ(f.dropped.size() + f.notes.size(), 1U);
  EXPECT_NE((f.dropped.empty() ? f.notes : f.dropped).front().find("the model has no joint \"nowhere\""), std::string::npos);
}

TEST(Localization, is_the_truth_with_noise_and_weights_that_sum_to_1) {
  SimulationFixture f(
      world_of_text("<model name='m'><static>1</static><pose>3 4 0 0 0 1</pose><link name='l'><sensor name='amcl' type='custom' "
                    "gz:type='localization'><update_rate>100</update_rate><gz:localization>"
                    "<position><noise type='gaussian'><stddev>0.2</stddev></noise></position><heading><noise "
                    "type='gaussian'><stddev>0.1</stddev></noise></heading>"
                    "<hypotheses>5</hypotheses></gz:localization></sensor></link></model>"));
  auto iface = f.open(IfaceType::localization, "m::amcl");
  double sum = 0, squares = 0;
  int count = 0;
  for (int i = 0; i < 400; ++i) {
    f.run(0.01);
    ASSERT_TRUE(iface.read());
    double weights = 0, before = 1;
    ASSERT_EQ(iface.elements<shm::Hypothesis>().size(), 5U);
    for (const auto& one : iface.elements<shm::Hypothesis>()) {
      EXPECT_LE(one.weight, before);
      weights += before = one.weight;
      EXPECT_NEAR(one.covariance[0], 0.04, 1e-12);
      EXPECT_NEAR(one.covariance[5], 0.01, 1e-12);
      sum += one.pose[0] - 3, squares += std::pow(one.pose[0] - 3, 2), ++count;
    }
    EXPECT_NEAR(weights, 1, 1e-9);
  }
  EXPECT_NEAR(sum / count, 0, 0.02);
  EXPECT_NEAR(squares / count, 0.04, 0.005);
}

}  // namespace
}  // namespace sim
