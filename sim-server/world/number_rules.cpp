#include "world/number_rules.h"

#include <cmath>
#include <map>

#include "base/text.h"
#include "world/xml_values.h"

namespace sim {
namespace {

using Form = NumberRule::Form;

const std::map<std::string_view, NumberRule>& number_rules() {
  using enum NumberRule::Form;
  using enum NumberRule::Remedy;
  static const std::map<std::string_view, NumberRule> table{
      {"box/size", {positive3, drop_owner}},
      {"sphere/radius", {positive, drop_owner}},
      {"cylinder/radius", {positive, drop_owner}},
      {"cylinder/length", {positive, drop_owner}},
      {"cone/radius", {positive, drop_owner}},
      {"cone/length", {positive, drop_owner}},
      {"capsule/radius", {positive, drop_owner}},
      {"capsule/length", {positive, drop_owner}},
      {"ellipsoid/radii", {positive3, drop_owner}},
      {"plane/normal", {direction, drop_owner}},
      {"plane/size", {positive2, ignore}},
      {"mesh/scale", {scale3, drop_owner}},
      {"heightmap/size", {positive3, drop_owner}},
      {"heightmap/pos", {vector3, drop_owner}},
      {"polyline/point", {vector2, drop_owner}},
      {"polyline/height", {positive, drop_owner}},
      {"axis/xyz", {direction, drop_owner}},
      {"axis2/xyz", {direction, drop_owner}},
      {"limit/lower", {number, ignore}},
      {"limit/upper", {number, ignore}},
      {"limit/effort", {number, ignore}},
      {"limit/velocity", {number, ignore}},
      {"limit/stiffness", {not_negative, ignore}},
      {"limit/dissipation", {not_negative, ignore}},
      {"dynamics/damping", {not_negative, ignore}},
      {"dynamics/friction", {not_negative, ignore}},
      {"dynamics/spring_reference", {finite, ignore}},
      {"dynamics/spring_stiffness", {finite, ignore}},
      {"joint/thread_pitch", {finite, ignore}},
      {"joint/screw_thread_pitch", {finite, ignore}},
      {"joint/gearbox_ratio", {finite, ignore}},
      {"road/width", {positive, drop_owner}},
      {"road/point", {vector3, drop_owner}},
      {"population/model_count", {positive, drop_owner}},
      {"distribution/rows", {positive, drop_owner}},
      {"distribution/cols", {positive, drop_owner}},
      {"distribution/step", {vector3, drop_owner}},
      {"world/gravity", {vector3, ignore}},
      {"atmosphere/temperature", {positive, ignore}},
      {"atmosphere/pressure", {positive, ignore}},
      {"world/magnetic_field", {vector3, ignore}},
      {"wind/linear_velocity", {vector3, ignore}},
      {"physics/max_step_size", {positive, ignore}},
      {"physics/real_time_factor", {not_negative, ignore}},
      {"attenuation/range", {not_negative, ignore}},
      {"attenuation/constant", {not_negative, ignore}},
      {"attenuation/linear", {not_negative, ignore}},
      {"attenuation/quadratic", {not_negative, ignore}},
      {"light/intensity", {not_negative, ignore}},
      {"light/direction", {direction, ignore}},
      {"visual/transparency", {finite, ignore}},
      {"velocity_decay/linear", {not_negative, ignore}},
      {"velocity_decay/angular", {not_negative, ignore}},
      {"waypoint/time", {finite, drop_owner}},
      {"skin/scale", {positive, ignore}},
      {"animation/scale", {positive, ignore}},
      {"script/delay_start", {not_negative, ignore}},
      // Sensors.
      {"sensor/update_rate", {within, ignore, 0, 1e6}},
      {"noise/mean", {within, ignore, -1e6, 1e6}},
      {"noise/stddev", {within, ignore, 0, 1e6}},
      {"noise/bias_mean", {within, ignore, -1e6, 1e6}},
      {"noise/bias_stddev", {within, ignore, 0, 1e6}},
      {"noise/dynamic_bias_stddev", {within, ignore, 0, 1e6}},
      {"noise/dynamic_bias_correlation_time", {within, ignore, 0, 1e9}},
      {"noise/precision", {within, ignore, 0, 1e6}},
      {"range/min", {not_negative, drop_owner}},
      {"range/max", {number, drop_owner}},
      {"range/resolution", {within, ignore, 0, 1e6}},
      {"horizontal/samples", {finite, drop_owner}},
      {"horizontal/resolution", {positive, ignore}},
      {"horizontal/min_angle", {finite, drop_owner}},
      {"horizontal/max_angle", {finite, drop_owner}},
      {"vertical/samples", {finite, drop_owner}},
      {"vertical/resolution", {positive, ignore}},
      {"vertical/min_angle", {finite, drop_owner}},
      {"vertical/max_angle", {finite, drop_owner}},
      {"camera/horizontal_fov", {positive, drop_owner}},
      {"image/width", {positive, drop_owner}},
      {"image/height", {positive, drop_owner}},
      {"clip/near", {positive, ignore}},
      {"clip/far", {positive, ignore}},
      {"distortion/k1", {within, ignore, -1e3, 1e3}},
      {"distortion/k2", {within, ignore, -1e3, 1e3}},
      {"distortion/k3", {within, ignore, -1e3, 1e3}},
      {"distortion/p1", {within, ignore, -1e3, 1e3}},
      {"distortion/p2", {within, ignore, -1e3, 1e3}},
      {"distortion/center", {vector2, ignore}},
      {"lens/cutoff_angle", {within, ignore, 0, 6.2832}},
      {"lens/env_texture_size", {within, ignore, 1, 65536}},
      {"custom_function/c1", {within, ignore, -1e3, 1e3}},
      {"custom_function/c2", {within, ignore, -1e3, 1e3}},
      {"custom_function/c3", {within, ignore, -1e3, 1e3}},
      {"custom_function/f", {positive, ignore}},
      {"sonar/min", {not_negative, drop_owner}},
      {"sonar/max", {positive, drop_owner}},
      {"sonar/radius", {within, ignore, 0, 1e6}},
      {"logical_camera/near", {not_negative, drop_owner}},
      {"logical_camera/far", {number, drop_owner}},
      {"logical_camera/horizontal_fov", {positive, drop_owner}},
      {"logical_camera/aspect_ratio", {positive, drop_owner}},
      {"fiducial/horizontal_fov", {positive, drop_owner}},
      {"orientation_reference_frame/custom_rpy", {vector3, ignore}},
      {"air_pressure/reference_altitude", {within, ignore, -1e5, 1e5}},
      {"transceiver/frequency", {positive, drop_owner}},
      {"transceiver/min_frequency", {within, ignore, 0, 1e9}},
      {"transceiver/max_frequency", {within, ignore, 0, 1e9}},
      {"transceiver/gain", {within, ignore, -1e3, 1e3}},
      {"transceiver/power", {within, ignore, -1e3, 1e3}},
      {"transceiver/sensitivity", {within, ignore, -1e3, 1e3}},
      {"rfid/range", {positive, drop_owner}},
      {"rfid/angle", {positive, drop_owner}},
      {"dvl/minimum_range", {not_negative, drop_owner}},
      {"dvl/maximum_range", {number, drop_owner}},
      {"dvl/reference_frame", {pose, ignore}},
      {"beam/aperture", {positive, drop_owner}},
      {"beam/rotation", {finite, drop_owner}},
      {"beam/tilt", {finite, drop_owner}},
      {"wheel_encoders/ticks", {positive, drop_owner}},
      {"wheel_encoders/gear_ratio", {positive, drop_owner}},
      {"localization/hypotheses", {positive, drop_owner}},
  };
  return table;
}

bool is_sane(double value) { return std::isfinite(value) && std::abs(value) <= largest_length; }

}  // namespace

const NumberRule* find_number_rule(std::string_view parent, std::string_view element) {
  const std::size_t colon = parent.find(':');
  const std::string path = std::string(parent.substr(colon == std::string_view::npos ? 0 : colon + 1)) + "/" + std::string(element);
  const auto rule = number_rules().find(path);
  return rule == number_rules().end() ? nullptr : &rule->second;
}

std::string expectation(const NumberRule& rule) {
  switch (rule.form) {
    case Form::finite:
      return "a finite number";
    case Form::not_negative:
      return "a number that is not negative";
    case Form::positive:
      return "a positive number";
    case Form::number:
      return "a number";
    case Form::within:
      return "a number from " + base::format_number(rule.min) + " to " + base::format_number(rule.max);
    case Form::pose:
      return "six finite numbers";
    case Form::vector2:
      return "two finite numbers";
    case Form::positive2:
      return "two positive numbers";
    case Form::vector3:
      return "three finite numbers";
    case Form::positive3:
      return "three positive numbers";
    case Form::scale3:
      return "three numbers other than zero";
    case Form::direction:
      return "three numbers that are not all zero";
  }
  return "a number";
}

bool fits(const NumberRule& rule, const std::string& text) {
  const std::optional<std::vector<double>> parsed = parse_numbers(text);
  if (!parsed) return false;
  const std::vector<double>& n = *parsed;
  const auto all = [&](std::size_t count, auto good) {
    if (n.size() != count) return false;
    for (double value : n) {
      if (!good(value)) return false;
    }
    return true;
  };
  const auto sane = [](double value) { return is_sane(value); };
  const auto above = [](double value) { return is_sane(value) && value > 1e-9; };
  switch (rule.form) {
    case Form::finite:
      return all(1, sane);
    case Form::not_negative:
      return all(1, [](double value) { return std::isfinite(value) && value >= 0; });
    case Form::positive:
      return all(1, above);
    case Form::number:
      return all(1, [](double value) { return !std::isnan(value); });
    case Form::within:
      return all(1, [&rule](double value) { return value >= rule.min && value <= rule.max; });
    case Form::pose:
      return all(6, sane);
    case Form::vector2:
      return all(2, sane);
    case Form::positive2:
      return all(2, above);
    case Form::vector3:
      return all(3, sane);
    case Form::positive3:
      return all(3, above);
    case Form::scale3:
      return all(3, [](double value) { return is_sane(value) && std::abs(value) > 1e-12; });
    case Form::direction:
      return all(3, sane) && std::hypot(n[0], n[1], n[2]) > 1e-9;
  }
  return false;
}

}  // namespace sim
