#include "run/break_watch.h"

#include <omnithread.h>

#include <atomic>
#include <cmath>
#include <map>
#include <thread>

#include "base/guarded.h"
#include "base/text.h"
#include "recording/sample_text.h"
#include "run/condition_words.h"
#include "run/shm_simulator.h"
#include "shm/lockstep.h"
#include "shm/request_board.h"
#include "system/remote.h"
#include "system/tap.h"
#include "system/value_codec.h"

namespace recorder {

namespace {

using namespace std::chrono_literals;
using ValueKind = Expression::Value::Kind;

constexpr std::uint32_t watch_phase = 15;  // the last one
constexpr auto watch_limit = 5s;

std::uint32_t number_of(const std::string& simulator) { return static_cast<std::uint32_t>(base::parse_integer(simulator).value_or(0)); }

// What a port sent last.
struct Latest {
  std::string payload;
  bool is_little = true;
  bool is_there = false;
};
struct Port {
  CORBA::TypeCode_ptr type = CORBA::TypeCode::_nil();  // of a table that lives as long as we
  base::Guarded<Latest, base::Rank::samples> latest;
  std::unique_ptr<tools::Tap> tap;  // last: it uses the others
};

}  // namespace

struct BreakWatch::State {
  State(const Expression& chosen, const tools::Session& its_session, shm::Participant its_participant)
      : condition(chosen), session(its_session), participant(std::move(its_participant)) {}

  const Expression condition;
  const tools::Session session;
  shm::Participant participant;
  std::uint32_t simulator = 0;
  std::map<std::string, std::unique_ptr<Port>> ports;  // by COMPONENT:PORT
  std::map<std::string, shm::Iface> models;
  tools::ShmSimulator contacts_of;  // of models; attached if the condition needs it
  base::Guarded<std::optional<std::chrono::nanoseconds>, base::Rank::noted> hit;
  std::atomic<bool> is_ending{false};  // relaxed: says nothing but itself
  std::thread thread;

  base::Result<void> prepare(CORBA::ORB_ptr orb);
  std::optional<double> look_up(const Expression::Value& value, std::chrono::nanoseconds now);
  std::optional<double> sample_member(const Expression::Value& value);
  void run();
};

base::Result<void> BreakWatch::State::prepare(CORBA::ORB_ptr orb) {
  for (const auto& value : condition.values()) {
    if (value.kind == ValueKind::pose && !models.contains(value.name)) {
      auto iface = shm::Iface::open(simulator, shm::IfaceType::truth, value.name);
      if (!iface) return iface.error();
      if (const auto done = iface->subscribe(); !done) return done;
      models.emplace(value.name, std::move(*iface));
    } else if (value.kind == ValueKind::port && !ports.contains(value.name)) {
      const auto colon = value.name.find(':');
      const auto found = session.port(value.name.substr(0, colon) + ".rtc" + value.name.substr(colon));
      if (!found) return found.error();
      if (found->port.port_type() != "DataOutPort") return base::Error{"port " + value.name + ": is not an OutPort, so it has no values"};
      auto port = std::make_unique<Port>();
      port->type = tools::type_code_of(found->port.data_type());
      if (CORBA::is_nil(port->type)) return base::Error{"port " + value.name + ": its data type is not known"};
      auto tap =
          tools::Tap::connect(orb, found->port, {}, [&latest = port->latest](std::span<const unsigned char> payload, bool is_little) {
            *latest.lock() = {std::string(reinterpret_cast<const char*>(payload.data()), payload.size()), is_little, true};
          });
      if (!tap) return tap.error();
      port->tap = std::move(*tap);
      ports.emplace(value.name, std::move(port));
    } else if (value.kind == ValueKind::touches && contacts_of.id().empty()) {
      if (const auto attached = contacts_of.attach(simulator, tools::ShmSimulator::process_of(simulator).value_or(0)); !attached)
        return attached;
    } else if (value.kind == ValueKind::state) {
      if (const auto found = session.component(value.name + ".rtc", {.contexts = true}); !found) return found.error();
    }
  }
  return {};
}

std::optional<double> BreakWatch::State::sample_member(const Expression::Value& value) {
  Port& port = *ports.at(value.name);
  const Latest latest = port.latest.snapshot();
  if (!latest.is_there) return std::nullopt;
  const auto json =
      tools::decode(port.type, {reinterpret_cast<const unsigned char*>(latest.payload.data()), latest.payload.size()}, latest.is_little);
  if (!json) return std::nullopt;
  for (const auto& [member, one] : members_of(*json)) {
    if (member != value.member) continue;
    if (one.is_boolean()) return one.get<bool>() ? 1 : 0;
    return one.is_number() ? std::optional(one.get<double>()) : std::nullopt;
  }
  return std::nullopt;
}

std::optional<double> BreakWatch::State::look_up(const Expression::Value& value, std::chrono::nanoseconds now) {
  switch (value.kind) {
    case ValueKind::number:
      return value.number;
    case ValueKind::time:
      return std::chrono::duration<double>(now).count();
    case ValueKind::port:
      return sample_member(value);
    case ValueKind::state: {
      const auto component = session.component(value.name + ".rtc", {.contexts = true});
      return component ? std::optional(static_cast<double>(component->state())) : std::nullopt;
    }
    case ValueKind::touches: {
      const auto contacts = contacts_of.contacts(value.name);
      return contacts ? std::optional(tools::is_touching(*contacts, value.member) ? 1.0 : 0.0) : std::nullopt;
    }
    case ValueKind::pose:
      break;
  }
  shm::Iface& model = models.at(value.name);
  if (!model.read()) return std::nullopt;
  return tools::member_of(model.sample<shm::TruthSample>().pose, value.member);
}

void BreakWatch::State::run() {
  const omni_thread::ensure_self known_to_the_orb;  // time-outs per thread need it
  const tools::CallLimit limited(watch_limit);
  while (!is_ending.load(std::memory_order_relaxed)) {
    shm::Tick tick;
    const auto what = participant.wait(tick, 100ms);
    if (what == shm::Participant::State::dropped || what == shm::Participant::State::closed) return;
    if (what != shm::Participant::State::tick) continue;
    const auto is_now = condition.holds([&](const auto& value) { return look_up(value, tick.now); });
    if (!is_now || !*is_now) continue;
    *hit.lock() = tick.now;
    // Steps that were asked for end with this one. A server that does not answer is going.
    if (auto requester = shm::Requester::open(simulator)) (void)requester->ask(shm::PauseRequest{});
    return participant.finish();
  }
}

BreakWatch::BreakWatch(std::unique_ptr<State> state) : state_(std::move(state)) {}

BreakWatch::~BreakWatch() {
  state_->is_ending.store(true, std::memory_order_relaxed);
  state_->participant.interrupt();
  if (state_->thread.joinable()) state_->thread.join();
}

base::Result<std::unique_ptr<BreakWatch>> BreakWatch::start(CORBA::ORB_ptr orb, const tools::RunningSystem& system,
                                                            const Expression& condition) {
  const auto period = tick_of(system.simulator(), system.step());
  if (!period) return period.error();
  auto participant = shm::Participant::join(number_of(system.simulator()), {.name = "break", .phase = watch_phase, .period = *period});
  if (!participant) return participant.error();
  const tools::Session session(orb, system.naming(), std::chrono::milliseconds(watch_limit));
  auto state = std::make_unique<State>(condition, session, std::move(*participant));
  state->simulator = number_of(system.simulator());
  if (const auto done = state->prepare(orb); !done) return done.error();
  const auto deadline = std::chrono::steady_clock::now() + watch_limit;
  for (shm::Tick tick; !state->participant.is_active();) {
    if (std::chrono::steady_clock::now() > deadline) return base::Error{"break: the simulator does not take it into the lock step"};
    (void)state->participant.wait(tick, 5ms);
  }
  State& its = *state;
  state->thread = std::thread([&its] { its.run(); });
  return std::make_unique<BreakWatch>(std::move(state));
}

std::optional<std::chrono::nanoseconds> BreakWatch::hit() const { return state_->hit.snapshot(); }

std::vector<std::string> BreakWatch::missing() const {
  std::vector<std::string> all;
  for (const auto& value : state_->condition.values()) {
    if (state_->look_up(value, std::chrono::nanoseconds(0))) continue;
    switch (value.kind) {
      case ValueKind::port:
        all.push_back(value.name +
                      (state_->ports.at(value.name)->latest.snapshot().is_there ? " has no number " + value.member : " has sent nothing"));
        break;
      case ValueKind::state:
        all.push_back("component " + value.name + " does not report its state");
        break;
      case ValueKind::touches:
        all.push_back("the world has no model " + value.name);
        break;
      default:
        all.push_back("model " + value.name + " has no pose");
    }
  }
  return all;
}

base::Result<std::chrono::nanoseconds> tick_of(const std::string& simulator, double step_s) {
  auto simulation = shm::Iface::open(number_of(simulator), shm::IfaceType::simulation, "world");
  if (!simulation) return simulation.error();
  const auto there = shm::read_participants(*simulation);
  if (!there) return there.error();
  std::optional<std::int64_t> shortest;
  for (const auto& one : *there) shortest = std::min(shortest.value_or(one.period_ns), one.period_ns);
  return std::max(std::chrono::nanoseconds(shortest.value_or(0)), std::chrono::nanoseconds(std::llround(step_s * 1e9)));
}

}  // namespace recorder
