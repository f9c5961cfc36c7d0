#include <algorithm>

#include "devices/simple_devices.h"
#include "world/iface_names.h"

namespace sim {
namespace {
constexpr std::uint32_t capacity = 32;
}

base::Result<std::unique_ptr<Device>> Bumper::make(DeviceWorld& world, Mount mount, const SensorDef& sensor) {
  const ModelDef& model = world.physics.def(mount.link.model);
  shm::BumperInfo info{};
  info.capacity = capacity;
  info.rate = sensor.update_rate > 0 ? sensor.update_rate : 1 / world.world.physics.step;
  info.pose = to_pose(model.links[mount.link.link].pose * mount.pose);
  shm::set_text(info.model, scoped_model(model, sensor.scope));
  auto writer = world.shm.create(shm::bumper_spec(iface_name(model, sensor), info));
  if (!writer) return writer.error();
  return std::unique_ptr<Device>(new Bumper(world, mount, sensor, std::move(*writer)));
}

Bumper::Bumper(DeviceWorld& world, Mount mount, const SensorDef& sensor, std::unique_ptr<shm::IfaceWriter> writer)
    : world_(world), mount_(mount), schedule_(sensor.update_rate), writer_(std::move(writer)) {
  const auto& names = std::get<ContactDef>(sensor.data).collisions;
  for (const auto& collision : world.physics.def(mount.link.model).links[mount.link.link].collisions) {
    collisions_.push_back(names.empty() || std::find(names.begin(), names.end(), collision.name) != names.end());
  }
  record();
}

// Always: who subscribes while the body sleeps wants the forces that it fell asleep with.
void Bumper::record() { world_.physics.record_forces(mount_.link.model); }

void Bumper::reset() {
  schedule_.restart();
  record();  // the model has been made anew
}

void Bumper::measure(const Moment&) {
  auto& sample = writer_->sample<shm::BumperSample>();
  const auto out = writer_->contacts();
  sample.count = sample.total = 0;
  for (const Contact& contact : world_.physics.contacts(mount_.link.model)) {
    if (contact.link.link != mount_.link.link || contact.link.model != mount_.link.model || !collisions_[contact.collision]) continue;
    ++sample.total;
    if (sample.count >= out.size()) continue;
    shm::Contact& c = out[sample.count++];
    for (int i = 0; i < 3; ++i) {
      c.position[i] = contact.position[i];
      c.normal[i] = contact.normal[i];
      c.force[i] = contact.force[i];
    }
    c.depth = contact.depth;
    std::string other = "?";
    if (world_.physics.exists(contact.other.model)) {
      const ModelDef& model = world_.physics.def(contact.other.model);
      const LinkDef& link = model.links[contact.other.link];
      other = model.name + "::" + link.name + "::" + link.collisions[contact.other_collision].name;
    }
    shm::set_text(c.other, other);
  }
}

void Bumper::publish(const Moment& moment) {
  schedule_.done(moment.time);
  writer_->publish(moment.time);
}

}  // namespace sim
