#include "server/world_hashes.h"

#include <array>
#include <bit>
#include <span>
#include <utility>

#include "shm/iface_types.h"

namespace sim {
namespace {

// Little-endian doubles, on every machine.
std::array<std::byte, 7 * sizeof(double)> octets_of(const Eigen::Isometry3d& pose) {
  const Eigen::Vector3d p = pose.translation();
  const Eigen::Quaterniond q(pose.linear());
  std::array<std::byte, 7 * sizeof(double)> octets{};
  std::size_t at = 0;
  for (const double number : {p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()}) {
    const auto word = std::bit_cast<std::uint64_t>(number);
    for (unsigned i = 0; i < sizeof word; ++i) octets[at++] = static_cast<std::byte>(word >> (8 * i));
  }
  return octets;
}

}  // namespace

base::Result<WorldHashes> WorldHashes::open(const std::string& path, std::chrono::nanoseconds period) {
  auto log = base::HashLogWriter::create(path);
  if (!log) return log.error();
  return WorldHashes(path, std::move(*log), 1e9 / static_cast<double>(period.count()));
}

WorldHashes::Leaf& WorldHashes::leaf(std::vector<Leaf>& leaves, std::size_t index, base::HashKey::Kind kind, const std::string& name) {
  if (index >= leaves.size()) leaves.resize(index + 1);
  Leaf& leaf = leaves[index];
  if (leaf.name != name) {
    leaf = {name};
    leaf.key = log_.key({kind, 0, name, kind == base::HashKey::Kind::model ? "pose" : ""});
  }
  return leaf;
}

void WorldHashes::record_models(const Simulation& simulation) {
  const Physics& physics = simulation.physics();
  for (ModelId id = 0; id < physics.model_slots(); ++id) {
    if (!physics.exists(id)) continue;
    StateHash hash;
    physics.add_to(hash, id);
    Leaf& model = leaf(models_, id, base::HashKey::Kind::model, physics.def(id).name);
    if (std::exchange(model.is_known, true) && model.hash == hash.value()) continue;
    model.hash = hash.value();
    log_.add(model.key, model.hash, octets_of(physics.model_pose(id)));
  }
}

void WorldHashes::record_devices(const Simulation& simulation) {
  const auto& devices = simulation.devices();
  for (std::size_t i = 0; i < devices.size(); ++i) {
    StateHash hash;
    devices[i]->add_to(hash);
    const auto& iface = devices[i]->iface();
    Leaf& device =
        leaf(devices_, i, base::HashKey::Kind::device, std::string(shm::to_text(iface.type())) + " " + std::string(iface.name()));
    if (std::exchange(device.is_known, true) && device.hash == hash.value()) continue;
    device.hash = hash.value();
    log_.add(device.key, device.hash);
  }
}

void WorldHashes::record(const Simulation& simulation) {
  if (!schedule_.is_due(simulation.time())) return;
  schedule_.done(simulation.time());
  log_.begin_tick(simulation.resets(), simulation.time());
  record_models(simulation);
  record_devices(simulation);
}

}  // namespace sim
