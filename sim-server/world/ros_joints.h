// Elements of ROS about the joints of a model, put into the attributes of repairs.h: initial positions in <ros2_control>, and joints
// that a mimic plugin of Gazebo binds to a leader. `model`: an SDFormat model. One thread at a time.
#pragma once

#include <pugixml.hpp>

#include "world/complaints.h"

namespace sim {

// `parent` has the <ros2_control> elements: the URDF robot that the model was translated from, or the model. An <initial_position> that a
// joint has already stays. A value that is no number, or of a joint that does not exist or move, adds a warning; one beyond the limits
// counts as the nearest limit.
void carry_initial_positions(pugi::xml_node parent, pugi::xml_node model, Complaints& complaints);

// <drake:rotor_inertia> and <drake:gear_ratio>, as Drake reads them: elements of a joint of the model, or with the attribute `value` of the
// actuators of <transmission> elements of `parent`, a URDF robot, which may say <mechanicalReduction> instead of the ratio. The joint feels
// the inertia times the ratio squared.
void carry_rotors(pugi::xml_node parent, pugi::xml_node model, Complaints& complaints);

// <plugin><joint>LEADER</joint><mimicJoint>FOLLOWER</mimicJoint><multiplier/><offset/></plugin>. A <mimic> that a joint has already stays.
void carry_mimic_plugins(pugi::xml_node model, Complaints& complaints);

}  // namespace sim
