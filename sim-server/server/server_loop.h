// The loop of the simulator: requests and commands, step, sensors that are due, publish, participants, pace; always in this order, so that
// a run is repeatable. run() is called once, in the stepping thread; stop() from any thread.
#pragma once

#include <atomic>
#include <chrono>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "base/result.h"
#include "server/deleted_models.h"
#include "server/describe.h"
#include "server/memory_log.h"
#include "server/mode.h"
#include "server/pace.h"
#include "server/recorder.h"
#include "server/screenshot_worker.h"
#include "server/simulation.h"
#include "server/spawn_loader.h"
#include "server/world_hashes.h"
#include "shm/lockstep.h"
#include "shm/request_board.h"
#include "shm/server.h"
#include "world/model_path.h"

namespace sim {

struct LoopOptions {
  double rtf = 1;  // 0: as fast as possible
  bool is_paused = false;
  bool is_lockstep = false;
  std::uint32_t wait_for = 0;
  std::chrono::nanoseconds participant_timeout{0};
  std::optional<std::chrono::nanoseconds> duration;  // simulated
  bool has_status_line = false;
};

class ServerLoop {
 public:
  // All must outlive the loop. `iface` is the simulation iface.
  ServerLoop(Simulation& simulation, shm::Server& server, shm::IfaceWriter& iface, const ModelPath& model_path, const LoopOptions& options,
             std::optional<Recorder> recorder);
  ~ServerLoop();

  // Before run().
  void keep_hashes(WorldHashes hashes) { hashes_ = std::move(hashes); }

  // Returns when the duration is over or stop() was called; false when not all of the recording or of the hash log could be written.
  bool run();
  void stop();

 private:
  // In a tick that waits for a participant only what changes nothing in the world is served, and wrenches, which begin with the next step;
  // the rest waits for the end of the tick.
  enum class When { between_steps, in_tick };
  void handle_requests(When when);
  shm::Reply handle(const shm::Request& request, const shm::RequestTicket& ticket);
  struct Handler;
  void look_at_poses();

  // When nobody waits for the wall clock, pictures must not be late in simulated time.
  void choose_pictures();
  // Whether what the request shows of the world has been read from its files. Else reading has begun, and the request waits for it: the
  // simulation does not. Time that waits for pictures waits for their files, too.
  bool are_files_read(const shm::Request& request);
  void wait_for_participants();
  // What belongs to a moment: sensors, clock, participants.
  bool finish_moment();
  // Heartbeats and leases; says what others have broken.
  void tend();
  void step();
  void publish_clock();
  shm::Reply reset(const shm::ResetRequest& request);
  void finish_step_request();
  // Models that have been read come into the world, in the order in which they were asked for.
  void spawn_loaded(When when);
  shm::Reply spawn(SpawnLoader::Done&& done);
  // In lock step time waits for the files of a model that is spawned: when it comes must not depend on how fast they are read.
  bool waits_for_spawn() const { return options_.is_lockstep && spawn_loader_ && spawn_loader_->under_way() > 0; }
  std::string late_participants() const;
  // Ends the steps that a client has asked for before they are all done, and tells it why.
  void end_steps(const std::string& why, shm::Reply reply = {});
  void note_death(const shm::BarrierEvent& event);
  void end_steps_at_death();
  // Sleeps until simulated time may go on; requests are served meanwhile.
  void keep_pace();
  void start_pace();
  // Somebody takes part, listens or commands.
  bool is_watched() const;
  // Other users may use the segments (--shm-mode). Nobody can tell then who wrote a request: none is served with the rights of this
  // process.
  bool is_shared() const { return iface_.segment().is_shared(); }
  void watch_rate();
  void count();
  void on_barrier_event(const shm::BarrierEvent& event);
  LoopState state() const;

  Simulation& simulation_;
  shm::Server& server_;
  shm::IfaceWriter& iface_;
  const ModelPath& model_path_;
  LoopOptions options_;
  PoseWatch poses_;
  std::optional<Recorder> recorder_;
  std::optional<MemoryLog> memory_log_;  // once a client has asked for it
  std::optional<WorldHashes> hashes_;
  shm::RequestBoard board_;
  std::unique_ptr<shm::Barrier> barrier_;
  PartTimes times_;

  std::atomic<bool> is_stopping_{false};
  Mode mode_;
  Pace pace_;
  bool is_fresh_moment_ = true;                    // the moment at time 0 has not been published yet
  std::optional<shm::RequestTicket> step_ticket_;  // of the steps that a client has asked for
  // Of the first process of participants that has died while steps are made that are to end then.
  struct Death {
    pid_t pid = 0;
    std::vector<std::string> in_tick;  // its participants that had not finished their tick
    std::int64_t period_ns = 0;        // the longest of these
  };
  std::optional<Death> death_;
  bool ends_at_death_ = false;
  struct Postponed {
    shm::RequestBoard::Asked asked;
    std::chrono::steady_clock::time_point since;
  };
  std::vector<Postponed> postponed_;               // until the tick is over
  std::unique_ptr<ScreenshotWorker> screenshots_;  // made with the first picture
  std::unique_ptr<SpawnLoader> spawn_loader_;      // made with the first model that is spawned
  struct Loaded {
    SpawnLoader::Done done;
    std::chrono::steady_clock::time_point since;
  };
  std::vector<Loaded> loaded_;  // models that wait for the end of a tick
  DeletedModels deleted_;       // since the last reset
  std::map<ModelId, std::uint64_t> contacts_told_;
  std::uint64_t last_hash_ = 0, last_hash_steps_ = 0;
  std::uint32_t missing_ = 0;  // participants
};

}  // namespace sim
