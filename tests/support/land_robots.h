// Models of our own with the drives of robots on land, as SDF 1.9: for tests that drive them. Pure.
#pragma once

#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <string>

namespace sim::test {

inline std::string floor_text() {
  return "<model name='ground'><static>true</static><link name='l'><collision name='c'><geometry><plane/></geometry></collision></link>"
         "</model>";
}

inline std::string inertial_text(double mass, double xx, double yy, double zz) {
  return fmt::format("<inertial><mass>{}</mass><inertia><ixx>{}</ixx><iyy>{}</iyy><izz>{}</izz></inertia></inertial>", mass, xx, yy, zz);
}

inline std::string box_text(double x, double y, double z) {
  return fmt::format("<geometry><box><size>{} {} {}</size></box></geometry>", x, y, z);
}

// A wheel whose axle looks to the left; `yaw` turns it. On a joint NAME_joint of the parent.
inline std::string wheel_text(const std::string& name, double x, double y, double radius, const std::string& surface = "", double yaw = 0,
                              const std::string& parent = "chassis", const std::string& joint = "") {
  return fmt::format("<link name='{}'><pose>{} {} {} -1.5707963 0 {}</pose>", name, x, y, radius, yaw) +
         inertial_text(0.5, 0.25 * 0.5 * radius * radius, 0.25 * 0.5 * radius * radius, 0.5 * 0.5 * radius * radius) +
         fmt::format(
             "<collision name='c'><geometry><cylinder><radius>{0}</radius><length>{1}</length></cylinder></geometry>{2}</collision></link>"
             "<joint name='{3}' type='revolute'><parent>{4}</parent><child>{5}</child><axis><xyz>0 0 1</xyz></axis></joint>",
             radius, 0.4 * radius, surface, joint.empty() ? name + "_joint" : joint, parent, name);
}

inline std::string rollers_text(const std::string& direction) {
  return "<surface><friction><ode><mu>1</mu><mu2>0</mu2><fdir1 gz:expressed_in='chassis'>" + direction +
         "</fdir1></ode></friction></surface>";
}

// As gz-sim's example has it: friction along the rollers alone, in the frame of the chassis.
inline std::string mecanum_text(double base = 0.5, double separation = 0.4, const std::string& more = "", double yaw = 0) {
  std::string text = fmt::format("<model name='base'><pose>0 0 0 0 0 {}</pose><link name='chassis'><pose>0 0 0.12 0 0 0</pose>", yaw) +
                     inertial_text(12, 0.2, 0.35, 0.5) + "<collision name='c'>" + box_text(0.6, 0.3, 0.1) + "</collision></link>";
  for (const auto& [name, x, y, direction] : {std::tuple{"front_left", base / 2, separation / 2, "1 -1 0"},
                                              {"front_right", base / 2, -separation / 2, "1 1 0"},
                                              {"back_left", -base / 2, separation / 2, "1 1 0"},
                                              {"back_right", -base / 2, -separation / 2, "1 -1 0"}})
    text += wheel_text(std::string(name) + "_wheel", x, y, 0.1, rollers_text(direction), 0, "chassis", std::string(name) + "_joint");
  return text +
         fmt::format(
             "<plugin filename='gz-sim-mecanum-drive-system' name='gz::sim::systems::MecanumDrive'><front_left_joint>front_left_joint"
             "</front_left_joint><front_right_joint>front_right_joint</front_right_joint><back_left_joint>back_left_joint</back_left_joint>"
             "<back_right_joint>back_right_joint</back_right_joint><wheelbase>{}</wheelbase><wheel_separation>{}</wheel_separation>"
             "<wheel_radius>0.1</wheel_radius>{}</plugin></model>",
             base, separation, more);
}

// Three omni wheels at 60, 180 and 300 degrees: they roll along their circle and slide along their axles.
inline std::string omni_text() {
  constexpr double reach = 0.2, radius = 0.05;
  const std::string rollers = "<surface><friction><ode><mu>0</mu><mu2>1</mu2></ode></friction></surface>";
  std::string text = "<model name='omni'><link name='chassis'><pose>0 0 0.08 0 0 0</pose>" + inertial_text(6, 0.05, 0.05, 0.08) +
                     "<collision name='c'><geometry><cylinder><radius>0.15</radius><length>0.06</length></cylinder></geometry></collision>"
                     "</link>";
  std::string joints;
  for (int i = 0; i < 3; ++i) {
    const double angle = M_PI / 3 + i * 2 * M_PI / 3;
    text += wheel_text(fmt::format("wheel_{}", i), reach * std::cos(angle), reach * std::sin(angle), radius, rollers, angle - M_PI / 2);
    joints += fmt::format("<wheel_joint>wheel_{}_joint</wheel_joint>", i);
  }
  return text + "<plugin filename='rtmsim-omni-drive' name='sim::systems::OmniDrive'>" + joints + "</plugin></model>";
}

// The steered front wheel is driven; encoders on the wheels in the rear.
inline std::string tricycle_text() {
  return "<model name='trike'><link name='chassis'><pose>0.25 0 0.2 0 0 0</pose>" + inertial_text(15, 0.3, 0.5, 0.6) +
         "<collision name='c'>" + box_text(0.7, 0.3, 0.1) + "</collision></link><link name='fork'><pose>0.6 0 0.1 0 0 0</pose>" +
         inertial_text(0.5, 0.002, 0.002, 0.002) +
         "</link><joint name='steering' type='revolute'><parent>chassis</parent><child>fork</child><axis><xyz>0 0 "
         "1</xyz><limit><lower>-1.57"
         "</lower><upper>1.57</upper></limit></axis></joint>" +
         wheel_text("front", 0.6, 0, 0.1, "", 0, "fork") + wheel_text("left", 0, 0.25, 0.1) + wheel_text("right", 0, -0.25, 0.1) +
         "<plugin filename='libgazebo_ros_tricycle_drive.so' name='drive'><steeringJoint>steering</steeringJoint><actuatedWheelJoint>"
         "front_joint</actuatedWheelJoint><encoderWheelLeftJoint>left_joint</encoderWheelLeftJoint><encoderWheelRightJoint>right_joint"
         "</encoderWheelRightJoint><wheelTorque>20</wheelTorque></plugin></model>";
}

inline std::string car_text() {
  std::string text = "<model name='car'><link name='chassis'><pose>0.5 0 0.35 0 0 0</pose>" + inertial_text(60, 4, 8, 10) +
                     "<collision name='c'>" + box_text(1.4, 0.5, 0.2) + "</collision></link>";
  for (const auto& [side, y] : {std::pair{"left", 0.4}, {"right", -0.4}}) {
    text += fmt::format("<link name='{}_knuckle'><pose>1 {} 0.2 0 0 0</pose>", side, y) + inertial_text(1, 0.01, 0.01, 0.01) +
            fmt::format(
                "</link><joint name='{0}_steering' type='revolute'><parent>chassis</parent><child>{0}_knuckle</child><axis><xyz>0 0 1</xyz>"
                "<limit><lower>-0.8</lower><upper>0.8</upper></limit></axis></joint>",
                side) +
            wheel_text(std::string("front_") + side, 1, y, 0.2, "", 0, std::string(side) + "_knuckle") +
            wheel_text(std::string("rear_") + side, 0, y, 0.2);
  }
  return text +
         "<plugin filename='gz-sim-ackermann-steering-system' name='gz::sim::systems::AckermannSteering'><left_joint>front_left_joint"
         "</left_joint><left_joint>rear_left_joint</left_joint><right_joint>front_right_joint</right_joint><right_joint>rear_right_joint"
         "</right_joint><left_steering_joint>left_steering</left_steering_joint><right_steering_joint>right_steering</right_steering_joint>"
         "<kingpin_width>0.8</kingpin_width><wheel_base>1.0</wheel_base><wheel_separation>0.8</wheel_separation><steering_limit>0.5"
         "</steering_limit><wheel_radius>0.2</wheel_radius></plugin></model>";
}

// A box and two rolls on each side, as gz-sim's example has it; with a flipper in front on the left. The outer corners of the tracks, 0.43
// m from the middle, decide how far it turns: 0.465 is half of the separation over that.
inline std::string tracked_text(bool has_flipper = false) {
  const std::string grip = "<surface><friction><ode><mu>0.7</mu><mu2>150</mu2></ode></friction></surface>";
  constexpr double half = 0.35, radius = 0.09, width = 0.1;
  std::string text = "<model name='tank'><link name='body'><pose>0 0 0.15 0 0 0</pose>" + inertial_text(12, 0.15, 0.4, 0.5) +
                     "<collision name='c'>" + box_text(0.6, 0.25, 0.12) + "</collision></link>",
              controllers;
  const auto roll = [&](const char* name, double x) {
    return fmt::format(
               "<collision name='{}'><pose>{} 0 0 1.5707963 0 0</pose><geometry><cylinder><radius>{}</radius><length>{}</length></cylinder>"
               "</geometry>",
               name, x, radius, width) +
           grip + "</collision>";
  };
  for (const auto& [side, y] : {std::pair{"left", 0.2}, {"right", -0.2}}) {
    text += fmt::format("<link name='{}_track'><pose>0 {} {} 0 0 0</pose>", side, y, radius) + inertial_text(4, 0.02, 0.1, 0.1) +
            "<collision name='flat'>" + box_text(2 * half, width, 2 * radius) + grip + "</collision>" + roll("front", half) +
            roll("rear", -half) +
            fmt::format("</link><joint name='{0}_track_j' type='fixed'><parent>body</parent><child>{0}_track</child></joint>", side);
    controllers += fmt::format(
        "<plugin filename='gz-sim-track-controller-system' name='gz::sim::systems::TrackController'><link>{}_track</link><min_velocity>-2"
        "</min_velocity><max_velocity>2</max_velocity></plugin>",
        side);
  }
  if (has_flipper) {
    text += fmt::format("<link name='flipper'><pose>{} 0.31 {} 0 0 0</pose>", half, radius) + inertial_text(0.8, 0.002, 0.006, 0.006) +
            fmt::format("<collision name='arm'><pose>0.12 0 0.02 0 0 0</pose>{}{}</collision>", box_text(0.24, 0.08, 0.06), grip) +
            "</link><joint name='flipper_j' type='revolute'><parent>left_track</parent><child>flipper</child><axis><xyz>0 1 0</xyz></axis>"
            "</joint>";
  }
  return text + controllers +
         "<plugin filename='gz-sim-tracked-vehicle-system' name='gz::sim::systems::TrackedVehicle'><body_link>body</body_link><left_track>"
         "<link>left_track</link></left_track><right_track><link>right_track</link></right_track>" +
         std::string(has_flipper ? "<left_track><link>flipper</link></left_track>" : "") +
         "<tracks_separation>0.4</tracks_separation><steering_efficiency>0.465</steering_efficiency></plugin></model>";
}

// Two wheels and a ball that slides.
inline std::string cart_text(const std::string& more = "") {
  return "<model name='cart'><link name='chassis'><pose>0 0 0.15 0 0 0</pose>" + inertial_text(6, 0.05, 0.08, 0.1) +
         "<collision name='c'>" + box_text(0.4, 0.2, 0.1) +
         "</collision><collision name='ball'><pose>-0.15 0 -0.1 0 0 0</pose><geometry><sphere><radius>0.05</radius></sphere></geometry>"
         "<surface><friction><ode><mu>0</mu><mu2>0</mu2></ode></friction></surface></collision></link>" +
         wheel_text("left", 0.05, 0.15, 0.1) + wheel_text("right", 0.05, -0.15, 0.1) +
         "<plugin filename='libgazebo_ros_diff_drive.so' name='drive'><left_joint>left_joint</left_joint><right_joint>right_joint"
         "</right_joint><wheel_separation>0.3</wheel_separation><wheel_diameter>0.2</wheel_diameter></plugin>" +
         more + "</model>";
}

}  // namespace sim::test
