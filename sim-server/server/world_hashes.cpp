#include "server/world_hashes.h"

#include <algorithm>
#include <array>
#include <bit>
#include <span>
#include <utility>

#include "shm/iface_types.h"

namespace sim {
namespace {

constexpr std::chrono::nanoseconds usual_period = std::chrono::milliseconds(10), longest_pause = std::chrono::milliseconds(100);

// The same on every machine.
std::uint64_t hash_of(std::span<const std::uint64_t> state) {
  base::Hash64 hash;
  if constexpr (std::endian::native == std::endian::little) {
    hash.add(std::as_bytes(state));
  } else {
    for (const std::uint64_t word : state) hash.add(word);
  }
  return hash.value();
}

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

WorldHashes::WorldHashes(std::string path, base::HashLogWriter log, std::optional<std::chrono::nanoseconds> period)
    : path_(std::move(path)),
      log_(std::move(log)),
      follows_turns_(!period),
      schedule_(1e9 / static_cast<double>(period.value_or(usual_period).count())),
      without_turns_(1e9 / static_cast<double>(longest_pause.count())) {}

base::Result<WorldHashes> WorldHashes::open(const std::string& path, std::optional<std::chrono::nanoseconds> period) {
  auto log = base::HashLogWriter::create(path);
  if (!log) return log.error();
  return WorldHashes(path, std::move(*log), period);
}

WorldHashes::Leaf& WorldHashes::leaf(std::vector<Leaf>& leaves, std::size_t index) {
  if (index >= leaves.size()) leaves.resize(index + 1);
  return leaves[index];
}

void WorldHashes::name(Leaf& leaf, std::string_view type, std::string_view name) {
  if (leaf.type != type || leaf.name != name) {
    leaf = {std::string(type), std::string(name)};
    leaf.key = type.empty() ? log_.key({base::HashKey::Kind::model, 0, leaf.name, "pose"})
                            : log_.key({base::HashKey::Kind::device, 0, leaf.type + " " + leaf.name, ""});
  }
  leaf.is_named = true;
}

void WorldHashes::look_at_names_again(std::uint64_t arrangement) {
  if (std::exchange(arrangement_, arrangement) == arrangement) return;
  for (auto* leaves : {&models_, &devices_})
    for (Leaf& leaf : *leaves) leaf.is_named = false;
}

void WorldHashes::restart() {
  schedule_.restart();
  without_turns_.restart();
}

// Of the leaf whose state is in state_: it is another one than before. To compare costs a tenth of a hash, and what rests, or keeps nothing
// but its name, is not hashed again.
bool WorldHashes::is_new(Leaf& leaf) {
  const auto words = state_.words();
  if (std::exchange(leaf.is_known, true) && std::ranges::equal(leaf.state, words)) return false;
  leaf.state.assign(words.begin(), words.end());
  leaf.hash = hash_of(words);
  return true;
}

void WorldHashes::record_models(const Simulation& simulation) {
  const Physics& physics = simulation.physics();
  for (ModelId id = 0; id < physics.model_slots(); ++id) {
    if (!physics.exists(id)) continue;
    state_.clear();
    physics.add_place_and_parts_to(state_, id);
    Leaf& model = leaf(models_, id);
    if (!model.is_named) name(model, "", physics.def(id).name);
    if (is_new(model)) log_.add(model.key, model.hash, octets_of(physics.model_pose(id)));
  }
}

void WorldHashes::record_devices(const Simulation& simulation) {
  const auto& devices = simulation.devices();
  for (std::size_t i = 0; i < devices.size(); ++i) {
    Leaf& device = leaf(devices_, i);
    // Most are sensors that keep no state: a look at each costs more than all the rest.
    if (device.is_named && !devices[i]->follows_steps()) continue;
    state_.clear();
    devices[i]->add_to(state_);
    if (const auto& iface = devices[i]->iface(); !device.is_named) name(device, shm::to_text(iface.type()), iface.name());
    if (is_new(device)) log_.add(device.key, device.hash);
  }
}

void WorldHashes::record(const Simulation& simulation, std::optional<bool> has_turn) {
  const auto now = simulation.time();
  if (!schedule_.is_due(now)) return;
  if (follows_turns_ && has_turn == false && !without_turns_.is_due(now)) return;
  schedule_.done(now);
  without_turns_.done(now);
  look_at_names_again(simulation.arrangement());
  log_.begin_tick(simulation.resets(), simulation.time());
  record_models(simulation);
  record_devices(simulation);
  log_.end_tick();
}

}  // namespace sim
