#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/text.h"
#include "world/model_builder.h"
#include "world/plugin_kind.h"
#include "world/visual_builder.h"
#include "world/xml_file.h"
#include "world/xml_values.h"

namespace sim {

std::optional<LightDef> build_light(pugi::xml_node node, BuildContext& context) {
  LightDef light;
  light.name = node.attribute("name").value();
  const std::string type = node.attribute("type") ? node.attribute("type").value() : "point";
  if (type == "directional" || type == "sun") {
    light.kind = LightDef::Kind::directional;
  } else if (type == "spot") {
    light.kind = LightDef::Kind::spot;
  } else if (type != "point") {
    context.complaints.drop(node,
                            "lights of type " + base::in_quotes(type) + " are not known; " + describe_in_context(node) + " is left out");
    return std::nullopt;
  }
  light.pose = pose_at(node, "pose");
  light.direction = vector3_at(node, "direction", light.direction).normalized();
  light.diffuse = color_at(node, "diffuse", light.diffuse);
  light.specular = color_at(node, "specular", light.specular);
  light.intensity = number_at(node, "intensity", 1);
  light.range = number_at(node, "attenuation/range", 10);
  light.constant_attenuation = number_at(node, "attenuation/constant", 1);
  light.linear_attenuation = number_at(node, "attenuation/linear", 1);
  light.quadratic_attenuation = number_at(node, "attenuation/quadratic", 0);
  light.inner_angle = number_at(node, "spot/inner_angle", 0);
  light.outer_angle = number_at(node, "spot/outer_angle", 0);
  light.falloff = number_at(node, "spot/falloff", 0);
  light.cast_shadows = bool_at(node, "cast_shadows", false);
  light.is_on = bool_at(node, "light_on", true);
  return light;
}

namespace {

pugi::xml_node default_physics(pugi::xml_node world, BuildContext& context) {
  pugi::xml_node chosen;
  for (pugi::xml_node physics : world.children("physics")) {
    if (!chosen || physics.attribute("default").as_bool()) chosen = physics;
  }
  const std::string type = chosen.attribute("type").value();
  if (!type.empty() && type != "ode" && type != "ignored" && type != "ignore") {
    context.complaints.note(chosen, "physics engine " + base::in_quotes(type) + " is not there; ODE is taken");
  }
  return chosen;
}

PhysicsDef build_physics(pugi::xml_node world, BuildContext& context) {
  const pugi::xml_node node = default_physics(world, context);
  PhysicsDef physics;
  const double step = number_at(node, "max_step_size", physics.step);
  if (step >= 1e-6 && step <= 1) {
    physics.step = step;
  } else {
    context.complaints.warn(node, "step size of the physics must be from 1e-06 s to 1 s, got " + base::format_number(step) + "; " +
                                      base::format_number(physics.step) + " s is taken");
  }
  physics.real_time_factor = number_at(node, "real_time_factor", 1);
  physics.gravity = vector3_at(world, "gravity", physics.gravity);
  physics.magnetic_field = vector3_at(world, "magnetic_field", physics.magnetic_field);
  physics.wind = vector3_at(world, "wind/linear_velocity", physics.wind);
  physics.max_contacts = std::clamp(integer_at(node, "max_contacts", 20), 1, 1000);
  const pugi::xml_node ode = node.child("ode");
  const std::string solver = text_at(ode, "solver/type");
  physics.solver = solver == "world"   ? PhysicsDef::Solver::exact
                   : solver == "quick" ? PhysicsDef::Solver::iterative
                                       : PhysicsDef::Solver::automatic;
  physics.iterations = std::clamp(integer_at(ode, "solver/iters", 50), 1, 10000);
  physics.sor = std::clamp(number_at(ode, "solver/sor", 1.3), 0.01, 2.0);
  const std::optional<double> cfm = number_at(ode, "constraints/cfm"), erp = number_at(ode, "constraints/erp");
  if (cfm && *cfm >= 0 && *cfm <= 1e6) physics.cfm = cfm;
  if (erp && *erp >= 0 && *erp <= 1) physics.erp = erp;
  physics.contact_max_correcting_vel = std::clamp(number_at(ode, "constraints/contact_max_correcting_vel", 100), 0.0, 1e6);
  physics.contact_surface_layer = std::clamp(number_at(ode, "constraints/contact_surface_layer", 0.001), 0.0, 1.0);
  physics.atmosphere_temperature = number_at(world, "atmosphere/temperature", physics.atmosphere_temperature);
  physics.atmosphere_pressure = number_at(world, "atmosphere/pressure", physics.atmosphere_pressure);
  return physics;
}

FluidDef build_fluid(pugi::xml_node element, const PluginDef& plugin, BuildContext& context) {
  const auto density_of = [](const ParameterNode& node, std::initializer_list<std::string_view> spellings) {
    return std::clamp(node.number_of(spellings).value_or(1000), 0.0, 1e6);
  };
  FluidDef fluid;
  fluid.density = density_of(plugin.parameters, {"uniform_fluid_density", "fluid_density"});
  if (const ParameterNode* graded = plugin.parameters.child("graded_buoyancy")) {
    fluid.density = density_of(*graded, {"default_density"});
    for (const ParameterNode& change : graded->children) {
      const auto above = change.number_of({"above_depth"});
      if (change.name != "density_change") continue;
      if (above) fluid.changes.emplace_back(*above, density_of(change, {"density"}));
      if (!above)
        context.complaints.warn(element,
                                describe_in_context(element) + ": a <density_change> needs a number <above_depth>; it is left out");
    }
    std::stable_sort(fluid.changes.begin(), fluid.changes.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  }
  for (const ParameterNode& child : plugin.parameters.children) {
    if (child.name == "enable") fluid.models.push_back(child.text.substr(0, child.text.find("::")));
  }
  return fluid;
}

SceneDef build_scene(pugi::xml_node node, BuildContext& context) {
  SceneDef scene;
  scene.ambient = color_at(node, "ambient", scene.ambient);
  scene.background = color_at(node, "background", scene.background);
  scene.shadows = bool_at(node, "shadows", true);
  scene.grid = bool_at(node, "grid", true);
  if (const pugi::xml_node sky = node.child("sky")) {
    scene.sky = SkyDef{number_at(sky, "time", 10), number_at(sky, "sunrise", 6), number_at(sky, "sunset", 20)};
  }
  if (const pugi::xml_node fog = node.child("fog")) {
    FogDef& out = scene.fog.emplace();
    out.type = text_at(fog, "type", "none");
    out.color = color_at(fog, "color", out.color);
    out.start = number_at(fog, "start", 1);
    out.end = number_at(fog, "end", 100);
    out.density = number_at(fog, "density", 1);
    if (out.type == "none") {
      scene.fog.reset();
    } else if (out.type != "linear" && out.type != "exponential" && out.type != "quadratic") {
      context.complaints.warn(fog, "fog of type " + base::in_quotes(out.type) +
                                       " is unknown, expected none, linear, exponential or quadratic; the world has no fog");
      scene.fog.reset();
    }
  }
  return scene;
}

SphericalDef build_spherical(pugi::xml_node node, BuildContext& context) {
  SphericalDef out;
  const auto angle = [&](const char* key, double most) {
    const double value = number_at(node, key, 0);
    if (std::abs(value) <= most) return value;
    context.complaints.warn(
        node, std::string(key) + " must be within " + base::format_number(most) + ", got " + base::format_number(value) + "; 0 is taken");
    return 0.0;
  };
  out.latitude = angle("latitude_deg", 90);
  out.longitude = angle("longitude_deg", 360);
  out.heading = angle("heading_deg", 360) * std::numbers::pi / 180;
  out.elevation = angle("elevation", 1e6);
  return out;
}

TrajectoryDef build_trajectory(pugi::xml_node node, BuildContext& context) {
  TrajectoryDef trajectory;
  trajectory.id = node.attribute("id").as_int();
  trajectory.animation = node.attribute("type").value();
  trajectory.tension = std::clamp(node.attribute("tension").as_double(0), 0.0, 1.0);
  for (pugi::xml_node waypoint : node.children("waypoint")) {
    trajectory.waypoints.push_back({number_at(waypoint, "time", 0), pose_at(waypoint, "pose")});
  }
  const auto earlier = [](const WaypointDef& a, const WaypointDef& b) { return a.time < b.time; };
  if (!std::is_sorted(trajectory.waypoints.begin(), trajectory.waypoints.end(), earlier)) {
    context.complaints.warn(node, "way points of " + describe_in_context(node) + " must ascend in time; they are sorted");
    std::stable_sort(trajectory.waypoints.begin(), trajectory.waypoints.end(), earlier);
  }
  return trajectory;
}

ActorDef build_actor(pugi::xml_node node, BuildContext& context) {
  ActorDef actor;
  actor.name = node.attribute("name").value();
  actor.pose = pose_at(node, "pose");
  actor.skin = text_at(node, "skin/filename");
  if (!actor.skin.starts_with('/')) actor.skin.clear();
  actor.skin_scale = number_at(node, "skin/scale", 1);
  if (actor.skin_scale == 0) {
    context.complaints.warn(node, "the scale of the skin of " + describe(node) + " must not be 0; 1 is taken");
    actor.skin_scale = 1;
  }
  actor.loop = bool_at(node, "script/loop", true);
  actor.auto_start = bool_at(node, "script/auto_start", true);
  actor.delay_start = number_at(node, "script/delay_start", 0);
  for (pugi::xml_node link : node.children("link")) {
    for (pugi::xml_node visual : link.children("visual")) {
      if (std::optional<VisualDef> built = build_visual(visual, context)) {
        built->pose = pose_at(link, "pose") * built->pose;
        actor.visuals.push_back(std::move(*built));
      }
    }
  }
  for (pugi::xml_node animation : node.children("animation")) {
    const std::string path = text_at(animation, "filename");
    if (!path.starts_with('/')) continue;
    actor.animations.push_back(
        {animation.attribute("name").value(), path, number_at(animation, "scale", 1), bool_at(animation, "interpolate_x", false)});
  }
  for (pugi::xml_node trajectory : node.child("script").children("trajectory"))
    actor.trajectories.push_back(build_trajectory(trajectory, context));
  for (const auto& trajectory : actor.trajectories) {
    const bool is_known = std::any_of(actor.animations.begin(), actor.animations.end(),
                                      [&](const AnimationDef& animation) { return animation.name == trajectory.animation; });
    if (!is_known && !actor.animations.empty() && !trajectory.animation.empty())
      context.complaints.warn(node, describe(node) + " has no animation " + base::in_quotes(trajectory.animation) +
                                        ", which a trajectory names; its limbs keep still meanwhile");
  }
  for (pugi::xml_node plugin : node.children("plugin")) actor.plugins.push_back(build_plugin(plugin, {}, context));
  actor.label = label_of(actor.plugins, {});
  actor.source = context.complaints.place_of(node).text();
  if (actor.skin.empty() && actor.visuals.empty())
    context.complaints.warn(node, describe(node) + " has neither a skin nor a visual and cannot be seen");
  return actor;
}

}  // namespace

WorldDef build_world(pugi::xml_node node, const ResolvedWorld& resolved, BuildContext& context) {
  const auto placed = [&](pugi::xml_node thing, Eigen::Isometry3d& pose) {
    const auto frame = resolved.frames.find(thing.attribute(frame_of_pose_mark).value());
    if (frame != resolved.frames.end()) pose = frame->second;
  };
  WorldDef world;
  world.name = node.attribute("name").value();
  if (world.name.empty()) world.name = "default";
  world.physics = build_physics(node, context);
  world.scene = build_scene(node.child("scene"), context);
  world.spherical = build_spherical(node.child("spherical_coordinates"), context);
  for (pugi::xml_node child : node.children("light")) {
    if (std::optional<LightDef> light = build_light(child, context)) {
      placed(child, light->pose);
      world.lights.push_back(std::move(*light));
    }
  }
  for (pugi::xml_node child : node.children("actor")) {
    world.actors.push_back(build_actor(child, context));
    placed(child, world.actors.back().pose);
  }
  for (pugi::xml_node child : node.children("plugin")) {
    world.plugins.push_back(build_plugin(child, {}, context));
    if (kind_of(world.plugins.back()) != PluginKind::buoyancy) continue;
    if (world.physics.fluid)
      context.complaints.warn(child, describe_in_context(child) + " is the second one that fills the world; the last one counts");
    world.physics.fluid = build_fluid(child, world.plugins.back(), context);
  }
  if (const pugi::xml_node camera = child_at(node, "gui/camera/pose")) world.gui_camera = parse_pose(camera);
  return world;
}

}  // namespace sim
