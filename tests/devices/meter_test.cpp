// force_torque, altimeter, magnetometer and air_pressure sensors against the truth.
#include "devices/sensors/air_pressure.h"

#include <gtest/gtest.h>

#include "support/physics_fixture.h"
#include "support/simulation_fixture.h"

namespace sim {
namespace {

using namespace test;
using shm::IfaceType;

constexpr double g = 9.8;

Eigen::Vector3d vector_of(const double (&v)[3]) { return {v[0], v[1], v[2]}; }

// An arm of 2 kg, its centre 0.5 m in front of the joint at (0, 0, 1), on a base that is welded to the world.
std::string arm(const std::string& kind, const std::string& sensor, const std::string& pose = "0 0 1 0 0 0", const std::string& axis = "") {
  return "<model name='m'><allow_auto_disable>0</allow_auto_disable><link name='base'><pose>0 0 0 0 0 0.3</pose></link><link "
         "name='arm'><pose>" +
         pose +
         "</pose><inertial><pose>0.5 0 0 0 0 "
         "0</pose><mass>2</mass><inertia><ixx>0.1</ixx><iyy>0.1</iyy><izz>0.1</izz></inertia></inertial></link>"
         "<joint name='held' type='fixed'><parent>world</parent><child>base</child></joint><joint name='j' type='" +
         kind + "'><parent>base</parent><child>arm</child>" + axis + "<sensor name='load' type='force_torque'>" + sensor +
         "</sensor></joint></model>";
}

struct Load {
  Eigen::Vector3d force, torque;
};
Load load_after(SimulationFixture& f, double seconds) {
  auto iface = f.open(IfaceType::force_torque, "m::load");
  f.run(seconds);
  EXPECT_TRUE(iface.read());
  const auto& sample = iface.sample<shm::ForceTorqueSample>();
  return {vector_of(sample.force), vector_of(sample.torque)};
}

TEST(ForceTorque, is_the_weight_and_its_lever_of_what_hangs_on_the_joint) {
  SimulationFixture f(world_of_text(arm("fixed", "")));
  const Load load = load_after(f, 1);
  EXPECT_LT((load.force - Eigen::Vector3d(0, 0, -2 * g)).norm(), 0.01) << "of the child on the parent: " << load.force.transpose();
  EXPECT_LT((load.torque - Eigen::Vector3d(0, 0.5 * 2 * g, 0)).norm(), 0.01) << load.torque.transpose();
}

TEST(ForceTorque, obeys_direction_frame_and_pose) {
  {
    SimulationFixture other(
        world_of_text(arm("fixed", "<force_torque><measure_direction>parent_to_child</measure_direction></force_torque>")));
    const Load opposite = load_after(other, 1);
    EXPECT_LT((opposite.force - Eigen::Vector3d(0, 0, 2 * g)).norm(), 0.01);
    EXPECT_LT((opposite.torque - Eigen::Vector3d(0, -0.5 * 2 * g, 0)).norm(), 0.01);
  }
  const Eigen::AngleAxisd turned(0.4, Eigen::Vector3d::UnitY());
  const Eigen::Vector3d weight(0, 0, -2 * g), torque = (turned * Eigen::Vector3d(0.5, 0, 0)).cross(weight);
  const auto measured = [&](const std::string& frame) {
    SimulationFixture f(
        world_of_text(arm("fixed", "<pose>0 0 0 0 0 1</pose><force_torque><frame>" + frame + "</frame></force_torque>", "0 0 1 0 0.4 0")));
    return load_after(f, 1);
  };
  const Eigen::Matrix3d child = turned.toRotationMatrix(), parent = Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const Eigen::Matrix3d sensor = child * Eigen::AngleAxisd(1, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  for (const auto& [frame, axes] : {std::pair{"child", child}, std::pair{"parent", parent}, std::pair{"sensor", sensor}}) {
    const Load load = measured(frame);
    EXPECT_LT((load.force - axes.transpose() * weight).norm(), 0.01) << frame;
    EXPECT_LT((load.torque - axes.transpose() * torque).norm(), 0.01) << frame;
  }
  SimulationFixture shifted(world_of_text(arm("fixed", "<pose>0.5 0 0 0 0 0</pose>")));
  EXPECT_LT(load_after(shifted, 1).torque.norm(), 0.01) << "about the centre of mass there is no lever";
}

TEST(ForceTorque, of_a_turning_joint_is_the_pull_of_what_goes_round_and_the_torque_that_speeds_it_up) {
  SimulationFixture f(world_of_text("<gravity>0 0 0</gravity>" + arm("revolute", "", "0 0 1 0 0 0", "<axis><xyz>0 0 1</xyz></axis>")));
  auto& physics = f.simulation->physics();
  physics.set_motor({0, 1}, 0, 3, 6);
  const double inertia = 0.1 + 2 * 0.25;
  const Load start = load_after(f, 0.1);
  EXPECT_NEAR(start.torque.z(), -6, 0.01) << "the motor pushes itself off the parent";
  EXPECT_NEAR(physics.joint_state({0, 1}).velocity, 6 / inertia * 0.1, 0.01);
  const Load steady = load_after(f, 1);
  EXPECT_NEAR(steady.force.norm(), 2 * 0.5 * 9, 0.02) << "m r w^2";
  EXPECT_NEAR(steady.force.x(), 2 * 0.5 * 9, 0.05) << "outwards, in the child's frame";
}

TEST(Altimeter, tells_height_above_the_start_and_climb) {
  SimulationFixture f(
      world_of_text("<model name='m'><pose>1 2 100 0 0 0</pose><link name='l'><sensor name='alt' type='altimeter'/></link></model>"));
  auto iface = f.open(IfaceType::altimeter, "m::alt");
  f.run(2);
  ASSERT_TRUE(iface.read());
  const auto& s = iface.sample<shm::AltimeterSample>();
  EXPECT_NEAR(s.height, -g / 2 * 4, 0.02);
  EXPECT_NEAR(s.climb, -g * 2, 1e-6);
  EXPECT_NEAR(iface.info<shm::MeterInfo>().reference, 100, 1e-9);
  ASSERT_TRUE(f.simulation->physics().set_model_pose(0, at(0, 0, 120)));
  f.run(0.001);
  ASSERT_TRUE(iface.read());
  EXPECT_NEAR(iface.sample<shm::AltimeterSample>().height, 20, 0.001);
}

TEST(Altimeter, noise_has_the_statistics_that_the_file_says) {
  SimulationFixture f(world_of_text(
      "<gravity>0 0 0</gravity><model name='m'><link name='l'><sensor name='alt' "
      "type='altimeter'><update_rate>1000</update_rate><altimeter><vertical_position>"
      "<noise type='gaussian'><mean>0.5</mean><stddev>0.2</stddev></noise></vertical_position></altimeter></sensor></link></model>"));
  auto iface = f.open(IfaceType::altimeter, "m::alt");
  double sum = 0, squares = 0;
  constexpr int count = 4000;
  for (int i = 0; i < count; ++i) {
    f.run(0.001);
    ASSERT_TRUE(iface.read());
    const double h = iface.sample<shm::AltimeterSample>().height;
    EXPECT_EQ(iface.sample<shm::AltimeterSample>().climb, 0);
    sum += h, squares += h * h;
  }
  const double mean = sum / count;
  EXPECT_NEAR(mean, 0.5, 0.015);
  EXPECT_NEAR(std::sqrt(squares / count - mean * mean), 0.2, 0.01);
}

TEST(Magnetometer, sees_the_field_of_the_world_in_its_own_frame) {
  SimulationFixture f(
      world_of_text("<magnetic_field>2e-5 1e-6 -4e-5</magnetic_field><gravity>0 0 0</gravity><model name='m'><pose>0 0 0 0 0 "
                    "1.5707963267948966</pose><link name='l'>"
                    "<sensor name='compass' type='magnetometer'><pose>0 0 0 3.141592653589793 0 0</pose></sensor></link></model>"));
  auto iface = f.open(IfaceType::magnetometer, "m::compass");
  f.run(0.1);
  ASSERT_TRUE(iface.read());
  // Turned to the left: what pointed forward comes from the right; then upside down.
  EXPECT_LT((vector_of(iface.sample<shm::MagnetometerSample>().field) - Eigen::Vector3d(1e-6, 2e-5, 4e-5)).norm(), 1e-12);
}

TEST(AirPressure, is_that_of_the_standard_atmosphere) {
  EXPECT_NEAR(air_pressure_at(0, 288.15, 101325), 101325, 1e-6);
  EXPECT_NEAR(air_pressure_at(1000, 288.15, 101325), 89874.6, 1);
  EXPECT_NEAR(air_pressure_at(5000, 288.15, 101325), 54019.9, 1);
  SimulationFixture f(
      world_of_text("<gravity>0 0 "
                    "0</gravity><spherical_coordinates><surface_model>EARTH_WGS84</surface_model><latitude_deg>0</"
                    "latitude_deg><longitude_deg>0</longitude_deg>"
                    "<elevation>900</elevation><heading_deg>0</heading_deg></spherical_coordinates>"
                    "<model name='m'><pose>0 0 100 0 0 0</pose><link name='l'><sensor name='air' type='air_pressure'/><sensor name='set' "
                    "type='air_pressure'><air_pressure>"
                    "<reference_altitude>4900</reference_altitude></air_pressure></sensor></link></model>"));
  auto air = f.open(IfaceType::air_pressure, "m::air"), set = f.open(IfaceType::air_pressure, "m::set");
  f.run(0.1);
  ASSERT_TRUE(air.read());
  ASSERT_TRUE(set.read());
  EXPECT_NEAR(air.sample<shm::AirPressureSample>().pressure, 89874.6, 1) << "at the elevation of the world and 100 m more";
  EXPECT_NEAR(set.sample<shm::AirPressureSample>().pressure, 54019.9, 1);
}

}  // namespace
}  // namespace sim
