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
  bool is_good = true;
  const auto take = [&](double& number, const char* element) {
    if (!plugin.child(element)) return;
    const auto read = base::parse_number(text_at(plugin, element));
    is_good = is_good && read;
    number = read.value_or(number);
  };
  if (plugin.child("temperature")) {
    take(heat.lowest, "temperature");
    heat.highest = heat.lowest;
  } else {
    heat.signature = text_at(plugin, "heat_signature");
    take(heat.lowest, "min_temp"), take(heat.highest, "max_temp");
    if (!heat.signature.starts_with('/')) heat.signature.clear();  // which has been reported
  }
  if (is_good && heat.lowest >= coldest && heat.highest >= heat.lowest && heat.highest <= hottest) {
    visual.heat = heat;
    return;
  }
  const std::string low = text_at(plugin, "min_temp", base::format_number(heat.lowest)),
                    high = text_at(plugin, "max_temp", base::format_number(heat.highest));
  complaints.warn(plugin, "temperature of " + describe_in_context(plugin.parent()) + " must be from 0 to 100000 K, got " +
                              base::in_quotes(text_at(plugin, "temperature", low + " to " + high)) + "; it is as warm as the air");
}

// The plugins of the visual itself: Label and Thermal.
void read_visual_plugins(pugi::xml_node node, VisualDef& visual, Complaints& complaints) {
  for (const pugi::xml_node plugin : node.children("plugin")) {
    const PluginKind kind = kind_of_plugin(plugin.attribute("filename").value(), plugin.attribute("name").value());
    if (kind == PluginKind::label) read_label(plugin, visual, complaints);
    if (kind == PluginKind::thermal) read_heat(plugin, visual, complaints);
    if (kind == PluginKind::unknown)
      complaints.warn(plugin, "unknown plugin " + base::in_quotes(plugin.attribute("filename").value()) + " (" +
                                  describe_in_context(plugin) + ") is ignored");
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

void read_thermal_sensor(pugi::xml_node node, const PluginDef& plugin, ThermalDef& thermal, Complaints& complaints) {
  const ParameterNode& p = plugin.parameters;
  thermal.resolution = p.number_of({"resolution"}).value_or(thermal.resolution);
  const auto say = [&](const std::string& what) { complaints.warn(node, what + " (" + describe_in_context(node) + ")"); };
  if (const double finest = thermal.is_wide ? 1e-6 : 1; thermal.resolution < finest) {
    say("<resolution> must be " + base::format_number(finest) + " K or more with " + (thermal.is_wide ? "16" : "8") + " bits, got " +
        base::format_number(thermal.resolution) + "; that is taken");
    thermal.resolution = finest;
  }
  const double most = thermal.resolution * (thermal.is_wide ? 65535 : 255);
  const double low = p.number_of({"min_temp"}).value_or(0), high = p.number_of({"max_temp"}).value_or(most);
  thermal.lowest = low, thermal.highest = std::min(high, most);
  if (low < thermal.highest) return;
  thermal.lowest = 0, thermal.highest = most;
  say("<min_temp> must be less than <max_temp> and " + base::format_number(most) + " K, the highest that it can show, got " +
      base::format_number(low) + " and " + base::format_number(high) + "; all that it can show is taken");
}

}  // namespace sim
