#include <cmath>
#include <numbers>

#include "devices/angle.h"
#include "devices/drives/drive_train.h"
#include "devices/sensors/sensor_makers.h"

namespace sim {
namespace {

std::vector<std::uint32_t> joints_of(const SensorSite& site) {
  std::vector<std::uint32_t> joints;
  for (const std::string& name : std::get<WheelsDef>(site.def.data).joints) {
    if (const auto joint = joint_of(site.model(), site.def.scope, name)) joints.push_back(*joint);
  }
  return joints;
}

// Encoders that count ticks: what a wheel turns, whether or not it slips.
class Wheels final : public Sensor {
 public:
  Wheels(Setup setup, const SensorSite& site) : Sensor(std::move(setup)), ticks_(std::get<WheelsDef>(site.def.data).ticks) {
    for (const auto joint : joints_of(site)) wheels_.push_back({{site.mount.link.model, joint}});
    restart();
  }

  bool follows_steps() const override { return true; }
  void after_step(const Moment&) override {
    for (Wheel& wheel : wheels_) {
      const double now = physics().joint_state(wheel.joint).position;
      wheel.turned += wrapped(now - wheel.last);
      wheel.last = now;
    }
  }

 private:
  struct Wheel {
    JointId joint;
    double last = 0, turned = 0;  // [rad]
  };

  void measure(const Moment&) const override {
    auto& out = sample<shm::WheelsSample>();
    const auto encoders = followers<shm::WheelState>(0);
    out.count = static_cast<std::uint32_t>(wheels_.size());
    for (std::size_t i = 0; i < wheels_.size(); ++i) {
      constexpr double turn = 2 * std::numbers::pi;
      const double ticks = std::floor(wheels_[i].turned / turn * ticks_);
      encoders[i] = {ticks, ticks / ticks_ * turn, physics().joint_state(wheels_[i].joint).velocity};
    }
  }

  void restart() override {
    for (Wheel& wheel : wheels_) wheel.last = physics().joint_state(wheel.joint).position, wheel.turned = 0;
  }

  void add_state_to(StateHash& hash) const override {
    hash.add(writer().name());
    for (const Wheel& wheel : wheels_) hash.add(wheel.turned);
  }

  double ticks_;  // in a turn
  std::vector<Wheel> wheels_;
};

}  // namespace

std::string missing_wheel(const ModelDef& model, const SensorDef& sensor) {
  for (const std::string& name : std::get<WheelsDef>(sensor.data).joints) {
    const auto joint = joint_of(model, sensor.scope, name);
    if (!joint || model.joints[*joint].axes.size() != 1) return name;
  }
  return {};
}

MadeDevice make_wheels(const SensorSite& site) {
  auto info = shm::WheelsInfo{};
  info.rate = stated_rate(site.world, site.def.update_rate);
  info.ticks = std::get<WheelsDef>(site.def.data).ticks;
  shm::set_text(info.model, scoped_model(site.model(), site.def.scope));
  std::vector<shm::Wheel> wheels;
  for (const auto joint : joints_of(site)) {
    shm::Wheel wheel{};
    shm::set_text(wheel.joint, site.model().joints[joint].name);
    wheel.radius = wheel_radius(site.model(), joint);
    wheels.push_back(wheel);
  }
  return make_sensor<Wheels>(site, shm::spec_with(shm::IfaceType::wheels, site.iface(), info, std::span<const shm::Wheel>(wheels)), {});
}

}  // namespace sim
