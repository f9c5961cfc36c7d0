// Gains of joint controllers in the YAML files of ros_control and ros2_control: the places where those have them.
//
//   arm_controller: {type: effort_controllers/JointTrajectoryController, gains: {elbow: {p: 4000, i: 1, d: 200, i_clamp: 1}}}
//   gazebo_ros_control/pid_gains: {elbow: {p: 4000, i: 1, d: 200}}          or gazebo_ros_control: {pid_gains: ...}
//   elbow_controller: {type: effort_controllers/JointPositionController, joint: elbow, pid: {p: 4000, i: 1, d: 200}}
//
// whatever stands around them (namespaces, ros__parameters). Controllers that command positions or velocities have gains of other units,
// which are left out. Any thread.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"
#include "world/complaints.h"
#include "world/model_path.h"
#include "world/world_def.h"

namespace sim {

// In the order of the file. What is left out adds a line to `left_out`. Fails when the file cannot be read, or is no YAML.
base::Result<std::vector<GainsDef>> read_gains(const std::filesystem::path& file, std::vector<std::string>& left_out);
// The same of a text; `name` stands for the file in messages.
base::Result<std::vector<GainsDef>> read_gains_text(const std::string& text, const std::string& name, std::vector<std::string>& left_out);

// Those of the model's joints; how many there are. Gains that a joint has already from the same kind of source stay.
std::size_t add_gains(const std::vector<GainsDef>& gains, ModelDef& model);

// A line for each that is of no joint of these models.
std::vector<std::string> gains_of_no_joint(const std::vector<GainsDef>& gains, std::span<const ModelDef> models, const std::string& where);

// Why a file whose gains add_gains() has put nowhere has none for `where`, "the world".
std::string why_no_gains(const std::vector<GainsDef>& gains, const std::vector<std::string>& left_out, const std::string& where);

// Those of the files that the model's ros_control and ros2_control plugins name in <parameters>. A file that is not there is a line.
void add_plugin_gains(const ModelPath& model_path, ModelDef& model, Complaints& complaints);

// Of a model that is spawned: the text of a file that the user names, and where joints start, as JOINT=POSITION a line. Fails when neither
// is of a joint of the model, or a position is no number. Gains of other joints are left out.
base::Result<void> add_named_gains(const std::string& text, ModelDef& model, std::vector<std::string>& left_out);
base::Result<void> set_initial_positions(const std::string& lines, ModelDef& model);

}  // namespace sim
