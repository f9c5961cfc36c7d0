// Drives on land beside differential ones and cars: mecanum and omni wheels, tricycles, tracks with flippers, belts, wheels that slip, and
// what publishers of gz-sim become. Numbers are those of the worked checks: a mecanum base goes 3.0 m sideways in 10 s.
#include <gtest/gtest.h>
#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <filesystem>

#include "shm/requests.h"
#include "support/land_robots.h"
#include "support/simulation_fixture.h"
#include "world/world_loader.h"

namespace sim {
namespace {

using namespace test;

struct LandRide {
  explicit LandRide(const std::string& content, const std::string& iface, int threads = 1, bool is_spotless = true)
      : f(world(content, is_spotless), 1, threads), drive(f.open(shm::IfaceType::position2d, iface)) {}
  static WorldDef world(const std::string& content, bool is_spotless) {
    const std::string text = "<sdf version='1.9'><world name='w'>" + floor_text() + content + "</world></sdf>";
    auto loaded = load_world_text(text, std::filesystem::temp_directory_path(), "land.sdf", ModelPath{});
    if (!loaded) throw std::runtime_error(loaded.error().message);
    for (const Finding& finding : loaded->findings) {
      if (is_spotless) ADD_FAILURE() << finding.text();
    }
    return std::move(loaded->world);
  }
  shm::Position2dSample after(double seconds) {
    f.run(seconds);
    EXPECT_TRUE(drive.read());
    return drive.sample<shm::Position2dSample>();
  }
  void command(double vx, double vy, double va) { ASSERT_TRUE(drive.command_velocity(vx, vy, va)); }
  std::uint64_t hash() {
    StateHash hash;
    f.simulation->physics().add_to(hash);
    for (const auto& device : f.simulation->devices()) device->add_to(hash);
    return hash.value();
  }
  SimulationFixture f;
  shm::Iface drive;
};

const shm::JointState& joint_of(const shm::Iface& iface, std::size_t place) {
  return reinterpret_cast<const shm::JointState*>(iface.sample_followers(0))[place];
}

double turned(const shm::Position2dSample& sample) { return shm::yaw_of(sample.true_pose); }

TEST(MecanumDrive, goes_three_metres_sideways_in_ten_seconds_without_turning) {
  LandRide ride(mecanum_text(), "base::position2d");
  const auto& info = ride.drive.info<shm::Position2dInfo>();
  EXPECT_EQ(info.drive, RTMSIM_DRIVE_HOLONOMIC);
  ride.after(0.5);
  ride.command(0, 0.3, 0);
  const auto end = ride.after(10);
  EXPECT_NEAR(end.true_pose.y, 3.0, 0.06);
  EXPECT_NEAR(end.true_pose.x, 0, 0.06);
  EXPECT_LT(std::abs(turned(end)), M_PI / 180);
  EXPECT_NEAR(end.odometry[1], 3.0, 0.03);
  EXPECT_NEAR(end.velocity[1], 0.3, 0.003);
  EXPECT_NEAR(end.command[1], 0.3, 1e-9);
  ride.command(0, 0, 0);
  EXPECT_NEAR(ride.after(1).true_velocity[1], 0, 1e-3);
}

TEST(MecanumDrive, turns_its_wheels_as_the_worked_check_says) {
  // vx = 0.5, vy = 0.3, w = 0.2 with a lever of 0.45 m and wheels of 0.1 m.
  LandRide ride(mecanum_text(0.5, 0.4), "base::position2d");
  ride.command(0.5, 0.3, 0.2);
  ride.after(1);
  const Physics& physics = ride.f.simulation->physics();
  const ModelId model = physics.find("base").value();
  const auto rate = [&](const char* name) {
    const ModelDef& def = physics.def(model);
    for (std::uint32_t j = 0; j < def.joints.size(); ++j) {
      if (def.joints[j].name == name) return physics.joint_state({model, j}).velocity;
    }
    return 0.0;
  };
  EXPECT_NEAR(rate("front_left_joint"), 1.1, 0.02);
  EXPECT_NEAR(rate("front_right_joint"), 8.9, 0.02);
  EXPECT_NEAR(rate("back_left_joint"), 7.1, 0.02);
  EXPECT_NEAR(rate("back_right_joint"), 2.9, 0.02);
}

TEST(MecanumDrive, goes_askew_and_turns_as_far_as_it_is_told_wherever_it_looks) {
  for (const double yaw : {0.0, 0.7, M_PI / 2}) {
    LandRide ride(mecanum_text(0.5, 0.4, "", yaw), "base::position2d");
    ride.after(0.5);
    ride.command(0.2, 0.2, 0);
    auto end = ride.after(5);
    const double c = std::cos(yaw), s = std::sin(yaw);
    EXPECT_NEAR(c * end.true_pose.x + s * end.true_pose.y, 1.0, 0.03) << yaw;
    EXPECT_NEAR(c * end.true_pose.y - s * end.true_pose.x, 1.0, 0.03) << yaw;
    ride.command(0, 0, 0.5);
    end = ride.after(4);
    EXPECT_NEAR(std::remainder(turned(end) - yaw - 2.0, 2 * M_PI), 0, 0.06) << yaw;
    EXPECT_NEAR(std::remainder(end.odometry[2] - 2.0, 2 * M_PI), 0, 0.03) << yaw;
  }
}

TEST(MecanumDrive, keeps_to_its_limits_and_to_its_line) {
  LandRide ride(mecanum_text(0.5, 0.4, "<max_velocity>0.5</max_velocity><max_acceleration>0.25</max_acceleration>"), "base::position2d");
  ride.command(3, 4, 0);
  auto end = ride.after(1);
  EXPECT_NEAR(std::hypot(end.command[0], end.command[1]), 0.25, 0.01);
  end = ride.after(2);
  EXPECT_NEAR(end.command[0], 0.3, 1e-6);
  EXPECT_NEAR(end.command[1], 0.4, 1e-6);
}

TEST(MecanumDrive, without_its_wheels_is_one_line) {
  SimulationFixture f(
      LandRide::world("<model name='m'><link name='l'/><plugin filename='gz-sim-mecanum-drive-system' name='drive'/></model>", true));
  ASSERT_EQ(f.dropped.size(), 1U);
  EXPECT_NE(f.dropped[0].find("needs four wheels"), std::string::npos) << f.dropped[0];
}

TEST(FrictionFrame, of_a_frame_turns_with_the_link_that_carries_it_and_one_that_is_missing_is_one_line) {
  std::string text = mecanum_text();
  for (std::size_t at; (at = text.find("expressed_in='chassis'")) != std::string::npos;) text.replace(at, 22, "expressed_in='middle_'");
  const std::string frame = "<frame name='middle_' attached_to='chassis'><pose>0 0 0 0 0 1.5707963</pose></frame>";
  const auto whole =
      load_world_text("<sdf version='1.9'><world name='w'>" + floor_text() + text + "</world></sdf>", {}, "w.sdf", ModelPath{});
  ASSERT_TRUE(whole.ok());
  EXPECT_EQ(whole->findings.size(), 4U) << "one for each wheel";
  EXPECT_NE(whole->findings[0].text().find("\"middle_\""), std::string::npos) << whole->findings[0].text();
  text.insert(text.find("<link"), frame);
  const auto turned =
      load_world_text("<sdf version='1.9'><world name='w'>" + floor_text() + text + "</world></sdf>", {}, "w.sdf", ModelPath{});
  ASSERT_TRUE(turned.ok());
  EXPECT_TRUE(turned->findings.empty());
  const SurfaceDef& surface = turned->world.models.back().link("front_left_wheel")->collisions[0].surface;
  EXPECT_EQ(surface.friction_link, "chassis");
  EXPECT_NEAR((*surface.friction_direction - Eigen::Vector3d(M_SQRT1_2, M_SQRT1_2, 0)).norm(), 0, 1e-6) << "1 -1 0 turned by 90 degrees";
}

TEST(OmniDrive, of_three_wheels_goes_everywhere_and_turns) {
  LandRide ride(omni_text(), "omni::position2d");
  EXPECT_EQ(ride.drive.info<shm::Position2dInfo>().drive, RTMSIM_DRIVE_HOLONOMIC);
  ride.after(0.5);
  ride.command(0.1, -0.2, 0);
  auto end = ride.after(5);
  EXPECT_NEAR(end.true_pose.x, 0.5, 0.03);
  EXPECT_NEAR(end.true_pose.y, -1.0, 0.03);
  EXPECT_NEAR(turned(end), 0, 0.02);
  EXPECT_NEAR(end.odometry[0], 0.5, 0.015);
  EXPECT_NEAR(end.odometry[1], -1.0, 0.015);
  ride.command(0, 0, 0.5);
  end = ride.after(4);
  EXPECT_NEAR(turned(end), 2.0, 0.06);
}

TEST(OmniDrive, whose_wheels_all_roll_one_way_is_one_line) {
  std::string text = omni_text();
  text.replace(text.find("<wheel_joint>wheel_2_joint"), 26, "<wheel_joint>wheel_1_joint");
  SimulationFixture f(LandRide::world(text, false));
  ASSERT_EQ(f.dropped.size(), 1U);
  EXPECT_NE(f.dropped[0].find("needs three wheels"), std::string::npos) << f.dropped[0];
}

TEST(TricycleDrive, drives_curves_and_turns_almost_on_the_spot) {
  LandRide ride(tricycle_text(), "trike::drive");
  const auto& info = ride.drive.info<shm::Position2dInfo>();
  EXPECT_EQ(info.drive, RTMSIM_DRIVE_CAR);
  EXPECT_NEAR(info.wheel_base, 0.6, 1e-6);
  EXPECT_NEAR(info.wheel_separation, 0.5, 1e-6);
  ride.after(0.5);
  ride.command(0.5, 0, 0.25);
  ride.after(2);
  const auto begin = ride.after(0.001), end = ride.after(4);
  EXPECT_NEAR(end.true_velocity[0], 0.5, 0.015);
  EXPECT_NEAR(std::remainder(turned(end) - turned(begin) - 1.0, 2 * M_PI), 0, 0.03);
  EXPECT_NEAR(std::remainder(end.odometry[2] - begin.odometry[2] - 1.0, 2 * M_PI), 0, 0.03);
  ride.command(0, 0, 0.5);
  ride.after(2);
  const auto spot = ride.after(0.001), later = ride.after(2);
  EXPECT_NEAR(later.true_velocity[2], 0.5, 0.03);
  EXPECT_LT(std::hypot(later.true_pose.x - spot.true_pose.x, later.true_pose.y - spot.true_pose.y), 0.12);
}

TEST(TricycleDrive, odometry_is_what_its_wheels_in_the_rear_have_rolled) {
  LandRide ride(tricycle_text(), "trike::drive");
  ride.after(0.5);
  const auto begin = ride.after(0.001);
  ride.command(1, 0, 0);  // at once: the driven wheel spins
  const auto end = ride.after(1);
  EXPECT_NEAR(end.odometry[0] - begin.odometry[0], end.true_pose.x - begin.true_pose.x, 0.01);
}

TEST(CarCommand, of_0_3_rad_at_1_m_s_turns_with_0_309_rad_s_at_a_radius_of_3_233_m) {
  LandRide ride(car_text(), "car::position2d");
  const auto& info = ride.drive.info<shm::Position2dInfo>();
  EXPECT_NEAR(info.wheel_base, 1.0, 1e-9);
  EXPECT_NEAR(info.max_steering_angle, 0.5, 1e-9);
  const double order[] = {1, 0.3};
  ASSERT_TRUE(ride.drive.command(shm::CommandKind::car, order));
  ride.after(8);  // its steering comes slowly
  const auto end = ride.after(4);
  EXPECT_NEAR(end.true_velocity[2], 0.309, 0.0062);
  EXPECT_NEAR(end.true_velocity[0] / end.true_velocity[2], 3.233, 0.065);
  EXPECT_NEAR(end.velocity[2], 0.309, 0.004);
}

TEST(CarCommand, steers_a_car_that_stands_and_is_nothing_to_a_drive_without_steering) {
  LandRide car(car_text(), "car::position2d");
  const double order[] = {0, 0.3};
  ASSERT_TRUE(car.drive.command(shm::CommandKind::car, order));
  const auto end = car.after(8);
  EXPECT_NEAR(end.true_pose.x, 0, 0.02);
  const Physics& physics = car.f.simulation->physics();
  const ModelId model = physics.find("car").value();
  double sum = 0;
  for (std::uint32_t j = 0; j < physics.def(model).joints.size(); ++j) {
    if (physics.def(model).joints[j].name.ends_with("_steering")) sum += physics.joint_state({model, j}).position;
  }
  EXPECT_NEAR(sum / 2, 0.3, 0.02);
  LandRide base(mecanum_text(), "base::position2d");
  base.command(0.3, 0, 0);
  base.after(1);
  ASSERT_TRUE(base.drive.command(shm::CommandKind::car, order));
  EXPECT_NEAR(base.after(1).true_velocity[0], 0, 1e-3) << "it stands";
}

TEST(TrackedVehicle, drives_and_turns_as_it_is_told) {
  LandRide ride(tracked_text(), "tank::position2d");
  EXPECT_EQ(ride.drive.info<shm::Position2dInfo>().drive, RTMSIM_DRIVE_SKID);
  ride.after(0.5);
  ride.command(0.3, 0, 0);
  auto end = ride.after(5);
  EXPECT_NEAR(end.true_pose.x, 1.5, 0.045);
  EXPECT_NEAR(end.true_pose.y, 0, 0.02);
  EXPECT_NEAR(end.odometry[0], 1.5, 0.01);
  ride.command(0, 0, 0.4);
  end = ride.after(5);
  EXPECT_NEAR(turned(end), 2.0, 0.06);
  EXPECT_NEAR(end.odometry[2], 2.0, 0.01);
}

TEST(TrackedVehicle, climbs_a_step_of_two_thirds_of_its_rolls_and_raises_a_flipper) {
  const std::string step =
      "<model name='step'><static>true</static><pose>2 0 0.03 0 0 0</pose><link name='l'><collision name='c'><geometry><box><size>2 2 0.06"
      "</size></box></geometry></collision></link></model>";
  LandRide ride(step + tracked_text(true), "tank::position2d");
  ride.after(0.5);
  ride.command(0.3, 0, 0);
  const auto end = ride.after(7);
  EXPECT_GT(end.true_pose.x, 1.4) << "it is on the step";
  EXPECT_GT(end.true_pose.z, 0.055);
  ride.command(0, 0, 0);
  auto joints = ride.f.open(shm::IfaceType::joints, "tank::joints");
  const double up[] = {RTMSIM_JOINT_POSITION, -1.0, 0, 0};
  ASSERT_TRUE(joints.command(shm::CommandKind::joints, up));
  ride.after(2);
  ASSERT_TRUE(joints.read());
  EXPECT_NEAR(joint_of(joints, 0).position, -1.0, 0.02);
  // The solver along the tree of joints knows belts as well.
  const double x = ride.after(0.001).true_pose.x;
  ASSERT_EQ(ride.f.simulation->physics().last_solver(ride.f.simulation->physics().find("tank").value()), StepSolver::tree);
  ride.command(0.2, 0, 0);
  EXPECT_NEAR(ride.after(3).true_pose.x - x, 0.6, 0.02);
}

TEST(TrackedVehicle, of_gazebo_classic_names_its_links_without_an_element) {
  std::string text = tracked_text();
  const std::size_t begin = text.find("<plugin"), end = text.rfind("</plugin>") + 9;
  text.replace(begin, end - begin,
               "<plugin filename='libSimpleTrackedVehiclePlugin.so' name='drive'><body>body</body><left_track>left_track</left_track>"
               "<right_track>right_track</right_track><tracks_separation>0.4</tracks_separation><max_linear_speed>0.2</max_linear_speed>"
               "</plugin>");
  LandRide ride(text, "tank::drive");
  ride.command(1, 0, 0);
  EXPECT_NEAR(ride.after(3).true_velocity[0], 0.2, 0.006);
}

TEST(TrackController, alone_carries_what_lies_on_its_belt_and_stops) {
  const std::string belt =
      "<model name='conveyor'><static>true</static><link name='belt'><pose>0 0 0.25 0 0 0</pose><collision name='c'><geometry><box><size>4 "
      "0.5 0.5"
      "</size></box></geometry></collision></link><plugin filename='gz-sim-track-controller-system' "
      "name='gz::sim::systems::TrackController'><link>belt</link><max_velocity>0.5</max_velocity></plugin></model>"
      "<model name='parcel'><pose>-1.5 0 0.6 0 0 0</pose><link name='l'><inertial><mass>1</mass><inertia><ixx>0.007</ixx><iyy>0.007</iyy>"
      "<izz>0.007</izz></inertia></inertial><collision name='c'><geometry><box><size>0.2 0.2 0.2</size></box></geometry></collision></link>"
      "</model>";
  LandRide ride(belt, "conveyor::position2d");
  const auto parcel = [&]() -> Eigen::Vector3d {
    return ride.f.simulation->physics().model_pose(ride.f.simulation->physics().find("parcel").value()).translation();
  };
  ride.after(2);
  EXPECT_NEAR(parcel().x(), -1.5, 1e-3);
  ride.command(0.4, 0, 0);
  const auto running = ride.after(4);
  EXPECT_NEAR(parcel().x(), 0.1, 0.05);
  EXPECT_EQ(running.stalled, 0U);
  EXPECT_NEAR(running.odometry[0], 1.6, 1e-3);
  ride.command(0, 0, 0);
  ride.after(1);
  const double x = parcel().x();
  ride.after(2);
  EXPECT_NEAR(parcel().x(), x, 1e-4);
}

// gz-sim's law: the rim moves against the floor by compliance * rim speed / normal force for each newton.
TEST(WheelSlip, of_its_wheels_slows_a_robot_that_pulls) {
  const auto speed = [](const std::string& slip) {
    LandRide ride(cart_text(slip), "cart::drive");
    ride.command(0.5, 0, 0);
    const ModelId model = ride.f.simulation->physics().find("cart").value();
    for (int i = 0; i < 3000; ++i) {
      static_cast<void>(ride.f.simulation->physics().add_wrench(ride.f.simulation->physics().canonical_link(model), {-4, 0, 0}, {0, 0, 0}));
      ride.f.simulation->step(ride.f.times);
    }
    const LinkId link = ride.f.simulation->physics().canonical_link(model);
    return ride.f.simulation->physics().link_twist(link).linear.x();
  };
  EXPECT_NEAR(speed(""), 0.5, 0.01);
  const std::string wheel =
      "<slip_compliance_lateral>1</slip_compliance_lateral><slip_compliance_longitudinal>1</slip_compliance_longitudinal>"
      "<wheel_normal_force>20</wheel_normal_force><wheel_radius>0.1</wheel_radius></wheel>";
  // Two wheels share 4 N: each slips by 0.5 / 20 * 2 = 0.05 m/s.
  EXPECT_NEAR(speed("<plugin filename='gz-sim-wheel-slip-system' name='gz::sim::systems::WheelSlip'><wheel link_name='left'>" + wheel +
                    "<wheel link_name='right'>" + wheel + "</plugin>"),
              0.45, 0.01);
}

TEST(Publishers, are_ifaces_of_the_true_pose_and_of_joints_that_nobody_commands) {
  const std::string publishers =
      "<plugin filename='gz-sim-odometry-publisher-system' name='gz::sim::systems::OdometryPublisher'><odom_publish_frequency>100"
      "</odom_publish_frequency><xyz_offset>0.1 0 0</xyz_offset></plugin>"
      "<plugin filename='gz-sim-joint-state-publisher-system' name='gz::sim::systems::JointStatePublisher'/>"
      "<plugin filename='gz-sim-pose-publisher-system' name='gz::sim::systems::PosePublisher'/>";
  LandRide ride(cart_text(publishers), "cart::drive");
  auto odometry = ride.f.open(shm::IfaceType::truth, "cart::odometry");
  auto states = ride.f.open(shm::IfaceType::joints, "cart::joint_states");
  ride.command(0.5, 0, 0);
  const auto end = ride.after(2);
  ASSERT_TRUE(odometry.read());
  EXPECT_NEAR(odometry.sample<shm::TruthSample>().pose.x, end.true_pose.x + 0.1, 1e-3);
  EXPECT_EQ(odometry.sample<shm::TruthSample>().pose.z, 0);
  ASSERT_TRUE(states.read());
  ASSERT_EQ(states.count(), 2U);
  EXPECT_NEAR(joint_of(states, 0).velocity, 5, 0.05);
  EXPECT_NEAR(joint_of(states, 0).position, std::remainder(end.odometry[0] / 0.1, 2 * M_PI), 0.02);
  const double order[] = {RTMSIM_JOINT_POSITION, 1, 0, 0};
  EXPECT_FALSE(states.command(shm::CommandKind::joints, order)) << "it takes none";
}

struct Kind {
  const char* iface;
  std::string text;
};
std::vector<Kind> land_kinds() {
  return {{"base::position2d", mecanum_text()},     {"omni::position2d", omni_text()}, {"trike::drive", tricycle_text()},
          {"tank::position2d", tracked_text(true)}, {"car::position2d", car_text()},   {"cart::drive", cart_text()}};
}

// gz-sim's <max_velocity> and <min_velocity> are of speed [m/s] and turn [rad/s]; <min_linear_velocity> is of one.
TEST(DiffDrive, of_gz_sim_keeps_to_limits_that_mean_speed_and_turn) {
  std::string cart = cart_text();
  cart.replace(cart.find("libgazebo_ros_diff_drive.so"), 27, "gz-sim-diff-drive-system");
  const auto ride_with = [&](const std::string& limits, double vx, double va) {
    std::string text = cart;
    text.insert(text.find("</plugin>"), limits);
    LandRide ride(text, "cart::drive");
    ride.command(vx, 0, va);
    const auto end = ride.after(3);
    return std::pair(end.command[0], end.command[2]);
  };
  const std::string both = "<max_velocity>0.5</max_velocity><min_velocity>-0.2</min_velocity>";
  EXPECT_EQ(ride_with(both, 9, 0).first, 0.5);
  EXPECT_EQ(ride_with(both, -9, 0).first, -0.2);
  EXPECT_NEAR(ride_with(both, 0, 9).second, 0.5, 1e-9);
  EXPECT_NEAR(ride_with(both, 0, -9).second, -0.2, 1e-9);
  EXPECT_EQ(ride_with("<max_linear_velocity>0.5</max_linear_velocity><min_linear_velocity>-0.1</min_linear_velocity>", -9, 0).first, -0.1);
  EXPECT_EQ(ride_with("<max_linear_velocity>0.5</max_linear_velocity>", -9, 0).first, -0.5);
}

// Public complaints: half a metre in five minutes. They stay awake here, as a robot with a moving arm does.
TEST(LandDrives, that_are_told_to_stand_do_not_drift_in_five_minutes) {
  for (const Kind& kind : land_kinds()) {
    std::string text = kind.text;
    text.insert(text.find("<link"), "<allow_auto_disable>false</allow_auto_disable>");
    text = "<physics type='ode'><max_step_size>0.004</max_step_size></physics>" + text;
    LandRide ride(text, kind.iface);
    ride.command(0.2, 0, 0.1);
    ride.after(1);
    ride.command(0, 0, 0);
    const auto begin = ride.after(2), end = ride.after(300);
    EXPECT_LT(std::hypot(end.true_pose.x - begin.true_pose.x, end.true_pose.y - begin.true_pose.y), 1e-4) << kind.iface;
    EXPECT_NEAR(turned(end), turned(begin), 1e-4) << kind.iface;
    EXPECT_NEAR(end.odometry[0], begin.odometry[0], 1e-4) << kind.iface;
  }
}

TEST(LandDrives, stand_on_a_slope_and_roll_down_it_without_motors) {
  for (const Kind& kind : land_kinds()) {
    LandRide ride("<gravity>0.98 0 -9.75</gravity>" + kind.text, kind.iface);
    ride.command(0, 0, 0);
    const auto begin = ride.after(1), end = ride.after(10);
    EXPECT_LT(std::hypot(end.true_pose.x - begin.true_pose.x, end.true_pose.y - begin.true_pose.y), 2e-3) << kind.iface;
    for (const auto& device : ride.f.simulation->devices()) {
      if (device->iface().type() == shm::IfaceType::position2d) device->set_motors(false);
    }
    EXPECT_GT(ride.after(2).true_velocity[0], 0.5) << kind.iface;
  }
}

TEST(LandDrives, that_are_weak_go_a_part_of_the_way_and_halted_ones_go_on_as_they_were_told) {
  for (const Kind& kind : land_kinds()) {
    LandRide ride(kind.text, kind.iface);
    FaultOrder fault;
    fault.iface = kind.iface;
    const auto until = [&](shm::FaultKind what, int seconds) {
      fault.kind = what, fault.amount = 0.5, fault.until = std::chrono::seconds(seconds);
      ASSERT_TRUE(ride.f.simulation->add_fault(fault));
    };
    const auto speed = [](const shm::Position2dSample& sample) { return sample.true_velocity[0]; };
    ride.command(0.4, 0, 0);
    const double whole = speed(ride.after(2));
    EXPECT_NEAR(whole, 0.4, 0.02) << kind.iface;
    until(shm::FaultKind::weak, 4);
    EXPECT_NEAR(speed(ride.after(1.9)), 0.5 * whole, 0.01) << kind.iface;
    EXPECT_NEAR(speed(ride.after(2.1)), whole, 0.01) << kind.iface;
    until(shm::FaultKind::halted, 9);
    ride.after(0.1);
    ride.command(0, 0, 0);
    EXPECT_NEAR(speed(ride.after(2)), whole, 0.01) << kind.iface;
    EXPECT_NEAR(speed(ride.after(3)), 0, 2e-3) << kind.iface << " hears again";
  }
}

TEST(LandDrives, run_the_same_with_one_and_two_threads_and_after_a_reset) {
  for (const Kind& kind : land_kinds()) {
    std::vector<std::uint64_t> hashes;
    for (const int threads : {1, 2}) {
      LandRide ride(kind.text, kind.iface, threads);
      for (int run = 0; run < 2; ++run) {
        ride.command(0.3, 0.1, 0.2);
        ride.after(2);
        hashes.push_back(ride.hash());
        std::vector<std::string> notes;
        ASSERT_TRUE(ride.f.simulation->reset(notes));
      }
    }
    EXPECT_EQ(std::count(hashes.begin(), hashes.end(), hashes[0]), 4) << kind.iface;
  }
}

}  // namespace
}  // namespace sim
