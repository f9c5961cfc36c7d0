#include "run/replay.h"

#include <omnithread.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <deque>
#include <thread>

#include "base/guarded.h"
#include "base/text.h"
#include "recording/read_ahead.h"
#include "recording/ring.h"
#include "shm/lockstep.h"
#include "system/remote.h"
#include "system/tap.h"

namespace recorder {

namespace {

using WallClock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr auto tick_limit = 100ms;  // of one wait; there are as many as it takes
constexpr auto call_limit = 5s;
constexpr std::uint32_t last_phase = 15;

struct Input {
  std::vector<std::unique_ptr<tools::Tap>> targets;
  std::string topic;
  bool comes_before = true;  // the component's tick of the same time
};

// What the component sent on a port, and what it should have.
struct Output {
  ReplayedOutput result;
  std::uint16_t channel = 0;  // of the recording; 0: it has none
  std::unique_ptr<tools::Tap> tap;
  struct Expected {
    std::chrono::nanoseconds time;
    std::uint64_t tick;
    std::string octets;  // with their head
  };
  std::deque<Expected> expected;
};

std::uint32_t phase_of(const mcap::Channel& channel) {
  const auto phase = channel.metadata.find("phase");
  return phase == channel.metadata.end() ? 0 : static_cast<std::uint32_t>(base::parse_integer(phase->second).value_or(0));
}

class Player {
 public:
  Player(CORBA::ORB_ptr orb, tools::RunningSystem& system, const ReplayOptions& options, mcap::Reader recording)
      : orb_(orb),
        system_(system),
        options_(options),
        recording_(std::move(recording)),
        values_(recording_),
        within_ticks_(options.life.part(true)),
        between_ticks_(options.life.part(false)) {}
  ~Player() {
    is_ending_.store(true, std::memory_order_relaxed);
    if (thread_.joinable()) thread_.join();
  }

  base::Result<ReplayResult> run();

 private:
  base::Result<void> connect();
  base::Result<void> join();
  base::Result<void> await_active();
  base::Result<void> serve();
  base::Result<void> take_tick(shm::Participant& participant, shm::Tick& tick);
  base::Result<void> send(Input& input, std::string_view data);
  base::Result<void> feed(std::chrono::nanoseconds now);
  base::Result<void> feed_rest();
  base::Result<void> look_ahead(std::chrono::nanoseconds now);
  void expect(const ReadAhead::Sample& sample, std::chrono::nanoseconds now);
  base::Result<void> judge(std::chrono::nanoseconds now);
  base::Result<void> make_steps();
  void complain(Output& output, std::uint64_t tick, std::chrono::nanoseconds time, const std::string& what);
  void miss(std::chrono::nanoseconds before);
  std::optional<std::string> differ(const Output& output, const std::string& recorded, const std::string& sent);

  CORBA::ORB_ptr orb_;
  tools::RunningSystem& system_;
  const ReplayOptions& options_;
  mcap::Reader recording_;
  SampleValues values_;
  LifePlayer within_ticks_;   // of the thread
  LifePlayer between_ticks_;  // of who makes the steps
  std::map<std::uint16_t, Input> by_channel_;
  std::vector<std::unique_ptr<Output>> outputs_;
  // What came since it was judged last: place of the output, octets with their head.
  base::Guarded<std::vector<std::pair<std::size_t, std::string>>, base::Rank::queue> arrived_;
  std::optional<ReadAhead> ahead_;  // of inputs and, when they are compared, outputs
  std::optional<ReadAhead::Sample> next_;
  std::deque<ReadAhead::Sample> due_;      // inputs of this tick
  std::vector<ReadAhead::Sample> behind_;  // likewise, for after the component's
  std::optional<shm::Participant> before_, after_;
  std::uint32_t phase_ = 1;
  std::chrono::nanoseconds period_{0};
  std::atomic<bool> is_ending_{false};  // relaxed: says nothing but itself
  std::atomic<bool> has_stood_{false};  // something was done to the component since the last tick; relaxed: time says when
  base::Guarded<std::optional<base::Error>, base::Rank::noted> failure_;
  ReplayResult result_;
  std::thread thread_;
};

// ---- wiring ----

// "; it has a, b"
std::string in_ports(const tools::ComponentView& component) {
  std::vector<std::string> names;
  for (const auto& port : component.ports) {
    if (port.port_type() == "DataInPort") names.push_back(port.name);
  }
  return names.empty() ? ", it has none" : "; it has " + base::join(names, ", ");
}

base::Result<void> Player::connect() {
  tools::Session session(orb_, system_.naming(), std::chrono::milliseconds(call_limit));
  auto component = session.component(options_.component + ".rtc", {.contexts = true, .connectors = true});
  if (!component) return component.error();
  for (auto* life : {&between_ticks_, &within_ticks_}) {
    if (const auto begun = life->begin(*component); !begun) return begun;
  }
  std::map<std::string, std::uint16_t> topics;
  for (const auto& [id, channel] : recording_.channels()) topics.emplace(channel.topic, id);
  for (const auto& link : options_.links) {
    const auto* port = component->port(link.port);
    const auto channel = topics.find(link.topic);
    if (port == nullptr || port->port_type() != "DataInPort")
      return base::Error{"link of " + link.topic + ": component " + options_.component + " has no InPort " + base::in_quotes(link.port) +
                         in_ports(*component)};
    if (channel == topics.end()) return base::Error{"link of " + link.topic + " with " + link.port + ": is not there"};
    auto tap = tools::Tap::connect(orb_, *port, link.properties, {});
    if (!tap) return tap.error();
    Input& input = by_channel_[channel->second];
    input.topic = link.topic;
    input.comes_before = phase_of(recording_.channels().at(channel->second)) < phase_;
    input.targets.push_back(std::move(*tap));
  }
  mcap::Query wanted{.channels = {0}};  // none but these
  for (const auto& port : component->ports) {
    if (port.port_type() != "DataOutPort") continue;
    auto output = std::make_unique<Output>();
    output->result.topic = "/" + options_.component + "/" + port.name;
    if (const auto channel = topics.find(output->result.topic); channel != topics.end()) {
      output->channel = channel->second;
      if (options_.compares) wanted.channels.push_back(channel->second);
    }
    auto tap = tools::Tap::connect(orb_, port, {}, [this, place = outputs_.size()](std::span<const unsigned char> payload, bool is_little) {
      std::string octets = is_little ? std::string("\0\1\0\0", 4) : std::string(4, '\0');
      octets.append(reinterpret_cast<const char*>(payload.data()), payload.size());
      arrived_.lock()->emplace_back(place, std::move(octets));
    });
    if (!tap) return tap.error();
    output->tap = std::move(*tap);
    outputs_.push_back(std::move(output));
  }
  for (const auto& [channel, input] : by_channel_) wanted.channels.push_back(channel);
  auto reader = open_recording(options_.file);
  if (!reader) return reader.error();
  ahead_.emplace(std::move(*reader), std::move(wanted));
  return {};
}

// ---- ticks ----

base::Result<void> Player::join() {
  const auto id = static_cast<std::uint32_t>(base::parse_integer(system_.simulator()).value_or(0));
  auto simulation = shm::Iface::open(id, shm::IfaceType::simulation, "world");
  if (!simulation) return simulation.error();
  const auto there = shm::read_participants(*simulation);
  if (!there) return there.error();
  const auto found = std::ranges::find(*there, options_.component, &shm::ParticipantRecord::name);
  if (found == there->end()) return base::Error{"component " + options_.component + ": does not run on simulated time"};
  phase_ = found->phase;
  period_ = std::chrono::nanoseconds(found->period_ns);
  const auto take_place = [&](const char* name, std::uint32_t phase) {
    return shm::Participant::join(id, {.name = name, .phase = phase, .period = period_});
  };
  // A component of phase 0 has nobody before it.
  if (phase_ > 0) {
    auto before = take_place("replay-inputs", 0);
    if (!before) return before.error();
    before_.emplace(std::move(*before));
  }
  auto after = take_place("replay-outputs", last_phase);
  if (!after) return after.error();
  after_.emplace(std::move(*after));
  return {};
}

// Time stands still: the server takes participants in when it looks for them, some times a second.
base::Result<void> Player::await_active() {
  const auto deadline = WallClock::now() + call_limit;
  shm::Tick tick;
  while (!after_->is_active() || (before_ && !before_->is_active())) {
    if (WallClock::now() > deadline) return base::Error{"replay: the simulator does not take it into the lock step"};
    if (after_->wait(tick, 5ms) == shm::Participant::State::closed) return base::Error{"replay: the simulator has exited"};
  }
  return {};
}

base::Result<void> Player::take_tick(shm::Participant& participant, shm::Tick& tick) {
  while (!is_ending_.load(std::memory_order_relaxed)) {
    switch (participant.wait(tick, tick_limit)) {
      case shm::Participant::State::tick:
        return {};
      case shm::Participant::State::timed_out:
        break;
      case shm::Participant::State::dropped:
      case shm::Participant::State::closed:
        return base::Error{"replay: the simulator has exited"};
    }
  }
  return base::Error{""};  // the end
}

base::Result<void> Player::serve() {
  shm::Tick tick;
  while (!is_ending_.load(std::memory_order_relaxed)) {
    if (before_) {
      if (const auto come = take_tick(*before_, tick); !come) return come;
      if (const auto fed = feed(tick.now); !fed) return fed;
      before_->finish();
    }
    if (const auto come = take_tick(*after_, tick); !come) return come;
    if (!before_) {
      if (const auto fed = feed(tick.now); !fed) return fed;
    }
    if (const auto judged = judge(tick.now); !judged) return judged;
    if (const auto fed = feed_rest(); !fed) return fed;
    if (const auto made = within_ticks_.go_on(tick.now + period_); !made) return made;
    ++result_.ticks;
    after_->finish();
  }
  return {};
}

// ---- inputs ----

base::Result<void> Player::send(Input& input, std::string_view data) {
  if (data.size() < 4 || data[1] != 1) return base::Error{"channel " + input.topic + ": its samples are not in little-endian CDR"};
  for (const auto& target : input.targets) {
    if (const auto sent = target->put({reinterpret_cast<const unsigned char*>(data.data()) + 4, data.size() - 4}); !sent)
      return base::Error{"channel " + input.topic + ": " + sent.error().message};
    ++result_.sent;
  }
  return {};
}

// What the recording has up to this tick: inputs that are due, and outputs to be compared.
base::Result<void> Player::look_ahead(std::chrono::nanoseconds now) {
  const mcap::Time limit(static_cast<std::uint64_t>(now.count()));
  for (;;) {
    if (!next_) {
      auto sample = ahead_->next();
      if (!sample) return sample.error();
      if (!sample->has_value()) return {};
      next_ = std::move(*sample);
    }
    if (next_->time > limit) return {};
    if (options_.compares) expect(*next_, now);
    if (by_channel_.contains(next_->channel)) due_.push_back(std::move(*next_));
    next_.reset();
  }
}

base::Result<void> Player::feed(std::chrono::nanoseconds now) {
  if (const auto done = look_ahead(now); !done) return done;
  const mcap::Time limit(static_cast<std::uint64_t>(now.count()));
  for (; !due_.empty(); due_.pop_front()) {
    Input& target = by_channel_.at(due_.front().channel);
    if (due_.front().time == limit && !(before_ && target.comes_before)) {
      behind_.push_back(std::move(due_.front()));
    } else if (const auto sent = send(target, due_.front().data); !sent) {
      return sent;
    }
  }
  return {};
}

base::Result<void> Player::feed_rest() {
  for (const ReadAhead::Sample& input : std::exchange(behind_, {})) {
    if (const auto sent = send(by_channel_.at(input.channel), input.data); !sent) return sent;
  }
  return {};
}

// ---- outputs ----

void Player::expect(const ReadAhead::Sample& sample, std::chrono::nanoseconds now) {
  for (const auto& output : outputs_) {
    if (output->channel != sample.channel) continue;
    output->expected.push_back({now, result_.ticks, sample.data});
    ++output->result.recorded;
  }
}

void Player::complain(Output& output, std::uint64_t tick, std::chrono::nanoseconds time, const std::string& what) {
  ++output.result.different;
  if (!output.result.first.empty()) return;
  output.result.first_s = std::chrono::duration<double>(time).count();
  output.result.first =
      "tick " + std::to_string(tick) + " (" + base::format_number(std::chrono::duration<double>(time).count()) + " s): " + what;
}

// What was sent while time stood still behind a tick comes before the next one.
void Player::miss(std::chrono::nanoseconds before) {
  for (const auto& output : outputs_) {
    for (; !output->expected.empty() && output->expected.front().time < before; output->expected.pop_front())
      complain(*output, output->expected.front().tick, output->expected.front().time, "it did not send the sample that was recorded");
  }
}

std::optional<std::string> Player::differ(const Output& output, const std::string& recorded, const std::string& sent) {
  if (recorded == sent) return std::nullopt;
  const auto left = values_.of({output.channel, 0, {}, {}, recorded});
  const auto right = values_.of({output.channel, 0, {}, {}, sent});
  if (left && right) return difference(options_.tolerated, *left, *right);
  return "its bytes differ";
}

base::Result<void> Player::judge(std::chrono::nanoseconds now) {
  std::vector<std::pair<std::size_t, std::string>> sent;
  std::swap(sent, *arrived_.lock());
  if (!has_stood_.exchange(false, std::memory_order_relaxed)) miss(now);
  for (auto& [place, octets] : sent) {
    Output& output = *outputs_[place];
    ++output.result.samples;
    if (!options_.compares || output.channel == 0) continue;
    if (output.expected.empty()) {
      complain(output, result_.ticks, now, "it sent a sample that the recording does not have");
      continue;
    }
    const auto expected = std::move(output.expected.front());
    output.expected.pop_front();
    if (const auto what = differ(output, expected.octets, octets)) complain(output, expected.tick, expected.time, *what);
  }
  return {};
}

// To the end, and to each moment between two ticks in which something was done to the component.
base::Result<void> Player::make_steps() {
  const auto steps_to = [&](std::chrono::nanoseconds time) {
    return static_cast<std::int64_t>(std::floor(std::chrono::duration<double>(time).count() / system_.step() + 1e-6));
  };
  const auto last = std::max<std::int64_t>(1, std::llround(result_.simulated_s / system_.step()));
  std::int64_t done = 0;
  while (done < last) {
    const auto change = between_ticks_.next();
    const auto stop = change ? std::clamp(steps_to(*change), done, last) : last;
    if (stop > done) {
      if (const auto made = system_.make_steps(stop - done); !made) return made;
    }
    done = stop;
    if (!change || done == last) continue;
    if (const auto made = between_ticks_.go_on(*change); !made) return made;
    has_stood_.store(true, std::memory_order_relaxed);
  }
  return {};
}

base::Result<ReplayResult> Player::run() {
  if (const auto done = join(); !done) return done.error();
  if (const auto done = connect(); !done) return done.error();
  if (const auto done = await_active(); !done) return done.error();
  thread_ = std::thread([this] {
    const omni_thread::ensure_self known_to_the_orb;  // time-outs per thread need it
    const tools::CallLimit limited(call_limit);
    if (const auto served = serve(); !served && !served.error().message.empty()) *failure_.lock() = served.error();
    before_.reset();
    after_.reset();
  });
  result_.simulated_s = std::chrono::duration<double>(recording_.statistics().last).count();
  const auto began = WallClock::now();
  const auto made = make_steps();
  result_.wall_s = std::chrono::duration<double>(WallClock::now() - began).count();
  result_.changes = within_ticks_.done() + between_ticks_.done();
  is_ending_.store(true, std::memory_order_relaxed);
  thread_.join();
  if (const auto failure = failure_.snapshot()) return *failure;
  if (!made) return made.error();
  miss(std::chrono::nanoseconds::max());
  for (const auto& output : outputs_) result_.outputs.push_back(output->result);
  return result_;
}

}  // namespace

base::Result<ReplayResult> replay(CORBA::ORB_ptr orb, tools::RunningSystem& system, const ReplayOptions& options) {
  auto recording = open_recording(options.file);
  if (!recording) return recording.error();
  return Player(orb, system, options, std::move(*recording)).run();
}

}  // namespace recorder
