#include "served.h"

#include "robot_topics.h"

namespace ros2 {

std::string interface_tables() {
  std::string text = "| iface | topics | types |\n| --- | --- | --- |\n";
  for (const auto& row : served_rows())
    text += "| `" + std::string(shm::to_text(row.type)) + "` | " + row.topics + " | " + row.types + " |\n";
  text +=
      "| world | /clock, /tf, /tf_static, ROBOT/robot_description | rosgraph_msgs/msg/Clock, tf2_msgs/msg/TFMessage, std_msgs/msg/String "
      "|\n"
      "| each node | /rosout, /parameter_events | rcl_interfaces/msg/Log, rcl_interfaces/msg/ParameterEvent |\n"
      "\n| command | type | effect |\n| --- | --- | --- |\n"
      "| cmd_vel | geometry_msgs/msg/Twist, TwistStamped | velocity of a drive |\n"
      "| joint_trajectory | trajectory_msgs/msg/JointTrajectory | path of joints in simulated time |\n"
      "| position_controller/commands, velocity_controller/commands, effort_controller/commands | std_msgs/msg/Float64MultiArray | a value "
      "for each "
      "joint |\n"
      "| JOINT/position_command | std_msgs/msg/Float64 | position of one joint |\n"
      "\n| service | type |\n| --- | --- |\n";
  for (const char* name : {"GetSimulatorFeatures", "GetSimulationState", "SetSimulationState", "ResetSimulation", "StepSimulation",
                           "GetCurrentWorld", "GetEntities", "GetEntityInfo", "GetEntityBounds", "GetEntityState", "GetEntitiesStates",
                           "SetEntityState", "SpawnEntity", "SpawnEntities", "GetSpawnables", "DeleteEntity"}) {
    std::string snake;
    for (const char* c = name; *c != '\0'; ++c) {
      const bool is_upper = *c >= 'A' && *c <= 'Z';
      if (is_upper && c != name) snake += '_';
      snake += is_upper ? static_cast<char>(*c - 'A' + 'a') : *c;
    }
    text += "| /" + snake + " | simulation_interfaces/srv/" + name + " |\n";
  }
  for (const char* name :
       {"list_parameters", "get_parameters", "get_parameter_types", "describe_parameters", "set_parameters", "set_parameters_atomically"})
    text += "| NODE/" + std::string(name) + " | rcl_interfaces |\n";
  text += "\n| action | type |\n| --- | --- |\n| /simulate_steps | simulation_interfaces/action/SimulateSteps |\n";
  return text;
}

}  // namespace ros2
