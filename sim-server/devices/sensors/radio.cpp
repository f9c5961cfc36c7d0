// What radio carries: readers of RFID tags, and receivers of wireless transmitters.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "base/text.h"
#include "devices/ray_world.h"
#include "devices/sensors/sensor_makers.h"
#include "devices/tag_data.h"

namespace sim {
namespace {

constexpr std::uint32_t max_found = 64;

// All sensors of a kind that the world has now.
template <class Do>
void each_sensor(const Physics& physics, SensorKind kind, Do&& act) {
  for (ModelId model = 0; model < physics.model_slots(); ++model) {
    if (!physics.exists(model)) continue;
    const ModelDef& def = physics.def(model);
    for (std::uint32_t link = 0; link < def.links.size(); ++link) {
      for (const SensorDef& sensor : def.links[link].sensors) {
        if (sensor.kind == kind) act(def, sensor, Mount{{model, link}, sensor.pose}.in_world(physics).translation());
      }
    }
  }
}

std::string scoped_name(const ModelDef& model, const SensorDef& sensor) {
  return model.name + "::" + (sensor.scope.empty() ? sensor.name : sensor.scope + "::" + sensor.name);
}

// What stands between two places; the casings of antennas, nearer than `margin` [m] to one of them, do not.
bool is_between(const RayScene& scene, const Eigen::Vector3d& from, const Eigen::Vector3d& to, double margin) {
  const double distance = (to - from).norm();
  if (distance <= 2 * margin) return false;
  const auto hit = scene.trace_one(from, (to - from) / distance, static_cast<float>(margin), static_cast<float>(distance - margin));
  return std::isfinite(hit.range);
}

template <class Element>
void fill(std::vector<std::pair<double, Element>>& found, std::span<Element> room, std::uint32_t& count, std::uint32_t& total) {
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  total = static_cast<std::uint32_t>(found.size());
  count = std::min(total, static_cast<std::uint32_t>(room.size()));
  for (std::uint32_t i = 0; i < count; ++i) room[i] = found[i].second;
}

class Rfid final : public Sensor {
 public:
  Rfid(Setup setup, const SensorSite& site) : Sensor(std::move(setup)), mount_(site.mount), def_(std::get<RfidDef>(site.def.data)) {}
  bool uses_rays() const override { return def_.needs_sight; }
  // The nearest tag of this id.
  base::Result<void> write_tag(const std::string& id, const std::string& data) override {
    std::pair<double, std::string> nearest{infinite, ""};
    std::vector<std::string> ids;
    each_in_reach([&](double distance, const std::string& name, const RfidTagDef& def) {
      ids.push_back(def.id.empty() ? name : def.id);
      if (ids.back() == id) nearest = std::min(nearest, {distance, name});
    });
    if (nearest.second.empty())
      return base::Error{iface().name() + " has no tag " + base::in_quotes(id) + " in reach" +
                         (ids.empty() ? "" : "; it has " + base::join(ids, ", "))};
    world().tags->write(nearest.second, data);
    return {};
  }

 private:
  void measure(const Moment&) const override {
    std::vector<std::pair<double, shm::RfidTag>> found;
    each_in_reach([&](double distance, const std::string& name, const RfidTagDef& def) {
      shm::RfidTag one{};
      shm::set_text(one.id, def.id.empty() ? name : def.id);
      shm::set_text(one.data, world().tags->of(name, def.data));
      found.emplace_back(distance, one);
    });
    auto& out = sample<shm::RfidSample>();
    fill(found, followers<shm::RfidTag>(0), out.count, out.total);
  }

  // distance [m], scoped name and definition of each tag.
  template <class Do>
  void each_in_reach(Do&& act) const {
    constexpr double margin = 0.05;  // [m]
    const Eigen::Isometry3d pose = mount_.in_world(physics());
    each_sensor(physics(), SensorKind::rfid_tag, [&](const ModelDef& model, const SensorDef& tag, const Eigen::Vector3d& place) {
      const Eigen::Vector3d way = place - pose.translation();
      const double distance = way.norm();
      const double off = distance > 0 ? std::acos(std::clamp(way.dot(pose.linear().col(0)) / distance, -1.0, 1.0)) : 0;
      if (distance > def_.range || off > def_.angle / 2) return;
      if (def_.needs_sight && is_between(world().rays.scene(), pose.translation(), place, margin)) return;
      act(distance, scoped_name(model, tag), std::get<RfidTagDef>(tag.data));
    });
  }

  Mount mount_;
  RfidDef def_;
};

// Free space loses 20 log10(4 pi d / wavelength) dB; behind what stands between, the power falls with the fourth power of the distance.
class Wireless final : public Sensor {
 public:
  Wireless(Setup setup, const SensorSite& site) : Sensor(std::move(setup)), mount_(site.mount), def_(std::get<RadioDef>(site.def.data)) {}
  bool uses_rays() const override { return true; }

 private:
  void measure(const Moment&) const override {
    constexpr double light = 299792458, mega = 1e6, margin = 0.3;  // [m/s], [m]
    const Eigen::Vector3d here = mount_.in_world(physics()).translation();
    std::vector<std::pair<double, shm::Radio>> found;
    each_sensor(physics(), SensorKind::wireless_transmitter,
                [&](const ModelDef& model, const SensorDef& sensor, const Eigen::Vector3d& place) {
                  const auto& radio = std::get<RadioDef>(sensor.data);
                  if (radio.frequency < def_.min_frequency || radio.frequency > def_.max_frequency) return;
                  const double wavelength = light / (radio.frequency * mega), distance = (place - here).norm();
                  const bool is_blocked = is_between(world().rays.scene(), here, place, margin);
                  const double loss = 20 * std::log10(std::max(1.0, 4 * std::numbers::pi * distance / wavelength)) +
                                      (is_blocked ? 20 * std::log10(std::max(1.0, distance)) : 0);
                  shm::Radio one{};
                  one.level = radio.power + radio.gain + def_.gain - loss;
                  if (one.level < def_.sensitivity) return;
                  one.frequency = radio.frequency;
                  one.is_blocked = is_blocked ? 1 : 0;
                  shm::set_text(one.essid, radio.essid);
                  shm::set_text(one.transmitter, scoped_name(model, sensor));
                  found.emplace_back(-one.level, one);
                });
    auto& out = sample<shm::WirelessSample>();
    fill(found, followers<shm::Radio>(0), out.count, out.total);
  }

  Mount mount_;
  RadioDef def_;
};

}  // namespace

MadeDevice make_rfid(const SensorSite& site) {
  const auto& def = std::get<RfidDef>(site.def.data);
  auto info = info_of<shm::RfidInfo>(site);
  info.capacity = max_found;
  info.range = def.range;
  info.angle = def.angle;
  info.needs_sight = def.needs_sight ? 1 : 0;
  return make_sensor<Rfid>(site, shm::iface_spec(shm::IfaceType::rfid, site.iface(), info), {});
}

MadeDevice make_wireless(const SensorSite& site) {
  const auto& def = std::get<RadioDef>(site.def.data);
  auto info = info_of<shm::WirelessInfo>(site);
  info.capacity = max_found;
  info.gain = def.gain;
  info.sensitivity = def.sensitivity;
  info.min_frequency = def.min_frequency;
  info.max_frequency = def.max_frequency;
  return make_sensor<Wireless>(site, shm::iface_spec(shm::IfaceType::wireless, site.iface(), info), {});
}

}  // namespace sim
