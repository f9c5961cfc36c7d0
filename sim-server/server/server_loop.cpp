#include "server/server_loop.h"

#include <sys/prctl.h>

#include <algorithm>
#include <cstdio>
#include <utility>

#include "base/log.h"
#include "reader/asset_reader.h"
#include "shm/words.h"

namespace sim {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto tend_period = 100ms;    // of heartbeats and of leases that are given up, while time passes
constexpr auto pause_period = 1000ms;  // the same while it stands still: clients who come, ask or die wake the loop
constexpr auto unwatched_lead = 5ms;   // of wall time that steps may come early when nobody is there to see it: one sleep for several steps

}  // namespace

ServerLoop::ServerLoop(Simulation& simulation, shm::Server& server, shm::IfaceWriter& iface, const ModelPath& model_path,
                       const LoopOptions& options, std::optional<Recorder> recorder)
    : simulation_(simulation),
      server_(server),
      iface_(iface),
      model_path_(model_path),
      options_(options),
      recorder_(std::move(recorder)),
      board_(iface, server),
      mode_(options.is_paused),
      pace_(options.rtf) {
  shm::BarrierOptions barrier;
  barrier.is_lockstep = options.is_lockstep;
  barrier.participant_timeout = options.participant_timeout;
  barrier.on_event = [this](const shm::BarrierEvent& event) { on_barrier_event(event); };
  barrier.on_waiting = [this] {
    tend();
    handle_requests(When::in_tick);
    return !is_stopping_.load(std::memory_order_acquire);  // pairs with the release in stop
  };
  barrier_ = std::make_unique<shm::Barrier>(iface, server, barrier);
  simulation_.pictures().on_read([this] { board_.wake(); });
  prctl(PR_SET_TIMERSLACK, 1);
}

ServerLoop::~ServerLoop() {
  AssetReader::mine().stop();  // the server ends: nobody waits for files
  simulation_.pictures().on_read(nullptr);
}

void ServerLoop::stop() {
  is_stopping_.store(true, std::memory_order_release);  // pairs with the acquires in the loop
  AssetReader::mine().stop();                           // the loop may be waiting for files
  board_.wake();
}

void ServerLoop::on_barrier_event(const shm::BarrierEvent& event) {
  using Kind = shm::BarrierEvent::Kind;
  const auto say = [&](base::Level level, const char* what) {
    base::log(level, "sim-server", "participant {} (pid {}, phase {}) {}", event.name, event.pid, event.phase, what);
  };
  switch (event.kind) {
    case Kind::joined:
      return say(base::Level::info, "joined");
    case Kind::left:
      return say(base::Level::info, "has left");
    case Kind::died:
      note_death(event);
      if (death_) return say(base::Level::warn, "exited; simulated time stops");
      return say(base::Level::warn, "exited; simulated time continues without it");
    case Kind::hangs:
      return say(base::Level::warn, "has not finished its tick for a second; time waits for it");
    case Kind::dropped:
      return say(base::Level::warn, "was dropped: it did not finish its tick in time");
  }
}

bool ServerLoop::run() {
  start_pace();
  choose_pictures();
  count();
  publish_clock();
  wait_for_participants();
  start_pace();
  while (!is_stopping_.load(std::memory_order_acquire)) {  // pairs with the release in stop
    times_.begin_step(simulation_.steps());
    if (mode_.stands_still() && !barrier_->settle()) break;
    const bool stood_still = mode_.stands_still();
    choose_pictures();
    handle_requests(When::between_steps);
    tend();
    if (waits_for_spawn()) {
      board_.wait(Clock::now() + tend_period);
      start_pace();
      continue;
    }
    // Also when time is to go on now: who came before that has a sample, however fast the two followed each other.
    if (stood_still) simulation_.answer_new_subscribers();
    // Not while time stands still: who subscribes or joins before it moves has its sample and its tick at time 0, as after a reset.
    if (is_fresh_moment_ && !mode_.stands_still()) {
      is_fresh_moment_ = false;
      if (!finish_moment()) break;
      if (death_) {
        end_steps_at_death();
        continue;
      }
    }
    if (options_.duration && simulation_.time() >= *options_.duration) {
      (void)barrier_->settle();
      break;
    }
    if (mode_.stands_still()) {
      barrier_->refresh();
      board_.wait_for_clients(Clock::now() + pause_period);
      start_pace();
      watch_rate();
      continue;
    }
    step();
    if (!finish_moment()) break;
    if (death_) end_steps_at_death();
    if (mode_.count_step()) finish_step_request();
    if (step_ticket_ && !board_.is_awaited(*step_ticket_)) end_steps("the client has disconnected");
    keep_pace();
    watch_rate();
  }
  if (options_.has_status_line) std::fprintf(stderr, "\n");
  const bool has_hashes = !hashes_ || hashes_->finish();
  if (!has_hashes) base::log(base::Level::error, "sim-server", "the hash log could not be written whole");
  return (!recorder_ || recorder_->finish()) && has_hashes;
}

void ServerLoop::wait_for_participants() {
  if (options_.wait_for == 0) return;
  base::log(base::Level::info, "sim-server", "waiting for {} participant{}", options_.wait_for, options_.wait_for == 1 ? "" : "s");
  while (!is_stopping_.load(std::memory_order_acquire)) {  // pairs with the release in stop
    handle_requests(When::between_steps);
    const auto there = static_cast<std::uint32_t>(barrier_->refresh());
    const std::uint32_t missing = there < options_.wait_for ? options_.wait_for - there : 0;
    if (missing != missing_) missing_ = missing, publish_clock();
    simulation_.answer_new_subscribers();
    if (missing == 0) return;
    tend();
    board_.wait(Clock::now() + pause_period);
  }
}

void ServerLoop::tend() {
  server_.tend();
  for (const auto& name : server_.take_cuts()) {
    base::log(base::Level::error, "sim-server",
              "shared memory {} was truncated by another process; it cannot be used until the simulator restarts", name);
  }
}

void ServerLoop::step() {
  times_.mark(Part::requests);
  simulation_.step(times_);
  for (const auto& complaint : simulation_.physics().take_complaints()) base::log(base::Level::warn, "sim-server", "{}", complaint);
}

void ServerLoop::choose_pictures() { simulation_.pictures().set_synchronous(options_.is_lockstep || pace_.is_free() || mode_.hurries()); }

bool ServerLoop::finish_moment() {
  choose_pictures();
  if (!simulation_.sense(times_, [this] { return barrier_->settle(); })) return false;
  look_at_poses();
  if (hashes_) hashes_->record(simulation_, barrier_->has_turn(simulation_.time()));
  publish_clock();
  times_.mark(Part::publish);
  const bool goes_on = barrier_->tick(simulation_.time(), simulation_.steps());
  times_.mark(Part::clients);
  return goes_on;
}

void ServerLoop::look_at_poses() {
  std::vector<PoseSink*> sinks;
  if (recorder_) sinks.push_back(&*recorder_);
  if (memory_log_) sinks.push_back(&*memory_log_);
  if (!sinks.empty()) poses_.look(simulation_.time(), simulation_.physics(), sinks);
}

void ServerLoop::publish_clock() {
  auto& sample = iface_.sample<shm::SimulationSample>();
  sample.steps = simulation_.steps();
  sample.state_hash = last_hash_;
  sample.hash_steps = last_hash_steps_;
  sample.paused = mode_.stands_still() ? 1 : 0;
  sample.waiting_for = missing_;
  sample.rtf_wanted = pace_.wanted();
  sample.rtf_reached = pace_.reached();
  sample.load = pace_.load();
  iface_.publish(simulation_.time());
}

// For people: renewed at the start and about once a second.
void ServerLoop::count() {
  auto& sample = iface_.sample<shm::SimulationSample>();
  const PhysicsStatistics s = simulation_.physics().statistics();
  sample.models = 0;
  for (ModelId id = 0; id < simulation_.physics().model_slots(); ++id) sample.models += simulation_.physics().exists(id) ? 1 : 0;
  sample.bodies = s.bodies;
  sample.joints = s.joints;
  sample.contacts = s.contacts;
  sample.ifaces = static_cast<std::uint32_t>(simulation_.devices().size());
  sample.active_sensors = simulation_.take_active_sensors();
  sample.participants = static_cast<std::uint32_t>(barrier_->records().size());
  sample.part_count = static_cast<std::uint32_t>(part_names.size());
  for (std::size_t i = 0; i < part_names.size(); ++i) {
    const auto& entry = times_.entries()[i];
    shm::set_text(sample.parts[i].name, part_names[i]);
    sample.parts[i].calls = entry.calls;
    sample.parts[i].total_ns = entry.total.count();
    sample.parts[i].max_ns = entry.longest.count();
  }
}

void ServerLoop::watch_rate() {
  if (simulation_.steps() % 16 != 0 && !mode_.is_paused()) return;
  const auto now = Clock::now();
  if (!pace_.measure(now, simulation_.time())) return;
  count();
  const auto& sample = iface_.sample<shm::SimulationSample>();
  if (mode_.is_paused()) publish_clock();
  if (options_.has_status_line) {
    std::fprintf(stderr, "\r%10.3f s  %7.2f x real time  load %3.0f %%  contacts %u  sensors %u%s   ",
                 std::chrono::duration<double>(simulation_.time()).count(), pace_.reached(), 100 * pace_.load(), sample.contacts,
                 sample.active_sensors, mode_.is_paused() ? "  paused" : "");
    std::fflush(stderr);
  }
  if (mode_.is_paused()) return;
  if (const auto reached = pace_.shortfall(now, simulation_.time()))
    base::log(base::Level::warn, "sim-server", "runs at {:.2f} times real time, {} was asked for", *reached, pace_.wanted());
}

void ServerLoop::start_pace() { pace_.start(Clock::now(), simulation_.time()); }

void ServerLoop::keep_pace() {
  if (mode_.hurries()) return;
  auto now = Clock::now();
  const auto due = pace_.due(now, simulation_.time());
  if (!due || (*due - now < unwatched_lead && !is_watched())) return;
  while (now < *due && !is_stopping_.load(std::memory_order_acquire)) {  // pairs with the release in stop
    const auto before = now;
    board_.wait(std::min(*due, now + tend_period));
    now = Clock::now();
    pace_.add_sleep(now - before);
    if (now < *due) {
      tend();
      const auto was_at = simulation_.time();
      handle_requests(When::between_steps);
      if (mode_.stands_still() || mode_.hurries() || simulation_.time() != was_at || is_fresh_moment_) return;
    }
  }
  times_.mark(Part::pace);
}

bool ServerLoop::is_watched() const {
  const auto& devices = simulation_.devices();
  return barrier_->refresh() > 0 || iface_.is_subscribed() || std::any_of(devices.begin(), devices.end(), [](const auto& device) {
           return device->iface().is_subscribed() || device->iface().commanding_pid() != 0;
         });
}

void ServerLoop::finish_step_request() {
  if (!step_ticket_ || !barrier_->settle()) return;
  shm::Reply reply;
  reply.sim_time_ns = simulation_.time().count();
  reply.steps = simulation_.steps();
  reply.hash = last_hash_ = simulation_.hash();
  last_hash_steps_ = simulation_.steps();
  publish_clock();
  board_.reply(*step_ticket_, reply);
  step_ticket_.reset();
}

void ServerLoop::note_death(const shm::BarrierEvent& event) {
  if (!step_ticket_ || !ends_at_death_ || event.is_tool) return;
  if (!death_) death_.emplace(Death{.pid = event.pid, .in_tick = {}});
  if (death_->pid != event.pid || !event.was_in_tick) return;
  death_->in_tick.push_back(event.name);
  death_->period_ns = std::max(death_->period_ns, event.period_ns);
}

void ServerLoop::end_steps_at_death() {
  const Death death = *std::exchange(death_, std::nullopt);
  const auto seconds = [](std::int64_t ns) { return static_cast<double>(ns) / 1e9; };
  shm::Reply reply;
  reply.count = death.pid;
  for (const auto& name : death.in_tick) reply.text += (reply.text.empty() ? "" : "\n") + name;
  reply.values[0] = seconds(simulation_.time().count());
  reply.values[1] = seconds(death.period_ns);
  end_steps("process " + std::to_string(death.pid) + ", a lock-step participant, exited", std::move(reply));
}

void ServerLoop::end_steps(const std::string& why, shm::Reply reply) {
  if (!step_ticket_) return;
  reply.status = shm::RequestStatus::failed;
  reply.message = why + ", " + std::to_string(mode_.end_steps()) + " steps before the last";
  board_.reply(*step_ticket_, reply);
  step_ticket_.reset();
  publish_clock();
}

shm::Reply ServerLoop::reset(const shm::ResetRequest& request) {
  shm::Reply reply;
  if (request.poses_only) {
    simulation_.reset_poses();
  } else {
    if (request.seed) {
      simulation_.set_seed(*request.seed);
      shm::store(iface_.segment().as<shm::SimulationInfo>(shm::AreaIndex::info).seed, *request.seed);
    }
    std::vector<std::string> notes;
    if (const auto done = simulation_.reset(notes); !done) {
      base::log(base::Level::error, "sim-server", "reset: {}", done.error().message);
      reply.status = shm::RequestStatus::failed;
      reply.message = done.error().message;
    }
    for (const auto& note : notes) base::log(base::Level::warn, "sim-server", "{}", note);
    iface_.set_resets(simulation_.resets());
    barrier_->rewind(simulation_.time(), simulation_.resets());
    contacts_told_.clear();
    deleted_.clear();
    is_fresh_moment_ = true;
    pace_.restart_measurement(Clock::now(), simulation_.time());
    poses_.restart();
    if (hashes_) hashes_->restart();
  }
  start_pace();
  publish_clock();
  return reply;
}

LoopState ServerLoop::state() const {
  return {mode_.stands_still(), missing_, pace_.wanted(), pace_.reached(), pace_.load(), barrier_->records(), &times_};
}

}  // namespace sim
