#include <algorithm>

#include "devices/sensors/sensor_makers.h"

namespace sim {
namespace {

constexpr std::uint32_t capacity = 32;

bool counts(const SensorSite& site, const CollisionDef& collision) {
  const auto& names = std::get<ContactDef>(site.def.data).collisions;
  return names.empty() || std::find(names.begin(), names.end(), collision.name) != names.end();
}

double radius_of(const GeometryDef& geometry) {
  if (const auto* sphere = std::get_if<SphereShape>(&geometry)) return sphere->radius;
  const auto* cylinder = std::get_if<CylinderShape>(&geometry);
  return cylinder != nullptr ? cylinder->radius : 0;
}

// What is endless has no extent.
void describe_shape(const SensorSite& site, shm::BumperInfo& info) {
  const LinkDef& link = site.model().links[site.mount.link.link];
  Eigen::AlignedBox3d box;
  std::size_t shapes = 0;
  for (const auto& collision : link.collisions) {
    if (!counts(site, collision)) continue;
    const Eigen::Vector3d reach = collision.pose.linear().cwiseAbs() * half_size_of(collision.geometry);
    if (!reach.allFinite()) continue;
    box.extend((collision.pose.translation() - reach).eval());
    box.extend((collision.pose.translation() + reach).eval());
    const bool stands = collision.pose.linear().col(2).cwiseAbs().isApprox(Eigen::Vector3d::UnitZ(), 1e-6);
    const bool is_round = stands || std::holds_alternative<SphereShape>(collision.geometry);
    info.radius = ++shapes == 1 && is_round ? radius_of(collision.geometry) : 0;
  }
  Eigen::Isometry3d middle = link.pose;
  if (!box.isEmpty()) {
    middle = link.pose * Eigen::Translation3d(box.center());
    for (int i = 0; i < 3; ++i) info.size[i] = box.sizes()[i];
  }
  info.middle = to_pose(middle);
}

class Bumper final : public Sensor {
 public:
  Bumper(Setup setup, const SensorSite& site) : Sensor(std::move(setup)), link_(site.mount.link) {
    for (const auto& collision : site.model().links[link_.link].collisions) collisions_.push_back(counts(site, collision));
    restart();
  }

 private:
  // Always: who subscribes while the body sleeps wants the forces that it fell asleep with. Anew for a model that was made anew.
  void restart() override { world().physics.record_forces(link_.model); }

  void measure(const Moment&) const override {
    auto& out = sample<shm::BumperSample>();
    const auto room = contacts();
    out.count = out.total = 0;
    for (const Contact& contact : physics().contacts(link_.model)) {
      if (contact.link.link != link_.link || contact.link.model != link_.model || !collisions_[contact.collision]) continue;
      ++out.total;
      if (out.count >= room.size()) continue;
      shm::Contact& c = room[out.count++];
      for (int i = 0; i < 3; ++i) {
        c.position[i] = contact.position[i];
        c.normal[i] = contact.normal[i];
        c.force[i] = contact.force[i];
      }
      c.depth = contact.depth;
      std::string other = "?";
      if (physics().exists(contact.other.model)) {
        const ModelDef& model = physics().def(contact.other.model);
        const LinkDef& link = model.links[contact.other.link];
        other = model.name + "::" + link.name + "::" + link.collisions[contact.other_collision].name;
      }
      shm::set_text(c.other, other);
    }
  }

  LinkId link_;
  std::vector<bool> collisions_;  // of the link: those that count
};

}  // namespace

MadeDevice make_bumper(const SensorSite& site) {
  auto info = info_of<shm::BumperInfo>(site);
  info.capacity = capacity;
  describe_shape(site, info);
  return make_sensor<Bumper>(site, shm::iface_spec(shm::IfaceType::bumper, site.iface(), info), {});
}

}  // namespace sim
