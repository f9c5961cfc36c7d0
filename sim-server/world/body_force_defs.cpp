#include "world/body_force_defs.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/text.h"
#include "world/plugin_kind.h"
#include "world/xml_values.h"

namespace sim {
namespace {

constexpr std::string_view axes = "xyzkmn", rates = "UVWPQR";
constexpr double largest = 1e9;  // of a coefficient

template <class Parts>
std::optional<std::uint32_t> part_named(const Parts& parts, const std::string& scope, const std::string& name) {
  for (const std::string& full : {scope.empty() ? name : scope + "::" + name, name}) {
    for (std::uint32_t i = 0; i < parts.size(); ++i) {
      if (parts[i].name == full) return i;
    }
  }
  return std::nullopt;
}

std::string about(const PluginDef& plugin) { return plugin.source + ": plugin " + base::in_quotes(plugin.name) + ": "; }

// Its place among the letters, or -1.
int place_of(std::string_view letters, char letter) {
  const auto place = letters.find(letter);
  return place == std::string_view::npos ? -1 : static_cast<int>(place);
}

// "xU", "xDotU", "xUV", "xUabsV". False: it is none of these.
bool take_coefficient(HydrodynamicsDef& def, std::string_view name, double value) {
  const int to = name.empty() ? -1 : place_of(axes, name.front());
  const int last = name.empty() ? -1 : place_of(rates, name.back());
  if (to < 0 || last < 0) return false;
  name.remove_prefix(1), name.remove_suffix(1);
  if (name.empty()) return def.linear(to, last) = value, true;
  if (name == "Dot") return def.added(to, last) = value, true;
  const int by = place_of(rates, name.front());
  name.remove_prefix(1);
  if (by < 0 || !(name.empty() || name == "abs")) return false;
  // <xUU> was <xUabsU> once. Without the amount it would push a body that goes backwards.
  if (value != 0) def.quadratic.push_back({to, by, last, !name.empty() || by == last, value});
  return true;
}

// VRX's plugin: its numbers are positive, and its added mass has no Coriolis forces.
bool is_simple(const PluginDef& plugin) {
  std::string name = base::to_lower(plugin.filename + " " + plugin.name);
  std::erase(name, '_');
  return name.find("simplehydrodynamics") != std::string::npos;
}

// What VRX's plugin does where its file has no number, in Fossen's signs.
void take_defaults_of_simple(HydrodynamicsDef& def) {
  def.linear.diagonal().setConstant(-20);
  def.added.diagonal() << -5, -5, -0.1, -0.1, -0.1, -1;
  def.has_coriolis = false;
}

std::optional<HydrodynamicsDef> hydrodynamics_of_plugin(const ModelDef& model, const PluginDef& plugin,
                                                        std::vector<std::string>& left_out) {
  const auto link = link_of_plugin(model, plugin, left_out);
  if (!link) return std::nullopt;
  HydrodynamicsDef def;
  def.link = *link;
  if (is_simple(plugin)) take_defaults_of_simple(def);
  for (const ParameterNode& child : plugin.parameters.children) {
    const auto value = base::parse_number(child.text);
    if (!take_coefficient(def, child.name, is_simple(plugin) ? -value.value_or(0) : value.value_or(0)) ||
        (value && std::abs(*value) <= largest))
      continue;
    left_out.push_back(about(plugin) + "<" + child.name + "> must be a number within 1e9, got " + base::in_quotes(child.text) +
                       "; the plugin is left out");
    return std::nullopt;
  }
  def.current = vector_of(plugin.parameters, "default_current", def.current);
  def.has_coriolis = def.has_coriolis && !plugin.parameters.bool_of({"disable_coriolis"}).value_or(false);
  if (plugin.parameters.bool_of({"disable_added_mass"}).value_or(false)) def.added.setZero();
  return def;
}

// True: there were some on the diagonals that drive.
bool turn_signs(HydrodynamicsDef& def) {
  bool has_turned = false;
  const auto turn = [&](double& number) {
    has_turned = has_turned || number > 0;
    number = -std::abs(number);
  };
  for (int i = 0; i < 6; ++i) turn(def.linear(i, i)), turn(def.added(i, i));
  for (auto& product : def.quadratic) {
    if (product.to == product.by && product.by == product.with) turn(product.value);
  }
  return has_turned;
}

// No motion of the link has a negative energy.
bool is_possible(const Matrix6& added) {
  const Matrix6 mass = -0.5 * (added + added.transpose());
  const Vector6 energies = Eigen::SelfAdjointEigenSolver<Matrix6>(mass, Eigen::EigenvaluesOnly).eigenvalues();
  return energies.minCoeff() >= -1e-9 * energies.cwiseAbs().maxCoeff();
}

std::optional<WingDef> wing_of_plugin(const ModelDef& model, const PluginDef& plugin, std::vector<std::string>& left_out) {
  const auto link = link_of_plugin(model, plugin, left_out);
  if (!link) return std::nullopt;
  const ParameterNode& p = plugin.parameters;
  WingDef wing;
  wing.link = *link;
  const auto take = [&](double& number, const char* name) { number = std::clamp(p.number_of({name}).value_or(number), -largest, largest); };
  take(wing.a0, "a0"), take(wing.stall, "alpha_stall");
  take(wing.lift, "cla"), take(wing.drag, "cda");
  take(wing.lift_stalled, "cla_stall"), take(wing.drag_stalled, "cda_stall");
  take(wing.area, "area"), take(wing.density, "air_density");
  take(wing.lift_by_joint, "control_joint_rad_to_cl");
  wing.is_radial = p.bool_of({"radial_symmetry"}).value_or(false);
  wing.center = vector_of(p, "cp", wing.center);
  wing.forward = vector_of(p, "forward", wing.forward), wing.upward = vector_of(p, "upward", wing.upward);
  if (!are_two_directions(wing.forward, wing.upward)) {
    left_out.push_back(about(plugin) + "<forward> and <upward> must be two directions, got " +
                       base::in_quotes(p.text_of({"forward"}).value_or("1 0 0")) + " and " +
                       base::in_quotes(p.text_of({"upward"}).value_or("0 0 1")) + "; the plugin is left out");
    return std::nullopt;
  }
  wing.forward.normalize(), wing.upward.normalize();
  if (const auto name = p.text_of({"control_joint_name"})) {
    wing.control_joint = joint_named(model, plugin.scope, *name);
    if (!wing.control_joint) {
      left_out.push_back(about(plugin) + "model " + base::in_quotes(model.name) + " has no joint " + base::in_quotes(*name) +
                         "; the plugin is left out");
      return std::nullopt;
    }
  }
  return wing;
}

template <class Def, class Read>
std::vector<Def> all_of(const ModelDef& model, PluginKind kind, std::vector<std::string>& left_out, const Read& read) {
  std::vector<Def> all;
  for (const PluginDef& plugin : model.plugins) {
    if (kind_of(plugin) != kind) continue;
    if (const auto def = read(model, plugin, left_out)) all.push_back(*def);
  }
  return all;
}

}  // namespace

std::optional<std::uint32_t> link_named(const ModelDef& model, const std::string& scope, const std::string& name) {
  return part_named(model.links, scope, name);
}
std::optional<std::uint32_t> joint_named(const ModelDef& model, const std::string& scope, const std::string& name) {
  return part_named(model.joints, scope, name);
}

std::optional<std::uint32_t> link_of_plugin(const ModelDef& model, const PluginDef& plugin, std::vector<std::string>& left_out) {
  const auto name = plugin.parameters.text_of({"link_name"});
  const auto link = name ? link_named(model, plugin.scope, *name) : std::nullopt;
  if (!link) {
    left_out.push_back(
        about(plugin) +
        (name ? "model " + base::in_quotes(model.name) + " has no link " + base::in_quotes(*name) : "expected a <link_name>") +
        "; the plugin is left out");
  } else if (model.is_static) {
    left_out.push_back(about(plugin) + "model " + base::in_quotes(model.name) + " is static and cannot move; the plugin is left out");
    return std::nullopt;
  }
  return link;
}

bool are_two_directions(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return a.cross(b).norm() > 1e-6 * a.norm() * b.norm() && !a.isZero() && !b.isZero();
}

Eigen::Vector3d vector_of(const ParameterNode& parameters, std::string_view name, const Eigen::Vector3d& fallback) {
  const auto text = parameters.text_of({name});
  const auto numbers = text ? parse_numbers(*text) : std::nullopt;
  if (!numbers || numbers->size() != 3) return fallback;
  const Eigen::Vector3d vector((*numbers)[0], (*numbers)[1], (*numbers)[2]);
  return vector.allFinite() && vector.cwiseAbs().maxCoeff() <= largest ? vector : fallback;
}

std::vector<StandingWrench> standing_wrenches_of(const WorldDef& world, std::vector<std::string>& left_out) {
  std::vector<StandingWrench> wrenches;
  for (const PluginDef& plugin : world.plugins) {
    if (kind_of(plugin) != PluginKind::link_wrench) continue;
    for (const ParameterNode& one : plugin.parameters.children) {
      if (one.name != "persistent") continue;
      const std::string type = one.text_of({"entity_type"}).value_or("model"), name = one.text_of({"entity_name"}).value_or("");
      if (name.empty() || (type != "model" && type != "link")) {
        left_out.push_back(plugin.source + ": <persistent> needs an <entity_name> and an <entity_type> model or link, got " +
                           base::in_quotes(name) + " and " + base::in_quotes(type) + "; it pushes nothing");
        continue;
      }
      wrenches.push_back(
          {name, vector_of(one, "force", Eigen::Vector3d::Zero()), vector_of(one, "torque", Eigen::Vector3d::Zero()), plugin.source});
    }
  }
  return wrenches;
}

WindDef wind_of(const WorldDef& world, std::vector<std::string>& left_out) {
  WindDef wind;
  wind.velocity = world.physics.wind;
  const ParameterNode none;
  const auto part = [&](const ParameterNode& node, std::string_view name) -> const ParameterNode& {
    const ParameterNode* child = node.child(name);
    return child != nullptr ? *child : none;
  };
  for (const PluginDef& plugin : world.plugins) {
    if (kind_of(plugin) != PluginKind::wind_effects) continue;
    const ParameterNode &horizontal = part(plugin.parameters, "horizontal"), &vertical = part(plugin.parameters, "vertical");
    const ParameterNode &magnitude = part(horizontal, "magnitude"), &direction = part(horizontal, "direction");
    wind.rises = true;
    wind.scale = plugin.parameters.number_of({"force_approximation_scaling_factor"}).value_or(1);
    wind.time = magnitude.number_of({"time_for_rise"}).value_or(1);
    wind.vertical_time = vertical.number_of({"time_for_rise"}).value_or(1);
    wind.amplitude = part(magnitude, "sin").number_of({"amplitude_percent"}).value_or(0);
    wind.period = part(magnitude, "sin").number_of({"period"}).value_or(1);
    wind.swing = part(direction, "sin").number_of({"amplitude"}).value_or(0) * std::numbers::pi / 180;
    wind.swing_period = part(direction, "sin").number_of({"period"}).value_or(1);
    for (const ParameterNode* with_noise : {&magnitude, &direction, &vertical}) {
      const ParameterNode& noise = part(*with_noise, "noise");
      if (noise.number_of({"stddev"}).value_or(0) == 0 && noise.number_of({"mean"}).value_or(0) == 0) continue;
      left_out.push_back(about(plugin) + "its <noise> is not simulated");
      break;
    }
  }
  return wind;
}

std::vector<HydrodynamicsDef> hydrodynamics_of(const ModelDef& model, std::vector<std::string>& left_out, std::vector<std::string>& notes) {
  std::vector<HydrodynamicsDef> all;
  for (const PluginDef& plugin : model.plugins) {
    if (kind_of(plugin) != PluginKind::hydrodynamics) continue;
    auto def = hydrodynamics_of_plugin(model, plugin, left_out);
    if (!def) continue;
    if (turn_signs(*def)) {
      const char *found = is_simple(plugin) ? "negative" : "positive", *taken = is_simple(plugin) ? "positive" : "negative";
      notes.push_back("model " + base::in_quotes(model.name) + ": Hydrodynamics of link " + base::in_quotes(model.links[def->link].name) +
                      ": " + found + " damping or added mass would drive the link; the numbers are taken as " + taken);
    }
    all.push_back(std::move(*def));
  }
  for (std::uint32_t link = 0; link < model.links.size(); ++link) {
    const LinkDef& def = model.links[link];
    if (!def.added_mass) continue;
    auto of_link = std::find_if(all.begin(), all.end(), [link](const HydrodynamicsDef& one) { return one.link == link; });
    if (of_link == all.end()) {
      all.emplace_back();
      of_link = all.end() - 1;
      of_link->link = link;
    }
    // From the centre of mass to the origin.
    Matrix6 to_center = Matrix6::Identity();
    const Eigen::Vector3d& c = def.center_of_mass;
    to_center.topRightCorner<3, 3>() << 0, c.z(), -c.y(), -c.z(), 0, c.x(), c.y(), -c.x(), 0;
    of_link->added -= to_center.transpose() * *def.added_mass * to_center;
  }
  for (HydrodynamicsDef& def : all) {
    if (is_possible(def.added)) continue;
    left_out.push_back("model " + base::in_quotes(model.name) + ": added mass of link " + base::in_quotes(model.links[def.link].name) +
                       ": it must be positive in every direction, and its cross terms are too large for that; the added mass is left out");
    def.added.setZero();
  }
  for (const PluginDef& plugin : model.plugins) {
    if (kind_of(plugin) != PluginKind::lighter_than_air) continue;
    const auto link = link_named(model, plugin.scope, plugin.parameters.text_of({"link_name"}).value_or(""));
    for (HydrodynamicsDef& def : all) def.has_munk = def.has_munk && def.link != link;
  }
  return all;
}
std::vector<WingDef> wings_of(const ModelDef& model, std::vector<std::string>& left_out) {
  return all_of<WingDef>(model, PluginKind::lift_drag, left_out, wing_of_plugin);
}

}  // namespace sim
