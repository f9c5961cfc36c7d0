// The gateway: robots, clock and services in one event loop. One thread. Other threads help it: see dds/participant.h, bell.h and
// common/async_requests.h.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/result.h"
#include "bell.h"
#include "graph.h"
#include "lock_step_participant.h"
#include "log_topic.h"
#include "naming.h"
#include "robot.h"
#include "simulation.h"
#include "unknown_names.h"
#include "waits.h"
#include "world.h"

namespace ros2 {

enum class OnTimeout { hold, stop, fail };

struct Options {
  std::uint32_t server_id = 0;
  ParticipantSettings dds;
  std::optional<Family> family;
  Naming naming;
  std::string service_prefix;
  double clock_rate = 100;  // [Hz of simulated time]; 0: every step
  std::chrono::nanoseconds command_timeout = std::chrono::milliseconds(500);
  bool has_clock = true, has_joint_tf = true, has_parameters = true;
  bool is_lockstep = false;
  std::vector<WaitFor> waits;
  std::chrono::nanoseconds wait_timeout = std::chrono::seconds(10);
  OnTimeout on_timeout = OnTimeout::fail;
};

class Gateway {
 public:
  explicit Gateway(Options options);
  ~Gateway();

  // Until SIGINT or SIGTERM, which must be blocked in all threads. Errors: DDS, or a command that did not come in time.
  base::Result<void> run();

 private:
  using Time = std::chrono::steady_clock::time_point;

  base::Result<void> open();
  void turn_loop();
  void answer_bell();
  Namespaces namespaces();
  void arrange(const Listed& listed);
  void lose();
  void name_unknown(const Listed& listed);
  UsedNames used_names() const;
  void send_static_transforms();
  void take_samples();
  void send_clock(bool is_forced);
  void begin_tick(const shm::Tick& tick);
  void tend_tick(Time now);
  void report_losses();
  void report_lost(const Writer& writer);
  std::uint64_t growth(const std::string& what, std::uint64_t count);
  void update(Time now);
  void sleep(std::uint32_t rings);
  void choose_sources();
  void choose_clock();
  void watch_other_clocks();
  bool is_paused() const;
  std::vector<std::string> command_topics() const;

  Options options_;
  const std::string started_;  // when
  LogTopic logs_;
  int signals_ = -1;
  AsyncRequests async_requests_, steps_;            // steps: takes long
  std::unique_ptr<LockStepParticipant> lock_step_;  // before the bell, which interrupts it
  Bell bell_;
  gateway::WatchedIfaces ifaces_;
  World world_;
  std::unique_ptr<Participant> participant_;
  std::unique_ptr<Graph> graph_;
  std::unique_ptr<Node> node_;
  std::unique_ptr<SimulationServices> services_;
  Writer* rosout_ = nullptr;
  Writer* clock_ = nullptr;
  Writer* tf_static_ = nullptr;
  std::unique_ptr<Shared> shared_;
  std::vector<std::unique_ptr<Robot>> robots_;
  std::set<std::string> named_;  // lines about unknown names that were logged
  std::vector<SharedSegment> watched_;
  std::shared_ptr<Source> read_clock_;  // while its steps are shown
  Waits waits_;
  std::optional<shm::Tick> tick_;
  Time tick_start_{}, clock_sent_{};
  std::int64_t clock_ns_ = -1;
  std::uint32_t answered_ = 0;  // rings of the bell
  std::uint32_t resets_ = 0;
  bool are_sources_due_ = false;
  bool is_clock_foreign_ = false;
  std::map<std::string, std::uint64_t> reported_;  // by topic or node: samples that were lost or could not be read
  Time next_look_{}, next_report_{}, next_update_{};
  bool is_over_ = false;
  std::optional<base::Error> failed_;
};

}  // namespace ros2
