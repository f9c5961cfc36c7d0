#include "world/plugin_numbers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <span>
#include <string_view>

#include "base/text.h"
#include "world/xml_file.h"
#include "world/xml_values.h"

namespace sim {
namespace {

enum class Must {
  number,
  gain,
  positive,
  amount,  // 0 or more, and finite
  not_negative,
  not_positive,
  not_zero,
  one_or_minus_one,
  two_or_three,
  vector,
  vector_not_negative,
  push,
  ratio,
  own  // rejected by the plugin's own reader alone: it has no default, or what is default depends on others
};

struct NumberRow {
  std::string_view element;
  Must must;
  std::string_view otherwise = {};  // what counts instead of an impossible one that has a place in a list of joints; empty: it is removed
};

using enum Must;

constexpr std::array wheel_rows{
    NumberRow{"wheel_separation", number},
    NumberRow{"wheelSeparation", number},
    NumberRow{"wheel_track", number},
    NumberRow{"kingpin_width", number},
    NumberRow{"wheel_base", number},
    NumberRow{"wheelbase", number},
    NumberRow{"wheel_radius", number},
    NumberRow{"wheelRadius", number},
    NumberRow{"wheel_diameter", number},
    NumberRow{"wheelDiameter", number},
    NumberRow{"actuatedWheelDiameter", number},
    NumberRow{"actuated_wheel_diameter", number},
    NumberRow{"encoderWheelDiameter", number},
    NumberRow{"encoder_wheel_diameter", number},
    NumberRow{"encoderWheelSeparation", number},
    NumberRow{"encoder_wheel_separation", number},
    NumberRow{"tracks_separation", number},
    NumberRow{"steering_efficiency", number},
    NumberRow{"max_wheel_torque", positive},
    NumberRow{"wheelTorque", positive},
    NumberRow{"wheel_torque", positive},
    NumberRow{"torque", positive},
    NumberRow{"max_force", positive},
    NumberRow{"MaxForce", positive},
    NumberRow{"steering_limit", positive},
    NumberRow{"max_steer", positive},
    NumberRow{"steer_p_gain", positive},
    NumberRow{"max_wheel_speed", not_negative},
    NumberRow{"wheelAcceleration", not_negative},
    NumberRow{"wheel_acceleration", not_negative},
    NumberRow{"max_wheel_acceleration", not_negative},
    NumberRow{"max_turnrate", not_negative},
    NumberRow{"maxSpeed", not_negative},
    NumberRow{"max_linear_speed", positive},
    NumberRow{"max_angular_speed", positive},
    NumberRow{"track_orientation", vector},
};

// Limits and rates that drives have in common.
constexpr std::array drive_rows{
    NumberRow{"max_velocity", not_negative},
    NumberRow{"max_speed", not_negative},
    NumberRow{"max_linear_velocity", not_negative},
    NumberRow{"max_angular_velocity", not_negative},
    NumberRow{"max_yaw_rate", not_negative},
    NumberRow{"max_acceleration", not_negative},
    NumberRow{"max_linear_acceleration", not_negative},
    NumberRow{"max_angular_acceleration", not_negative},
    NumberRow{"max_yaw_acceleration", not_negative},
    NumberRow{"min_velocity", not_positive},
    NumberRow{"min_linear_velocity", not_positive},
    NumberRow{"min_angular_velocity", not_positive},
    NumberRow{"min_acceleration", not_positive},
    NumberRow{"odom_publish_frequency", not_negative},
    NumberRow{"odometry_publish_frequency", not_negative},
    NumberRow{"update_rate", not_negative},
    NumberRow{"updateRate", not_negative},
    NumberRow{"gaussian_noise", not_negative},
    NumberRow{"dimensions", two_or_three},
    NumberRow{"xyz_offset", vector},
    NumberRow{"rpy_offset", vector},
    NumberRow{"initial_linear", vector},
    NumberRow{"initial_angular", vector},
};

constexpr std::array path_rows{
    NumberRow{"speed", number},  NumberRow{"velocity", number}, NumberRow{"turn_rate", number},           NumberRow{"delay_start", number},
    NumberRow{"radius", number}, NumberRow{"length", number},   NumberRow{"corner_radius", not_negative},
};

constexpr std::array propeller_rows{
    NumberRow{"propeller_diameter", positive},
    NumberRow{"fluid_density", positive},
    NumberRow{"thrust_coefficient", not_zero},
    NumberRow{"alpha_1", number},
    NumberRow{"alpha_2", number},
    NumberRow{"wake_fraction", number},
    NumberRow{"max_thrust_cmd", number},
    NumberRow{"min_thrust_cmd", number},
    NumberRow{"deadband", not_negative},
    NumberRow{"p_gain", gain},
    NumberRow{"i_gain", gain},
    NumberRow{"d_gain", gain},
    NumberRow{"motorConstant", positive},
    NumberRow{"momentConstant", not_negative},
    NumberRow{"rotorDragCoefficient", not_negative},
    NumberRow{"rollingMomentCoefficient", not_negative},
    NumberRow{"timeConstantUp", not_negative},
    NumberRow{"timeConstantDown", not_negative},
    NumberRow{"rotorVelocitySlowdownSim", ratio},
    NumberRow{"maxRotVelocity", positive},
};

constexpr std::array multicopter_rows{
    NumberRow{"velocityGain", vector_not_negative},
    NumberRow{"attitudeGain", vector_not_negative},
    NumberRow{"angularRateGain", vector_not_negative},
    NumberRow{"maximumLinearAcceleration", vector_not_negative},
    NumberRow{"maximumLinearVelocity", vector_not_negative},
    NumberRow{"maximumAngularVelocity", vector_not_negative},
    NumberRow{"forceConstant", positive},
    NumberRow{"momentConstant", not_negative},
    NumberRow{"direction", one_or_minus_one},
};

constexpr std::array wing_rows{
    NumberRow{"a0", number},     NumberRow{"alpha_stall", number},   NumberRow{"cla", number},
    NumberRow{"cda", number},    NumberRow{"cla_stall", number},     NumberRow{"cda_stall", number},
    NumberRow{"area", positive}, NumberRow{"air_density", positive}, NumberRow{"control_joint_rad_to_cl", number},
    NumberRow{"cp", vector},     NumberRow{"forward", vector},       NumberRow{"upward", vector},
};

constexpr std::array airframe_rows{
    NumberRow{"area", positive},
    NumberRow{"air_density", positive},
    NumberRow{"AR", own},
    NumberRow{"eff", own},
    NumberRow{"mac", not_negative},
    NumberRow{"alpha_stall", positive},
    NumberRow{"Cema_stall", number},
    NumberRow{"cp", vector},
    NumberRow{"forward", vector},
    NumberRow{"upward", vector},
    NumberRow{"num_ctrl_surfaces", not_negative},
    NumberRow{"direction", number},
};
constexpr std::array airship_rows{
    NumberRow{"air_density", positive},      NumberRow{"force_inviscid_coeff", own}, NumberRow{"force_viscous_coeff", own},
    NumberRow{"moment_inviscid_coeff", own}, NumberRow{"moment_viscous_coeff", own}, NumberRow{"eps_v", own},
    NumberRow{"axial_drag_coeff", own},
};
constexpr std::array hull_rows{
    NumberRow{"hull_radius", own},
    NumberRow{"hull_length", own},
    NumberRow{"fluid_level", number},
    NumberRow{"fluid_density", positive},
};
constexpr std::array bladder_rows{
    NumberRow{"min_volume", own},     NumberRow{"max_volume", own},         NumberRow{"neutral_volume", amount},
    NumberRow{"default_volume", own}, NumberRow{"fluid_density", positive}, NumberRow{"max_inflation_rate", positive},
    NumberRow{"surface", number},
};

constexpr std::array water_rows{
    NumberRow{"uniform_fluid_density", not_negative},
    NumberRow{"fluid_density", not_negative},
    NumberRow{"default_density", not_negative},
    NumberRow{"density", not_negative},
    NumberRow{"above_depth", number},
};
// Its coefficients are checked by their reader.
constexpr std::array current_rows{NumberRow{"default_current", vector}};
constexpr std::array wrench_rows{NumberRow{"force", push}, NumberRow{"torque", push}};
constexpr std::array wind_rows{
    NumberRow{"force_approximation_scaling_factor", positive},
    NumberRow{"time_for_rise", positive},
    NumberRow{"period", positive},
    NumberRow{"amplitude_percent", number},
    NumberRow{"amplitude", number},
};
constexpr std::array slip_rows{
    NumberRow{"slip_compliance_lateral", not_negative},
    NumberRow{"slip_compliance_longitudinal", not_negative},
    NumberRow{"wheel_radius", positive},
};

constexpr std::array thermal_rows{NumberRow{"resolution", positive}, NumberRow{"min_temp", amount}, NumberRow{"max_temp", positive}};

// Elements of trajectory controllers come once for each joint.
constexpr std::array joint_rows{
    NumberRow{"p_gain", gain},
    NumberRow{"i_gain", gain},
    NumberRow{"d_gain", gain},
    NumberRow{"i_max", number},
    NumberRow{"i_min", number},
    NumberRow{"cmd_max", number},
    NumberRow{"cmd_min", number},
    NumberRow{"cmd_offset", number},
    NumberRow{"position_p_gain", gain, "0"},
    NumberRow{"position_i_gain", gain, "0"},
    NumberRow{"position_d_gain", gain, "0"},
    NumberRow{"position_i_max", number, "-1"},
    NumberRow{"position_i_min", number, "0"},
    NumberRow{"position_cmd_max", number, "-1"},
    NumberRow{"position_cmd_min", number, "0"},
    NumberRow{"position_cmd_offset", number, "0"},
    NumberRow{"velocity_p_gain", gain, "0"},
    NumberRow{"velocity_i_gain", gain, "0"},
    NumberRow{"velocity_d_gain", gain, "0"},
    NumberRow{"initial_position", number, "0"},
    NumberRow{"initial_velocity", number, "0"},
};

std::array<std::span<const NumberRow>, 2> rows_of(PluginKind kind) {
  if (is_wheel_drive(kind)) return {wheel_rows, drive_rows};
  switch (kind) {
    case PluginKind::velocity_control:
    case PluginKind::odometry_publisher:
    case PluginKind::joint_state_publisher:
      return {drive_rows};
    case PluginKind::trajectory_follower:
      return {path_rows, drive_rows};
    case PluginKind::thruster:
    case PluginKind::rotor:
      return {propeller_rows};
    case PluginKind::multicopter_control:
      return {multicopter_rows};
    case PluginKind::lift_drag:
      return {wing_rows};
    case PluginKind::advanced_lift_drag:
      return {airframe_rows};
    case PluginKind::lighter_than_air:
      return {airship_rows};
    case PluginKind::buoyancy_engine:
      return {bladder_rows};
    case PluginKind::floating_hull:
      return {hull_rows};
    case PluginKind::hydrodynamics:
      return {current_rows};
    case PluginKind::buoyancy:
      return {water_rows};
    case PluginKind::link_wrench:
      return {wrench_rows};
    case PluginKind::wind_effects:
      return {wind_rows};
    case PluginKind::wheel_slip:
      return {slip_rows};
    case PluginKind::thermal_sensor:
      return {thermal_rows};
    case PluginKind::joint_controller:
      return {joint_rows};
    default:
      return {};
  }
}

constexpr double largest_number = 1e9;  // of a number that is no limit
constexpr double largest_push = 1e7;    // [N], [N m]
constexpr double largest_gain = 1e12;

// What was expected; empty: the text is good.
std::string_view expectation_failed(Must must, const std::string& text) {
  const auto numbers = parse_numbers(text);
  if (must == vector || must == vector_not_negative || must == push) {
    const bool is_good = numbers && numbers->size() == 3 && std::ranges::all_of(*numbers, [&](double one) {
                           return std::isfinite(one) && (must != vector_not_negative || one >= 0);
                         });
    if (!is_good) return must == vector_not_negative ? "three numbers of 0 or more" : "three numbers";
    const double limit = must == push ? largest_push : largest_number;
    if (std::ranges::all_of(*numbers, [&](double one) { return std::abs(one) < limit; })) return "";
    return must == push ? "three numbers below 1e7" : "three numbers below 1e9";
  }
  // A limit may be infinite, which is its default.
  const bool may_be_infinite = must == not_negative || must == not_positive;
  const double limit = must == gain ? largest_gain : largest_number;
  const bool is_one = numbers && numbers->size() == 1 && !std::isnan(numbers->front());
  if (is_one && !may_be_infinite && std::isfinite(numbers->front()) && std::abs(numbers->front()) > limit)
    return must == gain ? "a number from 0 to 1e12" : "a number within 1e9";
  const bool is_number = is_one && (may_be_infinite || std::isfinite(numbers->front()));
  const double value = is_number ? numbers->front() : 0;
  switch (must) {
    case gain:
      return is_number && value >= 0 && value <= largest_gain ? "" : "a number from 0 to 1e12";
    case positive:
      return is_number && value > 0 ? "" : "a positive number";
    case amount:
      return is_number && value >= 0 ? "" : "a number of 0 or more";
    case not_negative:
      return is_number && value >= 0 ? "" : "a number of 0 or more";
    case not_positive:
      return is_number && value <= 0 ? "" : "a number of 0 or less";
    case not_zero:
      return is_number && value != 0 ? "" : "a number other than 0";
    case ratio:
      return is_number && value >= 0.001 && value <= 1e6 ? "" : "a number from 0.001 to 1e6";
    case two_or_three:
      return is_number && (value == 2 || value == 3) ? "" : "2 or 3";
    case one_or_minus_one:
      return is_number && std::abs(value) == 1 ? "" : "1 or -1";
    default:
      return is_number ? "" : "a number";
  }
}

class NumberChecks {
 public:
  NumberChecks(PluginKind kind, std::string about, Complaints& complaints)
      : rows_(rows_of(kind)), about_(std::move(about)), complaints_(complaints) {}

  // The elements of the two are the same, in the same order.
  void check(pugi::xml_node node, ParameterNode& parameters) {
    std::vector<ParameterNode> kept;
    auto next = parameters.children.begin();
    for (pugi::xml_node element : node.children()) {
      if (element.type() != pugi::node_element) continue;
      ParameterNode& parameter = *next++;
      if (!parameter.children.empty()) {
        check(element, parameter);
      } else if (is_impossible(element, parameter)) {
        continue;
      }
      kept.push_back(std::move(parameter));
    }
    parameters.children = std::move(kept);
  }

 private:
  bool is_impossible(pugi::xml_node element, ParameterNode& parameter) {
    std::string_view expected, otherwise;
    for (const auto rows : rows_) {
      const auto row = std::ranges::find(rows, parameter.name, &NumberRow::element);
      if (row == rows.end() || !expected.empty()) continue;
      if (row->must == own) return false;
      expected = expectation_failed(row->must, parameter.text);
      otherwise = row->otherwise;
    }
    const std::string lower = base::to_lower(parameter.text);
    if (expected.empty() && (lower == "nan" || lower == "-nan" || lower == "+nan")) expected = "a number";
    if (expected.empty()) return false;
    const std::string taken = otherwise.empty() ? "its default is taken" : std::string(otherwise) + " is taken";
    complaints_.warn(element, "<" + parameter.name + "> of " + about_ + " must be " + std::string(expected) + ", got " +
                                  base::in_quotes(parameter.text) + "; " + taken);
    parameter.text = otherwise;
    return otherwise.empty();
  }

  std::array<std::span<const NumberRow>, 2> rows_;
  std::string about_;
  Complaints& complaints_;
};

}  // namespace

namespace {

bool takes_several_names(PluginKind kind) {
  return is_wheel_drive(kind) || kind == PluginKind::joint_controller || kind == PluginKind::joint_state_publisher;
}

bool takes_one_name(PluginKind kind) {
  using enum PluginKind;
  constexpr std::array kinds{hydrodynamics,   lift_drag, advanced_lift_drag, lighter_than_air, floating_hull, thruster,
                             buoyancy_engine, rotor,     joint_force};
  return std::ranges::find(kinds, kind) != kinds.end();
}

// The same joint twice where there may be several, or a second name where there may be one.
void check_doubled_names(pugi::xml_node node, const PluginDef& plugin, Complaints& complaints) {
  const bool takes_one = takes_one_name(kind_of(plugin));
  if (!takes_one && !takes_several_names(kind_of(plugin))) return;
  std::set<std::pair<std::string, std::string>> named;
  for (pugi::xml_node element : node.children()) {
    const std::string name = element.name(), text(base::trim(element.text().get())), lower = base::to_lower(name);
    const bool is_joint = lower.ends_with("joint") || lower == "joint_name" || lower == "jointname";
    if (text.empty() || (!is_joint && lower != "link_name" && lower != "linkname")) continue;
    if (named.emplace(name, takes_one ? "" : text).second) continue;
    complaints.warn(element, "<" + name + "> of " + describe_in_context(node) +
                                 (takes_one ? " appears twice; the first one counts"
                                            : " names " + base::in_quotes(text) + " twice; the second one is ignored"));
  }
}

}  // namespace

void check_numbers(pugi::xml_node node, PluginDef& plugin, Complaints& complaints) {
  check_doubled_names(node, plugin, complaints);
  NumberChecks(kind_of(plugin), describe_in_context(node), complaints).check(node, plugin.parameters);
}

}  // namespace sim
