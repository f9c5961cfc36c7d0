#include <algorithm>
#include <cmath>
#include <numbers>

#include "devices/sensors/sensor_makers.h"

namespace sim {
namespace {

// What a localization would say: the true pose with noise, once or several times. The nearer to the truth a hypothesis is, the more it
// weighs.
class Localization final : public Sensor {
 public:
  Localization(Setup setup, const SensorSite& site) : Sensor(std::move(setup)), def_(std::get<LocalizationDef>(site.def.data)) {}

 private:
  enum Channel { x, y, heading };

  void measure(const Moment&) const override {
    const Eigen::Isometry3d pose = physics().model_pose(model());
    const double far = square(def_.position), turned = square(def_.heading);
    const auto hypotheses = followers<shm::Hypothesis>(0);
    double sum = 0;
    for (shm::Hypothesis& one : hypotheses) {
      const double dx = noisy(x, 0), dy = noisy(y, 0), da = noisy(heading, 0);
      one = {{pose.translation().x() + dx, pose.translation().y() + dy, std::remainder(yaw_of(pose) + da, 2 * std::numbers::pi)},
             {far, 0, 0, far, 0, turned},
             std::exp(-(part(dx, far) + part(dy, far) + part(da, turned)) / 2)};
      sum += one.weight;
    }
    for (shm::Hypothesis& one : hypotheses) one.weight = sum > 0 ? one.weight / sum : 1 / static_cast<double>(hypotheses.size());
    std::stable_sort(hypotheses.begin(), hypotheses.end(), [](const auto& a, const auto& b) { return a.weight > b.weight; });
    sample<shm::LocalizationSample>().count = static_cast<std::uint32_t>(hypotheses.size());
  }

  static double square(const NoiseDef& noise) { return stated_deviation(noise) * stated_deviation(noise); }
  static double part(double off, double variance) { return variance > 0 ? off * off / variance : 0; }

  LocalizationDef def_;
};

}  // namespace

MadeDevice make_localization(const SensorSite& site) {
  const auto& def = std::get<LocalizationDef>(site.def.data);
  shm::LocalizationInfo info{};
  info.rate = stated_rate(site.world, site.def.update_rate);
  info.capacity = static_cast<std::uint32_t>(def.hypotheses);
  info.position_noise = stated_deviation(def.position);
  info.heading_noise = stated_deviation(def.heading);
  shm::set_text(info.model, scoped_model(site.model(), site.def.scope));
  return make_sensor<Localization>(site, shm::iface_spec(shm::IfaceType::localization, site.iface(), info),
                                   {def.position, def.position, def.heading});
}

}  // namespace sim
