// Impossible numbers and names in every plugin that drives or pushes: one line each, nothing that is no number, and no crash.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "support/land_robots.h"
#include "support/simulation_fixture.h"
#include "support/vehicles.h"
#include "world/world_loader.h"

namespace sim {
namespace {

using namespace test;
using shm::IfaceType;

// What an element must be. A size is that of a wheel.
enum class Must { size, positive, not_negative, number };
using enum Must;

constexpr std::array values{"nan", "inf", "-1", "0", "1e-9", "1e9"};

bool is_nonsense(Must must, std::string_view value) {
  if (must == size || value == "nan") return true;
  if (value == "inf") return must != not_negative;
  if (value == "-1") return must != number;
  return value == "0" && must == positive;
}

struct Element {
  const char* name;
  Must must;
};
struct Plugin {
  const char* name;
  std::string model;  // with the plugin last, or with the element in the one that is meant
  std::vector<Element> elements;
};

std::string with_plugin(const std::string& file, const std::string& content) {
  return "<model name='m'><link name='a'><inertial><mass>2</mass><inertia><ixx>0.1</ixx><iyy>0.1</iyy><izz>0.1</izz></inertia></inertial>"
         "</link><link "
         "name='b'><inertial><mass>0.5</mass><inertia><ixx>0.01</ixx><iyy>0.01</iyy><izz>0.01</izz></inertia></inertial></link>"
         "<joint name='j' type='revolute'><parent>a</parent><child>b</child><axis><xyz>1 0 0</xyz></axis></joint>"
         "<plugin filename='gz-sim-" +
         file + "-system' name='p'>" + content + "</plugin></model>";
}

const std::vector<Plugin>& plugins() {
  static const std::vector<Plugin> all{
      {"DiffDrive",
       cart_text(),
       {{"wheel_separation", size},
        {"wheel_diameter", size},
        {"wheel_radius", size},
        {"max_wheel_torque", positive},
        {"max_linear_velocity", not_negative},
        {"max_angular_velocity", not_negative},
        {"max_linear_acceleration", not_negative},
        {"max_angular_acceleration", not_negative},
        {"odom_publish_frequency", not_negative}}},
      {"AckermannSteering",
       car_text(),
       {{"wheel_radius", size},
        {"steering_limit", positive},
        {"steer_p_gain", positive},
        {"max_velocity", not_negative},
        {"max_acceleration", not_negative}}},
      {"MecanumDrive",
       mecanum_text(),
       {{"wheelbase", size},
        {"wheel_separation", size},
        {"wheel_radius", size},
        {"max_velocity", not_negative},
        {"max_acceleration", not_negative}}},
      {"OmniDrive", omni_text(), {{"wheel_radius", size}, {"max_velocity", not_negative}}},
      {"tricycle", tricycle_text(), {{"actuatedWheelDiameter", size}, {"encoderWheelDiameter", size}, {"wheelTorque", positive}}},
      {"TrackedVehicle", tracked_text(), {{"tracks_separation", size}, {"steering_efficiency", positive}}},
      {"VelocityControl", with_plugin("velocity-control", ""), {{"max_speed", not_negative}, {"max_acceleration", not_negative}}},
      {"Thruster",
       with_plugin("thruster",
                   "<joint_name>j</joint_name><thrust_coefficient>0.004</thrust_coefficient><propeller_diameter>0.2</propeller_diameter>"),
       {{"thrust_coefficient", number},
        {"propeller_diameter", positive},
        {"fluid_density", positive},
        {"max_thrust_cmd", number},
        {"deadband", not_negative},
        {"p_gain", not_negative},
        {"i_gain", not_negative},
        {"d_gain", not_negative},
        {"wake_fraction", number}}},
      {"MulticopterMotorModel",
       quadcopter("m", "0 0 5 0 0 0", false),
       {{"motorConstant", positive},
        {"momentConstant", not_negative},
        {"rotorDragCoefficient", not_negative},
        {"rollingMomentCoefficient", not_negative},
        {"timeConstantUp", not_negative},
        {"timeConstantDown", not_negative},
        {"rotorVelocitySlowdownSim", positive},
        {"maxRotVelocity", positive}}},
      {"LiftDrag",
       with_plugin("lift-drag", "<link_name>a</link_name>"),
       {{"a0", number}, {"alpha_stall", number}, {"cla", number}, {"cda", number}, {"area", positive}, {"air_density", positive}}},
      {"AdvancedLiftDrag",
       with_plugin("advanced-lift-drag", "<link_name>a</link_name><AR>6</AR><eff>1</eff>"),
       {{"AR", positive},
        {"eff", positive},
        {"CL0", number},
        {"CLa", number},
        {"CD0", number},
        {"Cema", number},
        {"Cellp", number},
        {"Cenr", number},
        {"CYb", number},
        {"Cema_stall", number},
        {"num_ctrl_surfaces", not_negative},
        {"area", positive},
        {"mac", not_negative},
        {"air_density", positive},
        {"alpha_stall", positive}}},
      {"LighterThanAirDynamics",
       with_plugin("lighter_than_air_dynamics",
                   "<link_name>a</link_name><force_inviscid_coeff>3</force_inviscid_coeff><force_viscous_coeff>2</force_viscous_coeff>"
                   "<moment_inviscid_coeff>8</moment_inviscid_coeff><moment_viscous_coeff>-1</moment_viscous_coeff><eps_v>1</eps_v>"
                   "<axial_drag_coeff>0.3</axial_drag_coeff>"),
       {{"air_density", positive}, {"axial_drag_coeff", not_negative}}},
      {"Hydrodynamics",
       with_plugin("hydrodynamics", "<link_name>a</link_name>"),
       {{"xU", number}, {"zWabsW", number}, {"xDotU", number}, {"nRabsR", number}, {"kP", number}}},
      {"BuoyancyEngine",
       with_plugin("buoyancy-engine", "<link_name>a</link_name>"),
       {{"fluid_density", positive},
        {"max_inflation_rate", positive},
        {"surface", number},
        {"min_volume", not_negative},
        {"max_volume", not_negative},
        {"default_volume", not_negative},
        {"neutral_volume", not_negative}}},
      {"Surface",
       with_plugin(
           "surface",
           "<link_name>a</link_name><hull_length>4</hull_length><hull_radius>0.2</hull_radius><points><point>0 0 0</point></points>"),
       {{"hull_length", positive}, {"hull_radius", positive}, {"fluid_level", number}, {"fluid_density", positive}}},
      {"JointController", with_plugin("joint-controller", "<joint_name>j</joint_name>"), {{"initial_velocity", number}}},
      {"JointPositionController",
       with_plugin("joint-position-controller", "<joint_name>j</joint_name>"),
       {{"p_gain", not_negative}, {"i_gain", not_negative}, {"d_gain", not_negative}, {"initial_position", number}, {"cmd_max", number}}},
  };
  return all;
}

// With this value of the element: that of the first that there is, else in the last plugin.
std::string changed(std::string text, const std::string& element, const std::string& value) {
  const std::string open = "<" + element + ">", close = "</" + element + ">";
  if (const auto at = text.find(open); at != std::string::npos) {
    const auto from = at + open.size();
    return text.replace(from, text.find(close, from) - from, value);
  }
  return text.insert(text.rfind("</plugin>"), open + value + close);
}

struct Tried {
  std::vector<std::string> lines;  // of what was written
  bool is_finite = true;
};

void command(SimulationFixture& f, const std::string& model) {
  for (const auto& [type, name] : {std::pair{IfaceType::position2d, "::position2d"},
                                   {IfaceType::position2d, "::drive"},
                                   {IfaceType::position3d, "::position3d"},
                                   {IfaceType::position3d, "::buoyancy_engine"}}) {
    if (f.simulation->device(model + name) == nullptr) continue;
    const std::array<double, 6> in_space{0.5, 0, 0.2, 0, 0, 0.3};
    const std::array<double, 3> on_ground{0.5, 0, 0.3};
    auto iface = f.open(type, model + name);
    if (type == IfaceType::position3d) {
      EXPECT_TRUE(iface.command(shm::CommandKind::velocity, in_space));
    } else {
      EXPECT_TRUE(iface.command(shm::CommandKind::velocity, on_ground));
    }
    f.run(0.02);
  }
}

Tried try_out(const std::string& model) {
  auto loaded = load_world_text("<sdf version='1.9'><world name='w'><gravity>0 0 -9.81</gravity>" + floor_text() + model + "</world></sdf>",
                                {}, "w.sdf", ModelPath{});
  if (!loaded) throw std::runtime_error(loaded.error().message);
  Tried tried;
  for (const Finding& finding : loaded->findings) {
    if (finding.message.find("is not commanded") == std::string::npos) tried.lines.push_back(finding.text());
  }
  const std::string name = loaded->world.models.at(1).name;
  SimulationFixture f(std::move(loaded->world));
  tried.lines.insert(tried.lines.end(), f.dropped.begin(), f.dropped.end());
  tried.lines.insert(tried.lines.end(), f.notes.begin(), f.notes.end());
  command(f, name);
  f.run(0.02);
  const Physics& physics = f.simulation->physics();
  for (std::uint32_t link = 0; link < physics.def(1).links.size(); ++link)
    tried.is_finite = tried.is_finite && physics.link_pose({1, link}).matrix().allFinite();
  return tried;
}

TEST(Nonsense, every_number_of_every_plugin_has_one_line_and_stays_a_number) {
  testing::internal::CaptureStderr();
  std::string problems;
  for (const Plugin& plugin : plugins()) {
    EXPECT_THAT(try_out(plugin.model).lines, testing::IsEmpty()) << plugin.name;
    for (const Element& element : plugin.elements) {
      for (const std::string value : values) {
        const Tried tried = try_out(changed(plugin.model, element.name, value));
        const std::string what = std::string(plugin.name) + " <" + element.name + "> " + value + ": ";
        if (!tried.is_finite) problems += what + "a pose is no number\n";
        const auto count = tried.lines.size();
        if (is_nonsense(element.must, value) ? count != 1 : count > 1) problems += what + std::to_string(count) + " lines\n";
        for (const std::string& line : tried.lines) {
          if (count > 1) problems += "    " + line + "\n";
        }
      }
    }
  }
  (void)testing::internal::GetCapturedStderr();
  EXPECT_EQ(problems, "");
}

TEST(Nonsense, a_wheel_of_no_size_names_model_plugin_value_and_what_happens) {
  const Tried tried = try_out(changed(cart_text(), "wheel_radius", "1e-9"));
  ASSERT_EQ(tried.lines.size(), 1U);
  EXPECT_THAT(tried.lines[0],
              testing::HasSubstr("plugin \"drive\" of model \"cart\": the wheel radius must be from 0.001 to 1000 m, got 1e-09; "
                                 "the plugin is left out"));
}

TEST(Nonsense, a_name_that_is_not_there_or_comes_twice_has_one_line) {
  testing::internal::CaptureStderr();
  std::string problems;
  const auto expect_one = [&](const char* plugin, const std::string& what, const std::string& model) {
    const auto lines = try_out(model).lines;
    if (lines.size() != 1) problems += std::string(plugin) + " " + what + ": " + std::to_string(lines.size()) + " lines\n";
    for (const std::string& line : lines) {
      if (lines.size() > 1) problems += "    " + line + "\n";
    }
  };
  constexpr std::array names{"left_joint", "left_steering_joint", "front_left_joint", "wheel_joint", "steeringJoint",
                             "joint_name", "jointName",           "link_name",        "body_link"};
  for (const Plugin& plugin : plugins()) {
    for (const std::string name : names) {
      const std::string open = "<" + name + ">", close = "</" + name + ">";
      const auto at = plugin.model.find(open);
      if (at == std::string::npos) continue;
      expect_one(plugin.name, name + " unknown", changed(plugin.model, name, "nobody"));
      if (name == "body_link") continue;
      const auto end = plugin.model.find(close, at) + close.size();
      std::string doubled = plugin.model;
      expect_one(plugin.name, name + " twice", doubled.insert(end, plugin.model.substr(at, end - at)));
    }
  }
  (void)testing::internal::GetCapturedStderr();
  EXPECT_EQ(problems, "");
}

// What other simulators of water do that nothing here does: each plugin has one line with its name, whatever is in it.
TEST(Undriven, plugins_of_uuv_simulator_and_vrx_have_one_line_that_names_them) {
  const std::string hydrodynamics =
      "<fluid_density>1028</fluid_density><link name='a'><neutrally_buoyant>0</neutrally_buoyant><volume>0.1</volume>"
      "<hydrodynamic_model><type>fossen</type><added_mass>1 0 0 0 0 0</added_mass><linear_damping>-7 -7 -7 -1 -1 -1</linear_damping>"
      "</hydrodynamic_model></link>";
  const std::string thruster =
      "<thruster><linkName>b</linkName><jointName>j</jointName><topicName>cmd</topicName><maxForceFwd>250</maxForceFwd></thruster>"
      "<dynamics><type>FirstOrder</type></dynamics><conversion><type>Basic</type><rotorConstant>0.0003</rotorConstant></conversion>";
  for (const char* file : {"libuuv_underwater_object_ros_plugin.so", "libuuv_thruster_ros_plugin.so", "libuuv_fin_ros_plugin.so",
                           "libusv_gazebo_dynamics_plugin.so", "libusv_gazebo_thrust_plugin.so", "libbuoyancy_gazebo_plugin.so",
                           "libwavefield_model_plugin.so", "libPolyhedraBuoyancyDrag.so"}) {
    const auto lines = try_out("<model name='m'><link name='a'/><plugin name='p' filename='" + std::string(file) + "'>" + hydrodynamics +
                               thruster + "</plugin></model>")
                           .lines;
    EXPECT_THAT(lines, testing::ElementsAre(testing::AllOf(testing::HasSubstr(file), testing::HasSubstr("is ignored")))) << file;
  }
  for (const char* file : {"libuuv_underwater_world_ros_plugin.so", "libusv_gazebo_wind_plugin.so", "libwavefield_world_plugin.so",
                           "libUSVWind.so", "libWavefield.so"}) {
    const auto lines = try_out("<model name='m'><link name='a'/></model><plugin name='p' filename='" + std::string(file) +
                               "'><wave><amplitude>0.3</amplitude><period>5</period></wave><wind_obj><name>m</name></wind_obj></plugin>")
                           .lines;
    EXPECT_THAT(lines, testing::ElementsAre(testing::AllOf(testing::HasSubstr(file), testing::HasSubstr("is ignored")))) << file;
  }
  const auto of_visual = try_out(
      "<model name='m'><link name='a'><visual name='v'><geometry><box><size>1 1 1</size></box></geometry>"
      "<plugin filename='libWaveVisual.so' name='vrx::WaveVisual'><static>false</static><wavefield><size>6000 "
      "6000</size></wavefield></plugin>"
      "</visual></link></model>");
  EXPECT_THAT(of_visual.lines, testing::ElementsAre(testing::HasSubstr("libWaveVisual.so")));
}

TEST(Nonsense, two_controllers_of_a_joint_and_one_of_a_wheel_that_a_drive_turns_have_one_line) {
  const std::string controller =
      "<plugin filename='gz-sim-joint-position-controller-system' name='PART'><joint_name>JOINT</joint_name></plugin>";
  const auto of = [&](const std::string& name, const std::string& joint) {
    std::string text = controller;
    text.replace(text.find("PART"), 4, name);
    return text.replace(text.find("JOINT"), 5, joint);
  };
  std::string twice = with_plugin("joint-position-controller", "<joint_name>j</joint_name>");
  const auto both = try_out(twice.insert(twice.rfind("</model>"), of("q", "j"))).lines;
  ASSERT_EQ(both.size(), 1U);
  EXPECT_THAT(both[0],
              testing::HasSubstr("plugin \"q\" of model \"m\": joint \"j\" is driven by \"p\" already; the plugin does not hold it"));
  const auto wheel = try_out(cart_text(of("q", "left_joint"))).lines;
  ASSERT_EQ(wheel.size(), 1U);
  EXPECT_THAT(wheel[0], testing::HasSubstr("plugin \"q\" of model \"cart\": joint \"left_joint\" is driven by \"drive\" already"));
}

}  // namespace
}  // namespace sim
