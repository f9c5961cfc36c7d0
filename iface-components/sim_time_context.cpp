#include "sim_time_context.h"

#include <base/hash64.h>
#include <base/nondeterminism.h>
#include <base/text.h>
#include <component/context_clock.h>
#include <rtm/ECFactory.h>

#include <thread>
#include <utility>

#include "specification.h"

namespace {

constexpr std::chrono::milliseconds longest_wait{100};
constexpr std::chrono::milliseconds retry_period{100};
constexpr std::int64_t highest_phase = 15, highest_turn = 9999;
constexpr std::chrono::seconds usual_member_timeout{1};

}  // namespace

SimTimeContext::SimTimeContext(const std::string& name) : RTC::PeriodicExecutionContext(name), server_id_(iface::default_server()) {
  RTC::set_clock(*this, clock_, simulator_time_);
}

SimTimeContext::~SimTimeContext() {
  stop();
  coil::Task::wait();
}

void SimTimeContext::init(coil::Properties& properties) {
  RTC::PeriodicExecutionContext::init(properties);
  const auto number = [&](const char* key, std::int64_t highest, std::int64_t otherwise) {
    const std::string text = properties.getProperty(key);
    if (text.empty()) return otherwise;
    const auto value = base::parse_integer(text);
    if (value && *value >= 0 && *value <= highest) return *value;
    RTC_WARN(("exec_cxt.%s must be a number from 0 to %d, got %s", key, static_cast<int>(highest), base::in_quotes(text).c_str()));
    return otherwise;
  };
  server_id_ = static_cast<int>(number("sim_time.server_id", iface::highest_server, server_id_));
  waits_for_members_ = properties.getProperty("member_timeout").empty();
  hash_log_ = properties.getProperty("sim_time.hash_log");
  phase_ = static_cast<std::uint32_t>(number("sim_time.phase", highest_phase, phase_));
  turn_ = static_cast<std::uint32_t>(number("sim_time.turn", highest_turn, turn_));
  participant_as_ = properties.getProperty("sim_time.participant");
  has_own_thread_ = base::parse_bool(properties.getProperty("sim_time.own_thread")).value_or(true) || turn_ != 0 ||
                    !participant_as_.empty() || !properties.getProperty("stack_size").empty();
}

void SimTimeContext::say_once(const std::string& line) {
  if (line == said_) return;
  said_ = line;
  const base::ScopedClock clock(*clock_);  // for the log
  RTC_INFO(("%s: %s", participant_name().c_str(), line.c_str()));
}

std::string SimTimeContext::participant_name() const {
  if (!participant_as_.empty()) return participant_as_;
  try {
    const RTC::RTObject_var owner = getOwner();
    if (CORBA::is_nil(owner)) return getName();
    const RTC::ComponentProfile_var profile = owner->get_component_profile();
    return profile->instance_name.in();
  } catch (const CORBA::Exception&) {
    return getName();  // the owner is just going
  }
}

std::shared_ptr<shm::Participant> SimTimeContext::join() {
  shm::ParticipantOptions options;
  options.name = participant_name();
  options.phase = phase_;
  options.turn = turn_;
  options.period = getPeriod();
  auto joined = shm::Participant::join(static_cast<std::uint32_t>(server_id_), options);
  if (!joined) {
    // Once for each time that it is away, however the reason changes meanwhile.
    if (!std::exchange(is_waiting_, true)) say_once("waiting for the simulator: " + joined.error().message);
    return nullptr;
  }
  auto simulation = shm::Iface::open(static_cast<std::uint32_t>(server_id_), shm::IfaceType::simulation, "world");
  if (!simulation) return nullptr;
  is_waiting_ = false;
  const auto& world = simulation->info<shm::SimulationInfo>();
  const auto step = std::chrono::nanoseconds(world.step_ns);
  if (waits_for_members_) setMemberTimeout(world.lockstep != 0 ? without_end : usual_member_timeout);
  simulator_time_->follow(std::move(*simulation));
  base::set_lock_step_clock(simulator_time_);
  say_once("ticking at " + base::format_number(getRate()) + " Hz of simulated time, phase " + std::to_string(phase_) + " of simulator " +
           std::to_string(server_id_) +
           (options.period < step ? "; that is once a step, " + base::format_number(1e9 / static_cast<double>(step.count())) + " Hz" : ""));
  if (const auto folder = std::exchange(hash_log_, {}); !folder.empty()) {
    if (const auto problem = tick_.keep_hashes(folder, options.name, phase_); !problem.empty()) RTC_ERROR(("%s", problem.c_str()));
  }
  auto participant = std::make_shared<shm::Participant>(std::move(*joined));
  *participant_.lock() = participant;
  return participant;
}

std::uint64_t SimTimeContext::hash_of_states() const {
  base::Hash64 all;
  for (const auto state : getComponentStates()) all.add(static_cast<std::uint64_t>(state));
  return all.value();
}

void SimTimeContext::run_tick(const shm::Tick& tick) {
  clock_->set(tick.now);
  tick_.begin(tick);
  const base::ScopedTick scope(tick_);
  stepTransitions();
  stepExecution();
  const base::ScopedClock clock(*clock_);  // for what is sent
  tick_.end([this] { return hash_of_states(); });
}

void SimTimeContext::run_requests() {
  if (!simulator_time_->stands_still()) return;
  tick_.begin({});
  const base::ScopedTick scope(tick_);
  invokeWorkerPreDo();
}

void SimTimeContext::report_long_call() { complainAboutCallback("its context participates in lock step again when it returns"); }

shm::Participant::State SimTimeContext::run_alone(shm::Participant& participant) {
  shm::Tick tick;
  while (threadRunning()) {
    const auto state = participant.wait(tick, longest_wait);
    if (state == shm::Participant::State::tick)
      run_tick(tick);
    else if (state == shm::Participant::State::timed_out)
      run_requests();
    else
      return state;
  }
  return shm::Participant::State::timed_out;
}

// Until the participant is lost, the rate changes, or the thread is to end.
shm::Participant::State SimTimeContext::run_in_group(const std::shared_ptr<shm::Participant>& participant) {
  const std::chrono::nanoseconds period = getPeriod();
  iface::TickGroup::Place place({server_id_, phase_, period}, participant, *this);
  *place_.lock() = &place;  // from here on the end and a new rate are reported to it
  const bool is_right = threadRunning() && getPeriod() == period;
  const auto state = is_right ? place.wait() : shm::Participant::State::timed_out;
  *place_.lock() = nullptr;
  return state;
}

void SimTimeContext::run(const std::shared_ptr<shm::Participant>& participant) {
  auto state = shm::Participant::State::timed_out;
  while (threadRunning() && state == shm::Participant::State::timed_out)
    state = has_own_thread_ ? run_alone(*participant) : run_in_group(participant);
  if (state == shm::Participant::State::dropped) say_once("the simulator has dropped this context from the lock step; joining again");
  if (state != shm::Participant::State::closed) return;
  is_waiting_ = true;
  say_once("the simulator has exited; waiting for it");
}

int SimTimeContext::svc() {
  while (threadRunning()) {
    if (const auto participant = join()) {
      run(participant);
      participant_.lock()->reset();  // ours is the last one, but for who interrupts it right now
    } else {
      // Without a simulator time stands still, and a component can still be activated and deactivated.
      invokeWorkerPreDo();
      std::this_thread::sleep_for(retry_period);  // nothing announces a simulator that does not exist yet
    }
    simulator_time_->follow(std::nullopt);
  }
  return 0;
}

void SimTimeContext::interrupt() {
  if (has_own_thread_) {
    if (const auto participant = participant_.snapshot()) participant->interrupt();
    return;
  }
  const bool ends = !threadRunning();
  auto place = place_.lock();
  if (*place != nullptr) ends ? (*place)->leave() : (*place)->wake();
}

void SimTimeContext::onWakeUp() {
  RTC::PeriodicExecutionContext::onWakeUp();
  interrupt();
}

RTC::ReturnCode_t SimTimeContext::onSetRate(double) {
  if (const auto participant = participant_.snapshot()) participant->set_period(getPeriod());
  if (auto place = place_.lock(); *place != nullptr) (*place)->leave();  // its group is that of another period
  return RTC::RTC_OK;
}

extern "C" {
void SimTimeContextInit(RTC::Manager*) {
  RTC::ExecutionContextFactory::instance().addFactory("SimTimeContext", RTC::ECCreate<SimTimeContext>, RTC::ECDelete<SimTimeContext>);
}
}
