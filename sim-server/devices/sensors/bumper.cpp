#include <algorithm>

#include "devices/sensors/sensor_makers.h"

namespace sim {
namespace {

constexpr std::uint32_t capacity = 32;

class Bumper final : public Sensor {
 public:
  Bumper(Setup setup, const SensorSite& site) : Sensor(std::move(setup)), link_(site.mount.link) {
    const auto& names = std::get<ContactDef>(site.def.data).collisions;
    for (const auto& collision : site.model().links[link_.link].collisions) {
      collisions_.push_back(names.empty() || std::find(names.begin(), names.end(), collision.name) != names.end());
    }
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
  return make_sensor<Bumper>(site, shm::iface_spec(shm::IfaceType::bumper, site.iface(), info), {});
}

}  // namespace sim
