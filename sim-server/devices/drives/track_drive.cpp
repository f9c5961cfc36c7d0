// Tracks: belts round links that move what they touch. A vehicle has some on each side, flippers among them; in a curve friction acts
// along the circles about its centre, as gz-sim has it, so that tracks do not scrub. A belt alone is a conveyor. The encoders of tracks
// are their belts, which follow the command exactly.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "devices/drives/drive_train.h"
#include "world/plugin_kind.h"
#include "world/xml_values.h"

namespace sim {
namespace {

struct Limits {
  double low = -1000, high = 1000;            // [m/s], [rad/s]
  double brake = -infinite, push = infinite;  // [m/s^2], [rad/s^2]
};

struct Track {
  std::uint32_t link = 0;
  Eigen::Vector3d axis{0, 1, 0};  // in the link
};

struct TrackSettings {
  std::vector<Track> left, right;
  std::uint32_t body = 0;        // link
  double separation = 1;         // [m]
  double efficiency = 0.5;       // of steering
  Limits belt, linear, angular;  // of each belt; of the vehicle
  double rate = 0;               // of samples [Hz]; 0: every step
  bool is_vehicle = true;        // else one belt, which does not turn anything
};

void read_limits(const ParameterNode& p, Limits& limits) {
  if (const auto value = p.number_of({"min_velocity"})) limits.low = std::min(*value, 0.0);
  if (const auto value = p.number_of({"max_velocity"})) limits.high = std::max(*value, 0.0);
  if (const auto value = p.number_of({"min_acceleration"}); value && *value < 0) limits.brake = *value;
  if (const auto value = p.number_of({"max_acceleration"}); value && *value > 0) limits.push = *value;
}

// <track_orientation>: roll, pitch and yaw of the track in its link.
Eigen::Vector3d belt_axis(const ParameterNode& p) {
  const auto numbers = parse_numbers(p.text_of({"track_orientation"}).value_or(""));
  if (!numbers || numbers->size() != 3) return Eigen::Vector3d::UnitY();
  const Eigen::Vector3d angles(numbers->data());
  if (!angles.allFinite()) return Eigen::Vector3d::UnitY();
  return (Eigen::AngleAxisd(angles.z(), Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(angles.y(), Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(angles.x(), Eigen::Vector3d::UnitX())) *
         Eigen::Vector3d::UnitY();
}

base::Result<void> add_tracks(const ModelDef& model, const PluginDef& vehicle, const char* side, TrackSettings& s,
                              std::vector<Track>& tracks) {
  for (const std::string& name : tracks_of(vehicle, side)) {
    const auto link = link_of(model, vehicle.scope, name);
    if (!link) return drive_error(model, vehicle, "the model has no link " + base::in_quotes(name));
    Track track{*link};
    for (const PluginDef& plugin : model.plugins) {
      if (kind_of(plugin) != PluginKind::track_controller || plugin.scope != vehicle.scope) continue;
      if (plugin.parameters.text_of({"link"}) != name) continue;
      track.axis = belt_axis(plugin.parameters);
      read_limits(plugin.parameters, s.belt);
    }
    tracks.push_back(track);
  }
  if (tracks.empty()) return drive_error(model, vehicle, "it needs tracks on both sides (left_track, right_track)");
  return {};
}

// The distance of the middles of the first tracks, across the model.
double distance_of_tracks(const ModelDef& model, const TrackSettings& s) {
  return std::abs(model.links[s.left[0].link].pose.translation().y() - model.links[s.right[0].link].pose.translation().y());
}

base::Result<TrackSettings> vehicle_settings_of(const ModelDef& model, const PluginDef& plugin) {
  const ParameterNode& p = plugin.parameters;
  TrackSettings s;
  for (const auto& [side, tracks] : {std::pair{"left_track", &s.left}, {"right_track", &s.right}}) {
    if (auto added = add_tracks(model, plugin, side, s, *tracks); !added) return added.error();
  }
  // Flippers of Gazebo classic.
  for (const auto& [name, tracks] : {std::pair{"left_flipper", &s.left}, {"right_flipper", &s.right}}) {
    if (p.child(name) == nullptr) continue;
    if (auto added = add_tracks(model, plugin, name, s, *tracks); !added) return added.error();
  }
  const std::string body = p.text_of({"body_link", "body"}).value_or("");
  const auto link = body.empty() ? link_of(model, {}, model.canonical_link) : link_of(model, plugin.scope, body);
  if (!link) return drive_error(model, plugin, "the model has no link " + base::in_quotes(body));
  s.body = *link;
  s.separation = p.number_of({"tracks_separation"}).value_or(distance_of_tracks(model, s));
  s.efficiency = p.number_of({"steering_efficiency"}).value_or(0.5);
  if (const auto problem = size_problem("tracks_separation", s.separation); !problem.empty()) return drive_error(model, plugin, problem);
  if (!(s.efficiency >= 0.001 && s.efficiency <= 1000))
    return drive_error(model, plugin, fmt::format("steering_efficiency must be from 0.001 to 1000, got {}", s.efficiency));
  if (const ParameterNode* linear = p.child("linear_velocity")) read_limits(*linear, s.linear);
  if (const ParameterNode* angular = p.child("angular_velocity")) read_limits(*angular, s.angular);
  if (const auto most = p.number_of({"max_linear_speed"}); most && *most > 0) s.linear.low = -*most, s.linear.high = *most;
  if (const auto most = p.number_of({"max_angular_speed"}); most && *most > 0) s.angular.low = -*most, s.angular.high = *most;
  s.rate = std::max(0.0, p.number_of({"odom_publish_frequency", "odometry_publish_frequency"}).value_or(0));
  return s;
}

base::Result<TrackSettings> belt_settings_of(const ModelDef& model, const PluginDef& plugin) {
  TrackSettings s;
  const std::string name = plugin.parameters.text_of({"link"}).value_or("");
  const auto link = link_of(model, plugin.scope, name);
  if (!link) return drive_error(model, plugin, "the model has no link " + base::in_quotes(name));
  s.left = {{*link, belt_axis(plugin.parameters)}};
  s.body = *link;
  s.is_vehicle = false;
  read_limits(plugin.parameters, s.belt);
  s.rate = std::max(0.0, plugin.parameters.number_of({"odometry_publish_frequency"}).value_or(0));
  return s;
}

class Tracks final : public DriveTrain {
 public:
  Tracks(Physics& physics, ModelId model, TrackSettings settings) : physics_(physics), model_(model), settings_(std::move(settings)) {}

  void describe(shm::Position2dInfo& info) const override {
    info.drive = RTMSIM_DRIVE_SKID;
    info.max_speed = most(settings_.linear.high < 1000 ? settings_.linear.high : settings_.belt.high);
    info.max_yaw_rate = most(settings_.angular.high);
    info.wheel_separation = settings_.separation;
  }

  void drive(const DriveOrder& order, bool motors_on, double dt) override {
    const auto step = [&](const Limits& limits, double now, double asked) {
      return now + std::clamp(std::clamp(asked, limits.low, limits.high) - now, limits.brake * dt, limits.push * dt);
    };
    const double vx = step(settings_.linear, asked_[0], order.velocity[0]);
    const double va = settings_.is_vehicle ? step(settings_.angular, asked_[1], order.velocity[2]) : 0;
    asked_ = motors_on ? std::array{vx, va} : std::array{0.0, 0.0};
    const double difference = va * settings_.separation / (2 * settings_.efficiency);
    for (std::size_t side = 0; side < 2; ++side)
      belts_[side] = motors_on ? step(settings_.belt, belts_[side], side == 0 ? vx - difference : vx + difference) : 0;
    dt_ = dt;
    run(motors_on);
  }

  Travel travel() override {
    const auto [speed, aside, yaw_rate] = followed();
    return {speed * dt_, yaw_rate * dt_, speed, yaw_rate};
  }

  std::array<double, 3> followed() const override {
    if (!settings_.is_vehicle) return {belts_[0], 0, 0};
    return {(belts_[0] + belts_[1]) / 2, 0, (belts_[1] - belts_[0]) * settings_.efficiency / settings_.separation};
  }
  bool moves_the_model() const override { return settings_.is_vehicle; }
  std::vector<std::uint32_t> joints() const override { return {}; }
  std::vector<std::uint32_t> belts() const override {
    std::vector<std::uint32_t> all;
    for (const auto* tracks : {&settings_.left, &settings_.right}) {
      for (const Track& track : *tracks) all.push_back(track.link);
    }
    return all;
  }
  double rate() const override { return settings_.rate; }
  void reset() override {
    belts_ = asked_ = {0, 0};
    dt_ = 0;
  }
  void add_to(StateHash& hash) const override {
    for (const double belt : belts_) hash.add(belt);
  }

 private:
  static double most(double limit) { return limit < 1000 ? limit : 0; }

  // The centre of the curve lies beside the middle of the body.
  void run(bool motors_on) {
    constexpr double straight = 1e-6;  // [rad/s]
    const auto [speed, aside, yaw_rate] = followed();
    std::optional<Eigen::Vector3d> center;
    if (std::abs(yaw_rate) > straight) center = physics_.link_pose({model_, settings_.body}) * Eigen::Vector3d(0, speed / yaw_rate, 0);
    for (std::size_t side = 0; side < 2; ++side) {
      for (const Track& track : side == 0 ? settings_.left : settings_.right) {
        const Eigen::Vector3d axis = physics_.link_pose({model_, track.link}).linear() * track.axis;
        physics_.set_belt({model_, track.link}, {axis, belts_[side], center, !motors_on});
      }
    }
  }

  Physics& physics_;
  ModelId model_;
  TrackSettings settings_;
  std::array<double, 2> asked_{0, 0};  // vx, va within the limits of the vehicle
  std::array<double, 2> belts_{0, 0};  // speed of the belts [m/s]: left, right
  double dt_ = 0;                      // [s] of the last step
};

}  // namespace

MadeTrain make_tracks(Physics& physics, ModelId model, const PluginDef& plugin) {
  const bool is_vehicle = kind_of(plugin) == PluginKind::tracked_vehicle;
  auto settings = is_vehicle ? vehicle_settings_of(physics.def(model), plugin) : belt_settings_of(physics.def(model), plugin);
  if (!settings) return settings.error();
  return std::unique_ptr<DriveTrain>(new Tracks(physics, model, std::move(*settings)));
}

}  // namespace sim
