// Vehicles of tests: a quadcopter with the mass, rotors and gains of a public one, and a torpedo with a thruster; what is around
// them. Values; any thread.
#pragma once

#include <spdlog/fmt/fmt.h>

#include <string>

namespace sim::test {

inline const std::string air = "<gravity>0 0 -9.81</gravity>", weightless = "<gravity>0 0 0</gravity>";
inline const std::string flat_ground =
    "<model name='ground'><static>true</static><link name='l'><collision name='c'><geometry><plane/></geometry></collision></link></model>";

inline std::string rotor_link(int i, double x, double y, const std::string& name) {
  return fmt::format(
      "<link name='{0}_rotor_{1}'><pose>{2} {3} 0.02 0 0 0</pose><inertial><mass>0.005</mass><inertia><ixx>9.75e-7</ixx><iyy>4.17e-5</iyy>"
      "<izz>4.26e-5</izz></inertia></inertial></link><joint name='{0}_joint_{1}' "
      "type='revolute'><parent>base</parent><child>{0}_rotor_{1}</child>"
      "<axis><xyz>0 0 1</xyz></axis></joint>",
      name, i, x, y);
}

inline std::string rotor_plugin(int i, bool is_ccw, const std::string& name,
                                const std::string& file = "gz-sim-multicopter-motor-model-system") {
  return fmt::format(
      "<plugin filename='{3}' name='{4}'><robotNamespace>{0}</robotNamespace>"
      "<jointName>{0}_joint_{1}</jointName><linkName>{0}_rotor_{1}</linkName><turningDirection>{2}</"
      "turningDirection><timeConstantUp>0.0125</timeConstantUp>"
      "<timeConstantDown>0.025</timeConstantDown><maxRotVelocity>800</maxRotVelocity><motorConstant>8.54858e-06</motorConstant>"
      "<momentConstant>0.016</momentConstant><commandSubTopic>motor_speed</commandSubTopic><motorNumber>{1}</motorNumber>"
      "<rotorDragCoefficient>8.06428e-05</rotorDragCoefficient><rollingMomentCoefficient>1e-06</rollingMomentCoefficient>"
      "<rotorVelocitySlowdownSim>10</rotorVelocitySlowdownSim><motorType>velocity</motorType></plugin>",
      name, i, is_ccw ? "ccw" : "cw", file, file.find("gz-sim") == std::string::npos ? "motor" : "gz::sim::systems::MulticopterMotorModel");
}

// Four rotors at the corners; the two on a diagonal turn the same way. With `control`, the plugin of the velocity controller.
inline std::string quadcopter(const std::string& name, const std::string& pose, bool has_control = true, const std::string& more = "") {
  constexpr double xs[] = {0.13, -0.13, 0.13, -0.13}, ys[] = {-0.22, 0.2, 0.22, -0.2};
  std::string text = fmt::format(
      "<model name='{}'><pose>{}</pose><link "
      "name='base'><inertial><mass>1.5</mass><inertia><ixx>0.0347563</ixx><iyy>0.07</iyy><izz>0.0977</izz>"
      "</inertia></inertial><collision name='c'><geometry><box><size>0.47 0.47 0.11</size></box></geometry></collision></link>",
      name, pose);
  for (int i = 0; i < 4; ++i) text += rotor_link(i, xs[i], ys[i], name);
  for (int i = 0; i < 4; ++i) text += rotor_plugin(i, i < 2, name);
  if (has_control) {
    text += fmt::format(
        "<plugin filename='gz-sim-multicopter-control-system' name='gz::sim::systems::MulticopterVelocityControl'><robotNamespace>{0}"
        "</robotNamespace><comLinkName>base</comLinkName><velocityGain>2.7 2.7 2.7</velocityGain><attitudeGain>2 3 0.15</attitudeGain>"
        "<angularRateGain>0.4 0.52 0.18</angularRateGain><maximumLinearAcceleration>2 2 2</maximumLinearAcceleration><rotorConfiguration>",
        name);
    for (int i = 0; i < 4; ++i)
      text += fmt::format(
          "<rotor><jointName>{}_joint_{}</jointName><forceConstant>8.54858e-06</forceConstant><momentConstant>0.016</momentConstant>"
          "<direction>{}</direction></rotor>",
          name, i, i < 2 ? 1 : -1);
    text += "</rotorConfiguration></plugin>";
  }
  return text + more + "</model>";
}

// A body of 150 kg with the drag of a public torpedo, and a propeller behind.
inline std::string torpedo(const std::string& name, const std::string& thruster, const std::string& pose = "0 0 -2 0 0 0") {
  return fmt::format(
      "<model name='{}'><pose>{}</pose><link "
      "name='hull'><inertial><mass>148</mass><inertia><ixx>3</ixx><iyy>42</iyy><izz>42</izz></inertia></inertial>"
      "<collision name='c'><geometry><box><size>2 0.3 0.249</size></box></geometry></collision></link><link name='propeller'><pose>-1.05 0 "
      "0 0 0 0</pose>"
      "<inertial><mass>1.5</mass><inertia><ixx>0.002</ixx><iyy>0.001</iyy><izz>0.001</izz></inertia></inertial></link><joint name='shaft' "
      "type='revolute'>"
      "<parent>hull</parent><child>propeller</child><axis><xyz>1 0 0</xyz></axis></joint><plugin filename='gz-sim-thruster-system' "
      "name='gz::sim::systems::Thruster'><namespace>{}</namespace><joint_name>shaft</joint_name>{}</plugin><plugin "
      "filename='gz-sim-hydrodynamics-system' "
      "name='gz::sim::systems::Hydrodynamics'><link_name>hull</link_name><xDotU>-4.876</xDotU><yDotV>-126.32</yDotV><zDotW>-126.32</"
      "zDotW><mDotQ>-33.46</mDotQ>"
      "<nDotR>-33.46</nDotR><xUabsU>-6.2282</xUabsU><yVabsV>-601.27</yVabsV><zWabsW>-601.27</zWabsW><kPabsP>-0.1916</"
      "kPabsP><mQabsQ>-632.7</mQabsQ>"
      "<nRabsR>-632.7</nRabsR></plugin></model>",
      name, pose, name, thruster);
}

inline const std::string torpedo_thruster =
    "<thrust_coefficient>0.004422</thrust_coefficient><fluid_density>1000</fluid_density><propeller_diameter>0.2</propeller_diameter>"
    "<velocity_control>true</velocity_control>";

}  // namespace sim::test
