// A running world: physics, rays and devices as one, without the loop, the wall clock and the requests around it. The stepping
// thread only.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "devices/device.h"
#include "devices/drives/joint_hold.h"
#include "devices/joints/attachments.h"
#include "devices/ray_world.h"
#include "devices/render_world.h"
#include "devices/sensors/sensor_fault.h"
#include "devices/tag_data.h"
#include "physics/physics.h"
#include "server/statistics.h"
#include "shm/server.h"
#include "world/body_force_defs.h"

namespace sim {

struct SimulationOptions {
  std::uint64_t seed = 1;
  int threads = 1;
  bool rolling = false;  // robots alone on level ground are moved by the rolling step
  std::vector<FaultOrder> faults{};
};

// Places a moving model has been, for pictures [m].
struct Trail {
  std::vector<Eigen::Vector3f> points;
  float spacing = 0.05F;
};

class Simulation {
 public:
  // Notes are about what runs in another way than written, `dropped` about what does not run. Fails when ifaces cannot be made.
  static base::Result<std::unique_ptr<Simulation>> create(std::shared_ptr<const WorldDef> world, shm::Server& shm,
                                                          const SimulationOptions& options, std::vector<std::string>& notes,
                                                          std::vector<std::string>& dropped);

  std::chrono::nanoseconds time() const { return time_; }
  std::chrono::nanoseconds step_length() const { return step_; }
  std::uint64_t steps() const { return steps_; }
  std::uint32_t resets() const { return resets_; }

  // Commands, physics, encoders; time goes on by a step.
  void step(PartTimes& times);
  // Sensors that are due measure and publish.
  // `before_writing` is called before the first of them is written; when it says false none is, and sense() says so.
  bool sense(PartTimes& times, const std::function<bool()>& before_writing = {});
  // While time stands still: sensors that were switched on meanwhile show the present moment; the run goes on as without them.
  void answer_new_subscribers();
  // The same for all that have subscribers.
  void show_present();

  // Of all noise, from the reset on that follows at once.
  void set_seed(std::uint64_t seed);
  // As at the start, to the bit. The ifaces stay.
  base::Result<void> reset(std::vector<std::string>& notes);
  void reset_poses();
  base::Result<ModelId> spawn(const ModelDef& model, std::vector<std::string>& notes);
  // What another thread has read of the files of a model that is to be spawned.
  void adopt(TriangleCache&& triangles) { triangles_.adopt(std::move(triangles)); }
  void remove(ModelId model);
  base::Result<void> set_pose(ModelId model, const Eigen::Isometry3d& pose);
  // For `duration` from the next step on; at least one step.
  base::Result<void> add_wrench(LinkId link, const Eigen::Vector3d& force, const Eigen::Vector3d& torque,
                                std::chrono::nanoseconds duration);
  // The same until the next of these for the link, in place of all that stay there; of zeros: ends them. A reset brings back those of the
  // world's file and ends all others.
  base::Result<void> keep_wrench(LinkId link, const Eigen::Vector3d& force, const Eigen::Vector3d& torque);
  // The same of a joint: an effort [N m or N] beside what its motor does.
  base::Result<void> add_effort(JointId joint, double effort, std::chrono::nanoseconds duration);
  base::Result<void> keep_effort(JointId joint, double effort);

  // Whether a fault can be of this: an iface, or a joint of one (arm::joints::elbow) whatever it is called.
  bool can_have_faults(std::string_view name) const;
  // From now on until it ends, by itself or by end_faults(). One of the same kind and name that is on gives way. The error: there is no
  // such iface, or what it belongs to cannot have the fault.
  base::Result<void> add_fault(const FaultOrder& fault);
  // Those of an iface and its joints, or of a joint, and of a kind; without, all. Also what is still to come. How many there were.
  std::size_t end_faults(std::string_view iface_name, std::optional<shm::FaultKind> kind);
  // Those that have not ended, by device.
  std::vector<FaultOrder> faults() const;

  // Of grippers and detachable joints; error: there is nothing to hold. Nothing: there is none of that name.
  std::optional<base::Result<void>> turn_attachment(std::string_view name, bool is_on);
  const Attachments& attachments() const { return attachments_; }

  std::uint64_t hash() const;
  Physics& physics() { return *physics_; }
  const Physics& physics() const { return *physics_; }
  RayWorld& rays() { return *rays_; }
  RenderWorld& pictures() { return *pictures_; }
  const WorldDef& world() const { return *world_; }
  const std::vector<std::unique_ptr<Device>>& devices() const { return devices_; }
  // Another number when models and devices have come or gone: while it is the same, each id and index names the same one.
  std::uint64_t arrangement() const { return arrangement_; }
  Device* device(std::string_view iface_name);
  const std::vector<Trail>& trails() const { return trails_; }  // by ModelId
  // Devices that have worked since the last call.
  std::uint32_t take_active_sensors();

 private:
  Simulation(std::shared_ptr<const WorldDef> world, shm::Server& shm, const SimulationOptions& options);
  base::Result<void> make_devices_of(ModelId model, std::vector<std::string>& left_out);
  void note_absent_models(std::vector<std::string>& notes, std::vector<std::string>& dropped) const;
  base::Result<void> check_faults() const;
  base::Result<void> add_first_faults(std::unique_ptr<Device>& device) const;
  base::Result<void> restore_faults();
  base::Result<ModelId> spawn_whole(const ModelDef& model, std::vector<std::string>& notes);
  void sort_devices();
  // Those of a model one after the other, those of different models on several threads when that is worth it.
  void for_followers(const std::function<void(Device&)>& work);
  void follow_trails();
  void show_due();

  struct Wrench {
    LinkId link;
    Eigen::Vector3d force, torque;
    std::chrono::nanoseconds until;
    bool stays = false, is_at_origin = false;  // of the link; else at the centre of mass
    std::optional<std::uint32_t> joint = {};   // of the link's model, which force.x() pushes in place of the link
  };
  void push();
  // In an order that does not depend on who came first: forces are added up, and round.
  void put(const Wrench& wrench);
  base::Result<void> check_wrench(LinkId link, const Eigen::Vector3d& force, const Eigen::Vector3d& torque) const;
  // Those of the world's file that mean the model.
  void add_standing_wrenches(ModelId model);

  std::shared_ptr<const WorldDef> world_;
  SimulationOptions options_;
  WorkerPool pool_;
  TriangleCache triangles_;
  std::unique_ptr<Physics> physics_;
  std::unique_ptr<RayWorld> rays_;
  std::unique_ptr<RenderWorld> pictures_;
  std::unique_ptr<DeviceWorld> device_world_;
  std::vector<std::unique_ptr<Device>> devices_;  // by model, then as made
  std::uint64_t arrangement_ = 0;
  std::vector<Device*> followers_;   // those that follow the steps
  std::vector<std::size_t> shares_;  // of the followers; where each ends
  WorkerPool::Pace commands_pace_;
  std::vector<JointHold> holds_;
  Attachments attachments_;
  TagData tags_;
  std::vector<Device*> due_;
  std::vector<Wrench> wrenches_;
  std::vector<StandingWrench> standing_;  // of the world's file
  std::vector<Trail> trails_;
  std::size_t initial_models_ = 0;
  std::chrono::nanoseconds step_, time_{0};
  std::uint64_t steps_ = 0;
  std::uint32_t resets_ = 0, active_sensors_ = 0;
};

}  // namespace sim
