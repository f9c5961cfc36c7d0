#include "devices/sensors/sensor.h"

#include <algorithm>
#include <cmath>

#include "shm/server.h"
#include "world/iface_names.h"

namespace sim {

Sensor::Sensor(Setup setup)
    : world_(setup.world),
      model_(setup.model),
      schedule_(setup.rate),
      writer_(std::move(setup.writer)),
      noise_(std::move(setup.noise)),
      streams_(std::move(setup.streams)),
      seed_(world_.seed) {}

void Sensor::take_sample(const Moment& moment) {
  for (Noise& noise : noise_) noise.begin(moment.time);
  measure(moment);
}

void Sensor::publish(const Moment& moment) { writer_->publish(moment.time); }

void Sensor::show_changed(const Moment& moment, const std::function<void(shm::IfaceWriter&)>& change) {
  take_sample(moment);
  change(*writer_);
  publish(moment);
}

shm::CommandChange Sensor::poll_command(const Moment& moment, shm::Command& command) {
  const auto change = writer_->poll_command(command);
  if (change != shm::CommandChange::none) command_end_.reset();
  if (change == shm::CommandChange::fresh && command.duration.count() > 0) command_end_ = moment.time + command.duration;
  if (change != shm::CommandChange::none || !command_end_ || moment.time < *command_end_) return change;
  command_end_.reset();
  return shm::CommandChange::lost;
}

void Sensor::reset() {
  schedule_.restart();
  if (seed_ != world_.seed) {
    seed_ = world_.seed;
    for (std::size_t i = 0; i < streams_.size(); ++i) noise_[i] = noise_[i].with(RandomStream(seed_, streams_[i]));
  }
  writer_->drop_command();  // of the run before
  command_end_.reset();
  restart();
}

void Sensor::add_to(StateHash& hash) const {
  add_state_to(hash);
  if (command_end_) hash.add(static_cast<std::uint64_t>(command_end_->count()));
}

double stated_rate(const DeviceWorld& world, double rate) { return rate > 0 ? rate : 1 / world.world.physics.step; }

double stated_deviation(const NoiseDef& noise) { return noise.kind == NoiseDef::Kind::none ? 0 : noise.stddev; }

shm::Pose pose_on_model(const ModelDef& model, const Mount& mount) { return to_pose(model.links[mount.link.link].pose * mount.pose); }

std::string SensorSite::iface() const { return iface_name(model(), def); }

NoiseChannels NoiseChannels::shared(const NoiseDef& noise) {
  NoiseChannels one{noise};
  one.is_shared = true;
  return one;
}

base::Result<Sensor::Setup> set_up(DeviceWorld& world, ModelId model, double rate, const shm::IfaceSpec& spec, const NoiseChannels& noise) {
  auto writer = world.shm.create(spec);
  if (!writer) return writer.error();
  Sensor::Setup setup{world, model, rate, std::move(*writer), {}};
  const auto interval = std::max(Schedule(rate).period(), std::chrono::nanoseconds(std::llround(1e9 * world.world.physics.step)));
  char letter = 'a';
  for (const NoiseDef& def : noise.noises) {
    const std::string stream = noise.is_shared ? spec.name : spec.name + letter++;
    setup.noise.emplace_back(def, RandomStream(world.seed, stream), interval);
    setup.streams.push_back(stream);
  }
  return setup;
}

}  // namespace sim
