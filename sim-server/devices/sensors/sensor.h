// Common base of devices that publish samples. It decides when a sample is due, owns the iface and the noise, and handles reads of a paused
// simulation, resets and the state hash. A derived device adds the measurement. See device.h for the thread rule.
#pragma once

#include <functional>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "devices/device.h"
#include "rays/noise.h"
#include "shm/specs.h"

namespace sim {

class Sensor : public Device {
 public:
  shm::IfaceWriter& iface() final { return *writer_; }
  ModelId model() const final { return model_; }
  // Due times pass whether or not somebody subscribes: the samples that one subscriber gets do not depend on the others.
  bool wants_sample(const Moment& moment) final { return schedule_.pass(moment.time) && (is_always_measured_ || writer_->is_subscribed()); }
  void take_sample(const Moment& moment) final;
  void publish(const Moment& moment) final;
  // Without subscribers, too: for faults that keep samples.
  void measure_always(bool always) { is_always_measured_ = always; }
  bool owes_sample() final { return writer_->owes_sample(); }
  void show(const Moment& moment) final {
    show_changed(moment, [](shm::IfaceWriter&) {});
  }
  // The same with a sample that `change` has seen before it is published.
  void show_changed(const Moment& moment, const std::function<void(shm::IfaceWriter&)>& change);
  void reset() final;
  void add_to(StateHash& hash) const final;

  struct Setup {
    DeviceWorld& world;
    ModelId model;
    double rate;  // [Hz]; 0: every step
    std::unique_ptr<shm::IfaceWriter> writer;
    std::vector<Noise> noise;            // its channels; none for what is exact
    std::vector<std::string> streams{};  // of random numbers, by channel
  };

 protected:
  explicit Sensor(Setup setup);

  // Fills the iface's sample with what is there now. Const: a sample that somebody asks for in between changes nothing in those that
  // follow. The noise depends on the simulated time alone.
  virtual void measure(const Moment& moment) const = 0;
  // What the device itself keeps from step to step goes back to the start; the model is there already.
  virtual void restart() {}
  // The same for the state hash.
  virtual void add_state_to(StateHash&) const {}

  DeviceWorld& world() const { return world_; }
  const Physics& physics() const { return world_.physics; }
  const shm::IfaceWriter& writer() const { return *writer_; }
  template <class Sample>
  Sample& sample() const {
    return writer_->sample<Sample>();
  }
  std::span<float> ranges() const { return writer_->ranges(); }
  std::span<float> intensities() const { return writer_->intensities(); }
  template <class Element>
  std::span<Element> followers(std::size_t array) const {
    return writer_->followers<Element>(array);
  }
  std::span<shm::Contact> contacts() const { return writer_->contacts(); }
  // As the writer's. A command with a duration is `lost` when it is over.
  shm::CommandChange poll_command(const Moment& moment, shm::Command& command);

  // The value with the noise of a channel, at the time of the sample.
  double noisy(std::size_t channel, double value) const { return noise_[channel].apply(value); }
  // All ranges with the noise of the first channel, quantised to multiples of `step` (0: not).
  void add_noise(std::span<float> ranges, float step) const { noise_.front().apply(ranges, step); }

 private:
  DeviceWorld& world_;
  ModelId model_;
  Schedule schedule_;
  std::unique_ptr<shm::IfaceWriter> writer_;
  mutable std::vector<Noise> noise_;
  std::vector<std::string> streams_;  // by channel
  std::uint64_t seed_;                // of noise_
  bool is_always_measured_ = false;
  std::optional<std::chrono::nanoseconds> command_end_;  // of a command with a duration
};

// A sensor of an SDFormat file and where it stands.
struct SensorSite {
  DeviceWorld& world;
  Mount mount;
  const SensorDef& def;
  std::optional<JointId> joint;  // of a sensor that stands in a joint; the mount is on the joint's child then
  const ModelDef& model() const { return world.physics.def(mount.link.model); }
  std::string iface() const;
};

using MadeDevice = base::Result<std::unique_ptr<Device>>;

// [Hz], with "every step" as a number.
double stated_rate(const DeviceWorld& world, double rate);
double stated_deviation(const NoiseDef& noise);
shm::Pose pose_on_model(const ModelDef& model, const Mount& mount);

// What the infos of all sensors say: how often, where on which model.
template <class Info>
Info info_of(const SensorSite& site) {
  Info info{};
  info.rate = stated_rate(site.world, site.def.update_rate);
  info.pose = pose_on_model(site.model(), site.mount);
  shm::set_text(info.model, scoped_model(site.model(), site.def.scope));
  return info;
}

// The noise of a sensor: a channel for each value, which draws from a stream of its own, or one that all values of a sample draw from.
struct NoiseChannels {
  NoiseChannels() = default;  // exact
  NoiseChannels(std::initializer_list<NoiseDef> each) : noises(each) {}
  NoiseChannels(std::vector<NoiseDef> each) : noises(std::move(each)) {}
  static NoiseChannels shared(const NoiseDef& noise);
  std::vector<NoiseDef> noises;
  bool is_shared = false;
};

// The iface and the streams of the noise, which its name chooses.
base::Result<Sensor::Setup> set_up(DeviceWorld& world, ModelId model, double rate, const shm::IfaceSpec& spec, const NoiseChannels& noise);

// A device T of the site; T takes (Sensor::Setup, const SensorSite&, more...).
template <class T, class... More>
MadeDevice make_sensor(const SensorSite& site, const shm::IfaceSpec& spec, const NoiseChannels& noise, More&&... more) {
  auto setup = set_up(site.world, site.mount.link.model, site.def.update_rate, spec, noise);
  if (!setup) return setup.error();
  return MadeDevice(std::make_unique<T>(std::move(*setup), site, std::forward<More>(more)...));
}

}  // namespace sim
