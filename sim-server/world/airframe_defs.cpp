#include "world/airframe_defs.h"

#include <array>
#include <cmath>

#include "base/result.h"
#include "base/text.h"
#include "world/plugin_kind.h"

namespace sim {
namespace {

constexpr std::array<std::string_view, 6> row_names{"CD", "CY", "CL", "Cell", "Cem", "Cen"}, column_names{"0", "a", "b", "p", "q", "r"};

// Those that gz-sim knows: drag has no derivative by an angle, and only drag, lift and pitch have a value at zero.
bool is_coefficient(int row, int column) {
  if (row == AirframeDef::drag) return column != AirframeDef::by_alpha && column != AirframeDef::by_beta;
  return column != AirframeDef::at_zero || row == AirframeDef::lift || row == AirframeDef::pitch;
}

base::Error airframe_error(const PluginDef& plugin, const std::string& what) {
  return base::Error{plugin.source + ": plugin " + base::in_quotes(plugin.name) + ": " + what + "; the plugin is left out"};
}

// A coefficient within what makes sense; 0 where there is none. The first that is wrong is named in `problem`.
double coefficient_of(const ParameterNode& parameters, const std::string& element, std::string& problem) {
  constexpr double largest = 1e9;
  const auto text = parameters.text_of({element});
  if (!text) return 0;
  const auto number = base::parse_number(*text);
  if (number && std::abs(*number) <= largest) return *number;
  if (problem.empty()) problem = "<" + element + "> must be a number within 1e9, got " + base::in_quotes(*text);
  return 0;
}

// One that a plugin needs.
double positive_of(const ParameterNode& parameters, const std::string& element, std::string& problem) {
  const auto text = parameters.text_of({element});
  const double number = coefficient_of(parameters, element, problem);
  if (number > 0 || !problem.empty()) return number;
  problem = text ? "<" + element + "> must be a positive number, got " + base::in_quotes(*text) : "expected a <" + element + ">";
  return 0;
}

base::Result<void> add_surfaces(const ModelDef& model, const PluginDef& plugin, AirframeDef& def) {
  for (const ParameterNode& node : plugin.parameters.children) {
    if (node.name != "control_surface") continue;
    const std::string name = node.text_of({"name"}).value_or("");
    const auto joint = joint_named(model, plugin.scope, name);
    if (!joint) return airframe_error(plugin, "model " + base::in_quotes(model.name) + " has no joint " + base::in_quotes(name));
    AirframeDef::Surface surface{*joint};
    const double direction = node.number_of({"direction"}).value_or(1);
    std::string problem;
    for (int row = 0; row < 6; ++row)
      surface.effect[row] = direction * coefficient_of(node, std::string(row_names[static_cast<std::size_t>(row)]) + "_ctrl", problem);
    if (!problem.empty()) return airframe_error(plugin, problem);
    def.surfaces.push_back(surface);
  }
  // As in gz-sim the first ones count, where there are more.
  const auto count = plugin.parameters.number_of({"num_ctrl_surfaces"});
  while (count && static_cast<double>(def.surfaces.size()) > *count) def.surfaces.pop_back();
  if (!count || *count <= static_cast<double>(def.surfaces.size())) return {};
  return airframe_error(plugin, "<num_ctrl_surfaces> must be at most the number of <control_surface>, which is " +
                                    std::to_string(def.surfaces.size()) + ", got " + base::format_number(*count));
}

base::Result<AirframeDef> airframe_of(const ModelDef& model, const PluginDef& plugin, std::uint32_t link) {
  const ParameterNode& p = plugin.parameters;
  AirframeDef def;
  def.link = link;
  std::string problem;
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 6; ++column) {
      const auto name = std::string(row_names[static_cast<std::size_t>(row)]) + std::string(column_names[static_cast<std::size_t>(column)]);
      if (is_coefficient(row, column)) def.coefficients(row, column) = coefficient_of(p, name, problem);
    }
  }
  def.aspect_ratio = positive_of(p, "AR", problem);
  def.efficiency = positive_of(p, "eff", problem);
  if (!problem.empty()) return airframe_error(plugin, problem);
  def.stall = p.number_of({"alpha_stall"}).value_or(def.stall);
  def.pitch_stalled = p.number_of({"Cema_stall"}).value_or(0);
  def.area = p.number_of({"area"}).value_or(1);
  def.density = p.number_of({"air_density"}).value_or(def.density);
  def.span = std::sqrt(def.area * def.aspect_ratio);
  def.chord = p.number_of({"mac"}).value_or(0);
  if (def.chord == 0) def.chord = def.area / def.span;
  def.center = vector_of(p, "cp", def.center);
  def.forward = vector_of(p, "forward", def.forward), def.upward = vector_of(p, "upward", def.upward);
  if (!are_two_directions(def.forward, def.upward)) return airframe_error(plugin, "<forward> and <upward> must be two directions");
  def.forward.normalize(), def.upward.normalize();
  if (auto added = add_surfaces(model, plugin, def); !added) return added.error();
  return def;
}

base::Result<AirshipDef> airship_of(const ModelDef&, const PluginDef& plugin, std::uint32_t link) {
  AirshipDef def;
  def.link = link;
  const ParameterNode& p = plugin.parameters;
  def.density = p.number_of({"air_density"}).value_or(def.density);
  struct Needed {
    const char* element;
    double& number;
  };
  for (const auto& [element, number] :
       {Needed{"force_inviscid_coeff", def.force_inviscid}, Needed{"force_viscous_coeff", def.force_viscous},
        Needed{"moment_inviscid_coeff", def.moment_inviscid}, Needed{"moment_viscous_coeff", def.moment_viscous},
        Needed{"eps_v", def.separation}, Needed{"axial_drag_coeff", def.axial_drag}}) {
    std::string problem;
    number = coefficient_of(p, element, problem);
    if (!problem.empty()) return airframe_error(plugin, problem);
    if (p.child(element) == nullptr) return airframe_error(plugin, "expected a <" + std::string(element) + ">");
  }
  if (def.axial_drag < 0)
    return airframe_error(plugin, "<axial_drag_coeff> must be a number of 0 or more, got " + base::format_number(def.axial_drag));
  return def;
}

base::Result<FloatingHullDef> floating_hull_of(const ModelDef&, const PluginDef& plugin, std::uint32_t link) {
  const ParameterNode& p = plugin.parameters;
  FloatingHullDef def;
  def.link = link;
  std::string problem;
  def.radius = positive_of(p, "hull_radius", problem), def.length = positive_of(p, "hull_length", problem);
  if (!problem.empty()) return airframe_error(plugin, problem);
  def.level = p.number_of({"fluid_level"}).value_or(0), def.density = p.number_of({"fluid_density"}).value_or(def.density);
  const ParameterNode* points = p.child("points");
  for (const ParameterNode& point : points != nullptr ? points->children : std::vector<ParameterNode>{}) {
    ParameterNode one;
    one.children = {point};
    def.points.push_back(vector_of(one, "point", Eigen::Vector3d::Constant(std::nan(""))));
    if (!def.points.back().allFinite()) return airframe_error(plugin, "<point> must be three numbers, got " + base::in_quotes(point.text));
  }
  if (def.points.empty()) return airframe_error(plugin, "expected <points> with a <point>");
  return def;
}

template <class Def>
std::vector<Def> defs_of(const ModelDef& model, PluginKind kind, std::vector<std::string>& left_out,
                         base::Result<Def> (*read)(const ModelDef&, const PluginDef&, std::uint32_t)) {
  std::vector<Def> all;
  for (const PluginDef& plugin : model.plugins) {
    if (kind_of(plugin) != kind) continue;
    const auto link = link_of_plugin(model, plugin, left_out);
    if (!link) continue;
    if (auto def = read(model, plugin, *link)) {
      all.push_back(std::move(*def));
    } else {
      left_out.push_back(def.error().message);
    }
  }
  return all;
}

}  // namespace

std::vector<AirframeDef> airframes_of(const ModelDef& model, std::vector<std::string>& left_out) {
  return defs_of(model, PluginKind::advanced_lift_drag, left_out, airframe_of);
}
std::vector<AirshipDef> airships_of(const ModelDef& model, std::vector<std::string>& left_out) {
  return defs_of(model, PluginKind::lighter_than_air, left_out, airship_of);
}

std::vector<FloatingHullDef> floating_hulls_of(const ModelDef& model, std::vector<std::string>& left_out, std::vector<std::string>& notes) {
  for (const PluginDef& plugin : model.plugins) {
    if (kind_of(plugin) != PluginKind::floating_hull || plugin.parameters.child("wavefield") == nullptr) continue;
    notes.push_back("model " + base::in_quotes(model.name) + ": the water of plugin " + base::in_quotes(plugin.name) + " has no waves");
    break;
  }
  return defs_of(model, PluginKind::floating_hull, left_out, floating_hull_of);
}

}  // namespace sim
