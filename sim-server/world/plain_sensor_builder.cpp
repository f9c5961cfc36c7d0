// Sensors without rays or pictures of their own: sound, radio, tags, wheels, and fused estimates.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/text.h"
#include "world/sensor_parts.h"
#include "world/xml_file.h"
#include "world/xml_values.h"

namespace sim {
namespace {

constexpr double half_turn = std::numbers::pi;

// The element that a kind has in its sensor: with a prefix of its own, as custom elements have (<gz:dvl>), else without. The sensor itself
// where there is none.
pugi::xml_node element_of(pugi::xml_node sensor, const char* kind) {
  for (const pugi::xml_node child : sensor.children()) {
    const std::string_view name = child.name();
    if (const std::size_t colon = name.find(':'); colon != std::string_view::npos && name.substr(colon + 1) == kind) return child;
  }
  const pugi::xml_node plain = sensor.child(kind);
  return plain ? plain : sensor;
}

std::string text_below(pugi::xml_node node, const char* name) { return std::string(base::trim(node.child(name).text().get())); }

}  // namespace

std::optional<DvlDef> build_dvl(pugi::xml_node sensor, BuildContext& context) {
  const pugi::xml_node node = element_of(sensor, "dvl");
  const pugi::xml_node arrangement = node.child("arrangement"), tracking = node.child("tracking");
  const double unit = arrangement.attribute("degrees").as_bool() ? half_turn / 180 : 1;
  DvlDef dvl;
  std::string wrong;
  for (const pugi::xml_node beam : arrangement.children("beam")) {
    DvlDef::Beam one;
    one.aperture = number_at(beam, "aperture", half_turn / 2 / unit) * unit;
    one.rotation = number_at(beam, "rotation", 0) * unit;
    one.tilt = number_at(beam, "tilt", 0) * unit;
    if (!(std::abs(one.tilt) < half_turn / 2)) wrong = must(sensor, "tilt of a beam", "within 90 degrees", one.tilt / unit);
    if (!(one.aperture > 0 && one.aperture < half_turn))
      wrong = must(sensor, "aperture of a beam", "above 0 and below 180 degrees", one.aperture / unit);
    dvl.beams.push_back(one);
  }
  constexpr std::size_t fewest = 3, most = 64;
  if (dvl.beams.size() < fewest || dvl.beams.size() > most)
    wrong = must(sensor, "number of beams", "from 3 to 64", static_cast<double>(dvl.beams.size()));
  dvl.range_min = number_at(node, "minimum_range", 0.1);
  dvl.range_max = number_at(node, "maximum_range", 100);
  if (constexpr double furthest = 1e5; dvl.range_max > furthest) {
    context.complaints.note(node, "largest range of " + describe_in_context(sensor) + " is cut to 100000 m");
    dvl.range_max = furthest;
  }
  if (wrong.empty() && !(dvl.range_max > dvl.range_min && dvl.range_min >= 0))
    wrong = must(sensor, "maximum range", "above the minimum range, which is not negative", dvl.range_max);
  dvl.reference = pose_at(node, "reference_frame");
  dvl.speed = build_noise(child_at(tracking, "bottom_mode/noise"), context);
  if (!wrong.empty()) {
    context.complaints.drop(sensor, wrong);
    return std::nullopt;
  }
  const bool has_bottom = tracking.child("bottom_mode") && text_at(tracking, "bottom_mode/when", "always") != "never";
  if (const pugi::xml_node water = tracking.child("water_mass_mode"); water && text_at(water, "when", "always") != "never") {
    context.complaints.warn(water, "water mass tracking of " + describe_in_context(sensor) + " is not simulated; " +
                                       (has_bottom ? "the bottom is tracked" : "the bottom is tracked instead"));
  }
  return dvl;
}

InsDef build_ins(pugi::xml_node sensor, BuildContext& context) {
  const pugi::xml_node node = element_of(sensor, "ins");
  InsDef ins;
  ins.horizontal_position = noise_at(node, "position_sensing/horizontal", context);
  ins.vertical_position = noise_at(node, "position_sensing/vertical", context);
  ins.horizontal_velocity = noise_at(node, "velocity_sensing/horizontal", context);
  ins.vertical_velocity = noise_at(node, "velocity_sensing/vertical", context);
  ins.attitude = noise_at(node, "orientation_sensing/attitude", context);
  ins.heading = noise_at(node, "orientation_sensing/heading", context);
  return ins;
}

std::optional<RfidDef> build_rfid(pugi::xml_node sensor, BuildContext& context) {
  const pugi::xml_node node = element_of(sensor, "rfid");
  RfidDef rfid;
  rfid.range = number_at(node, "range", rfid.range);
  rfid.angle = number_at(node, "angle", rfid.angle);
  rfid.needs_sight = bool_at(node, "line_of_sight", false);
  std::string wrong;
  if (!(rfid.range > 0 && rfid.range <= 1e4)) wrong = must(sensor, "range", "above 0 and at most 10000 m", rfid.range);
  if (!(rfid.angle > 0 && rfid.angle <= 2 * half_turn + 1e-3)) wrong = must(sensor, "angle", "above 0 and at most a turn", rfid.angle);
  if (wrong.empty()) return rfid;
  context.complaints.drop(sensor, wrong);
  return std::nullopt;
}

RfidTagDef build_rfid_tag(pugi::xml_node sensor) {
  const pugi::xml_node node = element_of(sensor, "rfidtag");
  return {text_below(node, "id"), text_below(node, "data")};
}

std::optional<RadioDef> build_radio(pugi::xml_node sensor, BuildContext& context) {
  const pugi::xml_node node = sensor.child("transceiver");
  RadioDef radio;
  radio.essid = text_at(node, "essid", radio.essid);
  radio.frequency = number_at(node, "frequency", radio.frequency);
  radio.min_frequency = number_at(node, "min_frequency", radio.min_frequency);
  radio.max_frequency = number_at(node, "max_frequency", radio.max_frequency);
  radio.gain = number_at(node, "gain", radio.gain);
  radio.power = number_at(node, "power", radio.power);
  radio.sensitivity = number_at(node, "sensitivity", radio.sensitivity);
  std::string wrong;
  if (!(radio.frequency > 0)) wrong = must(sensor, "frequency", "positive", radio.frequency);
  if (!(radio.min_frequency <= radio.max_frequency)) wrong = must(sensor, "lowest frequency", "at most the highest", radio.min_frequency);
  if (wrong.empty()) return radio;
  context.complaints.drop(sensor, wrong);
  return std::nullopt;
}

std::optional<WheelsDef> build_wheels(pugi::xml_node sensor, BuildContext& context) {
  const pugi::xml_node node = element_of(sensor, "wheel_encoders");
  WheelsDef wheels;
  for (const pugi::xml_node joint : node.children("joint")) wheels.joints.push_back(text_of(joint));
  wheels.ticks = number_at(node, "ticks", wheels.ticks) * number_at(node, "gear_ratio", 1);
  std::string wrong;
  if (wheels.joints.empty() || wheels.joints.size() > 256)
    wrong = must(sensor, "number of <joint>", "from 1 to 256", static_cast<double>(wheels.joints.size()));
  if (!(wheels.ticks > 0 && wheels.ticks <= 1e9)) wrong = must(sensor, "ticks in a turn", "above 0 and at most 1e9", wheels.ticks);
  if (wrong.empty()) return wheels;
  context.complaints.drop(sensor, wrong);
  return std::nullopt;
}

std::optional<LocalizationDef> build_localization(pugi::xml_node sensor, BuildContext& context) {
  const pugi::xml_node node = element_of(sensor, "localization");
  LocalizationDef localization;
  localization.position = noise_at(node, "position", context);
  localization.heading = noise_at(node, "heading", context);
  localization.hypotheses = integer_at(node, "hypotheses", 1);
  if (localization.hypotheses >= 1 && localization.hypotheses <= 64) return localization;
  context.complaints.drop(sensor, must(sensor, "number of hypotheses", "from 1 to 64", localization.hypotheses));
  return std::nullopt;
}

}  // namespace sim
