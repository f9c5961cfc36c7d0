#include "world/visual_builder.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "world/model_builder.h"
#include "world/plugin_kind.h"
#include "world/xml_file.h"
#include "world/xml_values.h"

namespace sim {
namespace {

constexpr double coldest = 0, hottest = 1e5;  // [K]

void read_label(pugi::xml_node plugin, VisualDef& visual, Complaints& complaints) {
  const double label = number_at(plugin, "label", -1);
  if (label >= 0 && label <= 255 && label == std::floor(label)) {
    visual.label = static_cast<std::uint8_t>(label);
    return;
  }
  complaints.warn(plugin, "label of " + describe_in_context(plugin.parent()) + " must be a whole number from 0 to 255, got " +
                              base::in_quotes(text_at(plugin, "label")) + "; it has none");
}

void read_heat(pugi::xml_node plugin, VisualDef& visual, Complaints& complaints) {
  HeatDef heat;
  if (plugin.child("temperature")) {
    heat.lowest = heat.highest = number_at(plugin, "temperature", heat.lowest);
  } else {
    heat.signature = text_at(plugin, "heat_signature");
    heat.lowest = number_at(plugin, "min_temp", heat.lowest);
    heat.highest = number_at(plugin, "max_temp", heat.highest);
    if (!heat.signature.starts_with('/')) heat.signature.clear();  // which has been reported
  }
  const bool is_good = heat.lowest >= coldest && heat.highest >= heat.lowest && heat.highest <= hottest;
  if (is_good) {
    visual.heat = heat;
    return;
  }
  complaints.warn(plugin, "temperature of " + describe_in_context(plugin.parent()) + " must be from 0 to 100000 K, got " +
                              base::format_number(heat.lowest) + " to " + base::format_number(heat.highest) + "; it is as warm as the air");
}

// The plugins Label and Thermal of the visual itself.
void read_visual_plugins(pugi::xml_node node, VisualDef& visual, Complaints& complaints) {
  for (const pugi::xml_node plugin : node.children("plugin")) {
    const PluginKind kind = kind_of_plugin(plugin.attribute("filename").value(), plugin.attribute("name").value());
    if (kind == PluginKind::label) read_label(plugin, visual, complaints);
    if (kind == PluginKind::thermal) read_heat(plugin, visual, complaints);
  }
}

}  // namespace

std::optional<VisualDef> build_visual(pugi::xml_node node, BuildContext& context) {
  std::optional<GeometryDef> geometry = build_geometry(node.child("geometry"), context);
  if (!geometry) return std::nullopt;
  VisualDef visual;
  visual.name = node.attribute("name").value();
  visual.pose = pose_at(node, "pose") * ground_in_shape(node.child("geometry"), *geometry);
  visual.geometry = std::move(*geometry);
  if (const pugi::xml_node material = node.child("material")) visual.material = context.materials.read(material);
  visual.transparency = std::clamp(number_at(node, "transparency", 0), 0.0, 1.0);
  visual.cast_shadows = bool_at(node, "cast_shadows", true);
  visual.laser_retro = number_at(node, "laser_retro", 0);
  visual.visibility_flags = static_cast<std::uint32_t>(std::strtoul(text_at(node, "visibility_flags", "4294967295").c_str(), nullptr, 0));
  read_visual_plugins(node, visual, context.complaints);
  return visual;
}

std::uint8_t label_of(const std::vector<PluginDef>& plugins, const std::string& scope) {
  for (const PluginDef& plugin : plugins) {
    if (plugin.scope != scope || kind_of(plugin) != PluginKind::label) continue;
    const double label = plugin.parameters.number_of({"label"}).value_or(0);
    if (label >= 0 && label <= 255) return static_cast<std::uint8_t>(label);
  }
  return 0;
}

void inherit_labels(ModelDef& model) {
  const bool has_any = std::ranges::any_of(model.plugins, [](const PluginDef& plugin) { return kind_of(plugin) == PluginKind::label; });
  for (LinkDef& link : model.links) {
    for (VisualDef& visual : link.visuals) {
      if (visual.label != 0) visual.labelled = link.name + "::" + visual.name;
      std::string scope = link.scope;
      while (has_any && visual.label == 0) {
        visual.label = label_of(model.plugins, scope);
        visual.labelled = scope;
        if (scope.empty()) break;
        const std::size_t border = scope.rfind("::");
        scope = border == std::string::npos ? "" : scope.substr(0, border);
      }
    }
  }
}

void read_thermal_sensor(const PluginDef& plugin, ThermalDef& thermal) {
  const auto positive = [&](const char* name, double usual) {
    const double value = plugin.parameters.number_of({name}).value_or(usual);
    return value > 0 && std::isfinite(value) ? value : usual;
  };
  thermal.resolution = positive("resolution", thermal.resolution);
  if (!thermal.is_wide) thermal.resolution = std::max(thermal.resolution, 1.0);
  const double most = thermal.resolution * (thermal.is_wide ? 65535 : 255);
  thermal.lowest = std::clamp(plugin.parameters.number_of({"min_temp"}).value_or(0), 0.0, most);
  thermal.highest = std::clamp(positive("max_temp", most), thermal.lowest, most);
}

}  // namespace sim
