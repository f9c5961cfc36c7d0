// A simulator under the control of a run: its time, its models, its lock-step participants. `ShmSimulator` is the real one, over shared
// memory; tests have a `FakeSimulator` (tests/run). One thread at a time.
//
// Errors: each call that asks the simulator returns an Error when the simulator rejects ("spawn: no model found in ..."), has exited, or
// does not answer within the timeout of the call. No call waits longer than that. Calls that only read shared memory do not wait.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "run/model_parts.h"
#include "run/pose_record.h"
#include "shm/requests.h"

namespace tools {

struct SimulatorState {
  pid_t pid = 0;
  double step_s = 0;  // [s]
  std::string hash;   // of the world, 16 hexadecimal digits
};

struct SimulatedMoment {
  double time_s = 0;  // simulated
  std::uint64_t steps = 0;
};

struct LockstepParticipant {
  std::string name;
  std::int64_t phase = 0;
  std::chrono::nanoseconds period{0};
  bool is_late = false;  // did not finish its tick
};

// Why steps ended early: a process with lock-step participants died.
struct LostProcess {
  pid_t pid = 0;
  std::vector<std::string> in_tick;  // its participants that had not finished their tick
  double time_s = 0;                 // of the tick, simulated
  std::int64_t tick = 0;             // its number, from 1; 0: it was in none
};

struct ModelToSpawn {
  std::string source;        // SDF file, model folder, model://NAME, or SDF text
  std::string name;          // empty: as in the file
  std::vector<double> pose;  // X Y YAW, X Y Z YAW, X Y Z ROLL PITCH YAW [m, rad]; empty: as in the file
};

struct Push {
  std::vector<double> numbers;  // force [N], three; then torque [N m], three or none; in the world frame. Of a joint one [N m or N]
  double duration_s = 0;        // simulated; 0: one step
  bool stays = false;           // until the next one of the link or joint that stays; one of zeros ends it
  bool is_joint = false;
};

class Simulator {
 public:
  // Of requests that are answered between two steps; a model is loaded within it, too.
  static constexpr std::chrono::seconds request_timeout{20};
  static constexpr std::chrono::seconds state_timeout{5};
  static constexpr std::chrono::seconds picture_timeout{60};

  virtual ~Simulator() = default;
  virtual const std::string& id() const = 0;  // server ID
  virtual double step() const = 0;            // [s]

  virtual base::Result<SimulatorState> state() = 0;
  // From shared memory; nothing when the simulator has exited.
  virtual std::optional<SimulatedMoment> now() = 0;
  virtual std::vector<LockstepParticipant> participants() = 0;

  // Names, of all models of the world.
  virtual base::Result<std::vector<std::string>> models() = 0;
  // Of all models of the world.
  virtual base::Result<std::vector<ModelParts>> parts() = 0;
  // Of MODEL or MODEL::LINK, in the world frame.
  virtual base::Result<shm::Pose> pose(const std::string& name) = 0;
  // Of all links of a model, now.
  virtual base::Result<std::vector<ModelContact>> contacts(const std::string& model) = 0;

  // Its name.
  virtual base::Result<std::string> spawn(const ModelToSpawn& model) = 0;
  virtual base::Result<void> remove(const std::string& model) = 0;
  // Numbers as those of ModelToSpawn; X Y YAW keeps height and tilt.
  virtual base::Result<void> set_pose(const std::string& model, const std::vector<double>& numbers) = 0;
  // At the centre of mass of MODEL or MODEL::LINK, or of MODEL::JOINT.
  virtual base::Result<void> push(const std::string& name, const Push& push) = 0;

  // The world from above with the rays of range finders, a square PNG.
  virtual base::Result<void> screenshot(const std::string& file, std::uint32_t pixels) = 0;

  // Starts steps and returns. `is_paced`: at the real-time factor, else as fast as possible. One call at a time.
  virtual base::Result<void> begin_steps(std::int64_t steps, bool is_paced) = 0;
  // True: they are done. False: not within the timeout. An Error: another client has paused or reset the simulation, or it has exited.
  virtual base::Result<bool> await_steps(std::chrono::milliseconds timeout) = 0;

  // The steps that began last end with the tick in which a process of lock-step participants dies. Which one that was, once the steps have
  // ended for it within the timeout; else nothing. await_steps() then returns the same Error again.
  virtual std::optional<LostProcess> await_loss(std::chrono::milliseconds timeout) = 0;

  // What happened since the last call: poses of moving models and positions of the joints that `record` wants, ten times a simulated
  // second, and contacts that began. The first call starts the log. Adds to `record`.
  virtual base::Result<void> read_events(PoseRecord& record) = 0;
};

// Names of the participants that have not ended their tick.
std::vector<std::string> late_participants(Simulator& simulator);

}  // namespace tools
