#include "devices/drives/buoyancy_engine.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/text.h"
#include "devices/drives/body.h"
#include "devices/drives/position3d.h"
#include "devices/drives/vehicle_control.h"
#include "world/iface_names.h"

namespace sim {
namespace {

constexpr double bladder_response = 0.5;  // [1/s] of the speed
constexpr double bladder_integral = 0.1;  // [1/s] of what drag and weight take
constexpr double goal_gain = 0.2;         // [1/s]: speed for each metre that is missing
constexpr double lead = 0.7;              // of the fastest change of acceleration that the pump can make

base::Result<BuoyancyEngine::Bladder> bladder_of(const ModelDef& model, ModelId id, const PluginDef& plugin, std::uint32_t link) {
  const ParameterNode& p = plugin.parameters;
  BuoyancyEngine::Bladder bladder;
  bladder.link = {id, link};
  std::optional<base::Error> problem;
  const auto volume = [&](const char* element, double otherwise) {
    const auto text = p.text_of({element});
    const double number = text ? base::parse_number(*text).value_or(-1) : otherwise;
    if (!(number >= 0) && !problem)
      problem = base::Error{fmt::format("{}: plugin {}: <{}> must be a number of 0 or more, got {}; the plugin is left out", plugin.source,
                                        base::in_quotes(plugin.name), element, base::in_quotes(*text))};
    return number;
  };
  bladder.low = volume("min_volume", bladder.low), bladder.high = volume("max_volume", bladder.high);
  bladder.start = volume("default_volume", bladder.low);
  if (problem) return *problem;
  bladder.neutral = p.number_of({"neutral_volume"}).value_or(bladder.neutral);
  bladder.density = p.number_of({"fluid_density"}).value_or(bladder.density);
  bladder.pump = p.number_of({"max_inflation_rate"}).value_or(bladder.pump);
  bladder.surface = p.number_of({"surface"});
  bladder.mass = weight_of(model, Eigen::Isometry3d::Identity()).mass;
  if (bladder.low > bladder.high || bladder.start < bladder.low || bladder.start > bladder.high) {
    return base::Error{
        fmt::format("{}: plugin {}: <min_volume>, <default_volume> and <max_volume> must ascend, got {}, {} and {}; the "
                    "plugin is left out",
                    plugin.source, base::in_quotes(plugin.name), bladder.low, bladder.start, bladder.high)};
  }
  return bladder;
}

}  // namespace

MadeDevice BuoyancyEngine::make(DeviceWorld& world, ModelId model, const PluginDef& plugin, std::vector<std::string>& left_out) {
  const ModelDef& def = world.physics.def(model);
  const auto link = link_of_plugin(def, plugin, left_out);
  if (!link) return MadeDevice(nullptr);
  const auto bladder = bladder_of(def, model, plugin, *link);
  if (!bladder) {
    left_out.push_back(bladder.error().message);
    return MadeDevice(nullptr);
  }
  shm::Position3dInfo info{};
  info.drive = RTMSIM_DRIVE_HOLONOMIC;
  describe_body(def, info.pose, info.size);
  info.rate = stated_rate(world, 0);
  shm::set_text(info.model, scoped_model(def, plugin.scope));
  auto setup = set_up(world, model, 0, shm::iface_spec(shm::IfaceType::position3d, iface_name(def, plugin), info), {});
  if (!setup) return setup.error();
  return MadeDevice(std::make_unique<BuoyancyEngine>(std::move(*setup), *bladder));
}

BuoyancyEngine::BuoyancyEngine(Setup setup, const Bladder& bladder)
    : Sensor(std::move(setup)), bladder_(bladder), volume_(bladder.start), wanted_volume_(bladder.start) {
  odometry_origin_ = physics().model_pose(model()).inverse();
}

void BuoyancyEngine::take(const Moment& moment) {
  shm::Command command;
  switch (poll_command(moment, command)) {
    case shm::CommandChange::fresh:
      is_commanded_ = true;
      is_idle_ = false;
      goal_.reset();
      command_ = command.kind == shm::CommandKind::velocity ? command.values[2] : 0;
      if (command.kind == shm::CommandKind::pose) goal_ = command.values[2];
      break;
    case shm::CommandChange::lost:
      is_commanded_ = false;
      goal_.reset();
      command_ = 0;
      break;
    case shm::CommandChange::none:
      break;
  }
}

// Of a goal: as fast as allows to stop there, where the pump changes the acceleration by so much in a second.
double BuoyancyEngine::wanted_speed() const {
  if (halted_at_) return *halted_at_;
  if (!goal_) return strength_ * command_;
  const double gravity = world().world.physics.gravity.norm(), jerk = gravity * bladder_.density * bladder_.pump / bladder_.mass;
  const double missing = *goal_ - (odometry_origin_ * physics().model_pose(model())).translation().z();
  return strength_ * std::copysign(std::min(goal_gain * std::abs(missing), 0.5 * std::cbrt(jerk * missing * missing)), missing);
}

void BuoyancyEngine::control(double dt) {
  const double gravity = world().world.physics.gravity.norm();
  followed_ = wanted_speed();
  if (!(gravity > 0)) return;
  const double by_volume = gravity * bladder_.density / bladder_.mass;  // acceleration for each cubic metre
  const double error = followed_ - physics().point_velocity(bladder_.link, physics().link_pose(bladder_.link).translation()).z();
  const double braked = lead * std::sqrt(2 * by_volume * bladder_.pump * std::abs(error));
  const double acceleration = std::copysign(std::min(bladder_response * std::abs(error), braked), error);
  const double wanted = bladder_.neutral + (acceleration + learned_) / by_volume;
  wanted_volume_ = std::clamp(wanted, bladder_.low, bladder_.high);
  const bool is_at_its_end = wanted_volume_ != wanted, lags = std::abs(wanted_volume_ - volume_) > bladder_.pump * bladder_response;
  if (!is_at_its_end && !lags) learned_ += bladder_integral * acceleration * dt;
}

void BuoyancyEngine::before_step(const Moment& moment) {
  take(moment);
  if (!motors_enabled_ || !has_power_) {
    wanted_volume_ = volume_;
    followed_ = 0;
  } else if (!is_idle_) {
    control(moment.dt);
  }
  volume_ += std::clamp(wanted_volume_ - volume_, -bladder_.pump * moment.dt, bladder_.pump * moment.dt);
  const Eigen::Vector3d place = physics().link_pose(bladder_.link).translation();
  const bool is_dry = bladder_.surface && place.z() >= *bladder_.surface;
  const double displaced = (is_dry ? 0 : bladder_.density * volume_) - bladder_.density * bladder_.neutral;
  if (displaced == 0) return;
  const Eigen::Vector3d force = -displaced * world().world.physics.gravity;
  (void)world().physics.add_wrench(bladder_.link, force, (place - physics().center_of_mass(bladder_.link)).cross(force));
}

void BuoyancyEngine::measure(const Moment&) const {
  auto& out = sample<shm::Position3dSample>();
  measure_body(physics(), model(), odometry_origin_, out);
  out.command[2] = followed_;
  out.motors_enabled = motors_enabled_ && has_power_ ? 1 : 0;
  out.commanded = is_commanded_ ? 1 : 0;
}

void BuoyancyEngine::restart() {
  is_idle_ = motors_enabled_ = has_power_ = true;
  command_ = followed_ = learned_ = 0;
  volume_ = wanted_volume_ = bladder_.start;
  goal_.reset(), halted_at_.reset();
  strength_ = 1;
  odometry_origin_ = physics().model_pose(model()).inverse();
}

void BuoyancyEngine::add_state_to(StateHash& hash) const {
  hash.add(writer().name());
  hash.add_all(volume_, wanted_volume_, learned_, command_, std::uint64_t{is_idle_}, std::uint64_t{motors_enabled_});
}

bool BuoyancyEngine::set_odometry(const Eigen::Isometry3d& pose) {
  odometry_origin_ = pose * physics().model_pose(model()).inverse();
  return true;
}

// Without its pump the bladder keeps its volume.
bool BuoyancyEngine::set_motors(bool enabled) {
  motors_enabled_ = enabled;
  learned_ = 0;
  return true;
}

void BuoyancyEngine::set_fault(double strength, bool is_halted) {
  strength_ = strength;
  if (!is_halted) halted_at_.reset();
  if (is_halted && !halted_at_) halted_at_ = followed_;
}

}  // namespace sim
