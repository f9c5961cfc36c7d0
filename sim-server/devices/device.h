// The interface of all devices to the server's loop, and the parts of the world that a device may use. The loop calls, in this order and
// for all devices in the order of the world: before_step, (step), after_step, then for those that are due take_sample, and publish. Devices
// that publish samples are Sensors (sensor.h), which implements most of these calls; cameras draw in threads of their own. The stepping
// thread only, but take_sample() of different devices may run in several threads at the same time: it reads the world and changes nothing
// but its own device. So may before_step() and after_step() of different models.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "base/result.h"
#include "physics/hash.h"
#include "physics/physics.h"
#include "shm/writer.h"

namespace shm {
class Server;
}

namespace sim {

class RayWorld;
class RenderWorld;
class TagData;

struct Moment {
  std::chrono::nanoseconds time{0};  // simulated
  double dt = 0;                     // [s] of a step
};

// When a device of a certain rate works: at the first step at or after each multiple of its period.
class Schedule {
 public:
  explicit Schedule(double rate = 0);  // [Hz]; 0: every step
  bool is_due(std::chrono::nanoseconds now) const { return now >= next_; }
  void done(std::chrono::nanoseconds now);
  // Whether it is due; if so, the next multiple is.
  bool pass(std::chrono::nanoseconds now) {
    if (!is_due(now)) return false;
    done(now);
    return true;
  }
  void restart() { next_ = std::chrono::nanoseconds(0); }
  std::chrono::nanoseconds period() const { return period_; }

 private:
  std::chrono::nanoseconds period_{0}, next_{0};
};

struct DeviceWorld {
  Physics& physics;
  RayWorld& rays;
  shm::Server& shm;
  std::uint64_t seed = 0;
  const WorldDef& world;
  RenderWorld* pictures = nullptr;  // never null while there are cameras
  TagData* tags = nullptr;          // never null
};

class Device {
 public:
  virtual ~Device() = default;
  virtual shm::IfaceWriter& iface() = 0;
  virtual ModelId model() const = 0;

  // Wants the next two in every step. They change nothing but the device and its own model: devices of different models may be called in
  // several threads at the same time.
  virtual bool follows_steps() const { return false; }
  // Commands become forces and motors.
  virtual void before_step(const Moment&) {}
  // What must be followed in every step: encoders, accelerations.
  virtual void after_step(const Moment&) {}
  // True when somebody wants a sample and one is due. Called once after each step.
  virtual bool wants_sample(const Moment&) { return false; }
  virtual bool uses_rays() const { return false; }
  virtual void take_sample(const Moment&) {}
  virtual void publish(const Moment&) {}
  // While time stands still: true when the sensor was switched on and has not said anything since.
  virtual bool owes_sample() = 0;
  // Then: a sample of how it is now, which changes nothing in what comes later. Rays are up to date.
  virtual void show(const Moment&) {}
  // Back to the start, with the model (again) at its initial state.
  virtual void reset() {}
  // State that later steps depend on. Of a device that does not follow the steps it is always the same; never of what subscribers get.
  virtual void add_to(StateHash&) const {}

  // Of position devices; others reject.
  virtual bool set_odometry(const Eigen::Isometry3d&) { return false; }
  virtual bool set_motors(bool) { return false; }
  // Of readers of RFID tags; others reject. The tag must be in reach now.
  virtual base::Result<void> write_tag(const std::string& id, const std::string& data);

  // Of devices with motors, after a step: whether a motor has been told to work.
  virtual bool is_working() const { return false; }
  // The same: whether their motors have power, from the next step on and until a reset. A battery that is empty takes it away.
  virtual void set_power(bool) {}
};

// All devices of a model: its sensors and those of its plugins that are known. What is left out adds a line to `left_out`. Fails when an
// iface cannot be made (no shared memory left).
base::Result<std::vector<std::unique_ptr<Device>>> make_devices(DeviceWorld& world, ModelId model, std::vector<std::string>& left_out);

// --- for the devices themselves

shm::Pose to_pose(const Eigen::Isometry3d& pose);
Eigen::Isometry3d from_pose(const shm::Pose& pose);
double yaw_of(const Eigen::Isometry3d& pose);

// A sensor's place: the link that carries it and its pose there.
struct Mount {
  LinkId link;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  // in the link
  Eigen::Isometry3d in_world(const Physics& physics) const { return physics.link_pose(link) * pose; }
};

// "model" or "model::scope".
std::string scoped_model(const ModelDef& model, const std::string& scope);
// The link or joint that a plugin or sensor of `scope` means by a name: in its scope first.
std::optional<std::uint32_t> link_of(const ModelDef& model, const std::string& scope, const std::string& name);
std::optional<std::uint32_t> joint_of(const ModelDef& model, const std::string& scope, const std::string& name);

}  // namespace sim
