// Ifaces and OutPorts as sources of signals.
#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>

#include "shm/client.h"
#include "shm/iface_json.h"
#include "studio/signals.h"
#include "system/session.h"
#include "system/tap.h"
#include "system/value_codec.h"

namespace studio {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto source_return_period = 500ms;  // a source that is away is looked for so often
constexpr std::size_t max_samples_waiting = 256;
constexpr double farthest_stamp = 1000;                  // [s] from now: what is farther is of another clock
constexpr std::size_t max_octets_of_samples = 16 << 20;  // of samples of a port that wait

// Without a lease for subscribing it shows what others have the sensor measure.
class IfaceSource final : public SignalSource {
 public:
  IfaceSource(std::uint32_t server_id, std::string topic) : server_id_(server_id), topic_(std::move(topic)) {}

  std::vector<SignalSample> take() override {
    if (!iface_ && !open()) return {};
    if (iface_->status() != shm::Status::live) {
      iface_.reset();
      problem_ = "iface " + topic_ + ": the simulator has exited, or has removed it";
      return {};
    }
    return shm::has_frames(iface_->type()) ? take_frame() : take_sample();
  }
  std::string problem() override { return problem_; }

 private:
  bool open() {
    if (Clock::now() < next_try_) return false;
    next_try_ = Clock::now() + source_return_period;
    const auto colon = std::min(topic_.find(':'), topic_.size());
    const auto type = shm::parse_type(topic_.substr(0, colon));
    if (!type || colon == topic_.size()) return problem_ = "signal " + topic_ + ": expected TYPE:IFACE", false;
    auto found = shm::Iface::open(server_id_, *type, topic_.substr(colon + 1));
    if (!found) return problem_ = found.error().message, false;
    const auto subscribed = found->subscribe();
    problem_ = subscribed ? "" : subscribed.error().message;
    seen_ = 0;
    iface_ = std::move(*found);
    return true;
  }

  std::vector<SignalSample> take_sample() {
    if (iface_->sequence() == seen_ || !iface_->read()) return {};
    const auto& stamp = iface_->sample<shm::Stamp>();
    if (stamp.sequence == seen_) return {};
    seen_ = stamp.sequence;
    return {{static_cast<double>(stamp.sim_time_ns) / 1e9, simctl::sample_json(*iface_), {}}};
  }

  std::vector<SignalSample> take_frame() {
    if (iface_->sequence() == seen_) return {};
    const auto frame = iface_->hold();
    if (!frame) return {};
    seen_ = frame->sequence();
    return {{static_cast<double>(frame->head().stamp.sim_time_ns) / 1e9, simctl::frame_json(*frame), {}}};
  }

  const std::uint32_t server_id_;
  const std::string topic_;
  std::optional<shm::Iface> iface_;
  std::uint64_t seen_ = 0;
  std::string problem_;
  Clock::time_point next_try_{};
};

// A connection of subscription type new: the component never waits for us.
class PortTap : public std::enable_shared_from_this<PortTap> {
 public:
  // On a worker.
  void connect(const SignalSettings& settings, const std::string& path) {
    tools::Session session(settings.orb, settings.name_server, settings.call_limit);
    auto port = session.port(path);
    if (!port) return fail(port.error().message);
    const auto type = tools::type_code_of(port->port.data_type());
    if (CORBA::is_nil(type)) return fail("port " + path + ": its type " + port->port.data_type() + " is not known");
    const tools::CallLimit limited(settings.call_limit);
    auto tap = tools::Tap::connect(settings.orb, port->port, {{"dataport.subscription_type", "new"}},
                                   [self = shared_from_this()](std::span<const unsigned char> payload, bool is_little_endian) {
                                     self->put(payload, is_little_endian);
                                   });
    if (!tap) return fail(tap.error().message);
    auto data = data_.lock();
    data->tap = std::move(*tap);
    data->peer = RTC::PortService::_duplicate(port->port.object);
    data->type = CORBA::TypeCode::_duplicate(type);
    data->problem.clear();
    data->is_connecting = false;
  }

  struct Octets {
    std::vector<unsigned char> payload;
    bool is_little_endian = true;
    Clock::time_point arrived = Clock::now();
  };
  struct Data {
    std::unique_ptr<tools::Tap> tap;
    RTC::PortService_var peer;
    CORBA::TypeCode_var type;
    std::deque<Octets> waiting;
    std::size_t octets = 0;
    std::string problem;
    bool is_connecting = false;
    Clock::time_point heard{};
  };
  base::Guarded<Data, base::Rank::connector>& data() { return data_; }

 private:
  void fail(std::string problem) {
    auto data = data_.lock();
    data->problem = std::move(problem);
    data->is_connecting = false;
  }

  // On the ORB's threads.
  void put(std::span<const unsigned char> payload, bool is_little_endian) {
    if (payload.size() > max_octets_of_samples) return;
    Octets octets{{payload.begin(), payload.end()}, is_little_endian};
    auto data = data_.lock();
    data->heard = Clock::now();
    data->octets += payload.size();
    data->waiting.push_back(std::move(octets));
    while (data->waiting.size() > max_samples_waiting || data->octets > max_octets_of_samples) {
      data->octets -= data->waiting.front().payload.size();
      data->waiting.pop_front();
    }
  }

  base::Guarded<Data, base::Rank::connector> data_;
};

// Of a Timed type its own time, when it has one.
std::optional<double> time_of(const Json& value) {
  const auto tm = value.is_object() ? value.find("tm") : value.end();
  if (!value.is_object() || tm == value.end() || !tm->is_object()) return std::nullopt;
  const double time = tm->value("sec", 0.0) + tm->value("nsec", 0.0) * 1e-9;
  return time > 0 ? std::optional(time) : std::nullopt;
}

class PortSource final : public SignalSource {
 public:
  PortSource(const SignalSettings& settings, std::string path, Workers& workers)
      : settings_(settings), path_(std::move(path)), workers_(workers) {}

  // The connection is ended by a worker: the component may hang.
  ~PortSource() override {
    auto tap = tap_;
    tap_.reset();
    (void)workers_.give([tap = std::move(tap), limit = settings_.call_limit] {
      const tools::CallLimit limited(limit);
      auto ended = std::move(tap->data().lock()->tap);
      ended.reset();
    });
  }

  std::vector<SignalSample> take() override {
    std::deque<PortTap::Octets> octets;
    CORBA::TypeCode_var type;
    {
      auto data = tap_->data().lock();
      octets = std::exchange(data->waiting, {});
      data->octets = 0;
      type = data->type;
    }
    if (octets.empty()) look_after();
    std::vector<SignalSample> samples;
    for (const auto& one : octets) {
      auto value = tools::decode(type, one.payload, one.is_little_endian);
      if (!value) continue;
      const auto stamp = time_of(*value);
      samples.push_back({stamp.value_or(now()), std::move(*value), stamp ? latency_of(*stamp, one.arrived) : std::nullopt});
    }
    return samples;
  }
  std::string problem() override { return tap_->data().lock()->problem; }

 private:
  // Connects, and again when nothing has come for a while and the connection is not there any more.
  void look_after() {
    if (Clock::now() < next_try_) return;
    next_try_ = Clock::now() + source_return_period * 4;
    {
      auto data = tap_->data().lock();
      if (data->is_connecting || Clock::now() - data->heard < source_return_period * 4) return;
      data->is_connecting = true;
    }
    const bool is_given = workers_.give([tap = tap_, settings = settings_, path = path_] { renew(*tap, settings, path); });
    if (!is_given) tap_->data().lock()->is_connecting = false;
  }

  static void renew(PortTap& tap, const SignalSettings& settings, const std::string& path) {
    RTC::PortService_var peer;
    {
      auto data = tap.data().lock();
      if (data->tap) peer = data->peer;
    }
    if (!CORBA::is_nil(peer)) {
      bool is_gone = false;
      const tools::CallLimit limited(settings.call_limit);
      const auto asked = tools::remote("port " + path, [&] { is_gone = peer->_non_existent(); });
      if (asked && !is_gone) {
        tap.data().lock()->is_connecting = false;
        return;
      }
      auto old = std::move(tap.data().lock()->tap);
      old.reset();
    }
    tap.connect(settings, path);
  }

  // Stamps are of simulated time or of the wall clock: of the one that they are near to.
  std::optional<double> latency_of(double stamp, Clock::time_point arrived) {
    const double since = std::chrono::duration<double>(Clock::now() - arrived).count();
    const double simulated = now();
    if (clock_) {
      const auto& sample = clock_->sample<shm::SimulationSample>();
      const double latency = simulated - (sample.paused != 0 ? 0 : since * sample.rtf_reached) - stamp;
      if (std::abs(latency) < farthest_stamp) return std::max(latency, 0.0);
    }
    const double wall = std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
    const double latency = wall - since - stamp;
    return std::abs(latency) < farthest_stamp ? std::optional(std::max(latency, 0.0)) : std::nullopt;
  }

  double now() {
    if (!clock_ && Clock::now() >= next_clock_) {
      next_clock_ = Clock::now() + source_return_period;
      auto clock = shm::Iface::open(settings_.server_id, shm::IfaceType::simulation, "world");
      if (clock) clock_ = std::move(*clock);
    }
    if (clock_ && clock_->status() != shm::Status::live) clock_.reset();
    if (clock_ && clock_->read()) return static_cast<double>(clock_->sample<shm::Stamp>().sim_time_ns) / 1e9;
    return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
  }

  const SignalSettings settings_;
  const std::string path_;
  Workers& workers_;
  std::shared_ptr<PortTap> tap_ = std::make_shared<PortTap>();
  std::optional<shm::Iface> clock_;
  Clock::time_point next_try_{}, next_clock_{};
};

}  // namespace

std::unique_ptr<SignalSource> iface_source(const SignalSettings& settings, const std::string& topic) {
  return std::make_unique<IfaceSource>(settings.server_id, topic);
}

std::unique_ptr<SignalSource> port_source(const SignalSettings& settings, const std::string& topic, Workers& workers) {
  return std::make_unique<PortSource>(settings, topic, workers);
}

}  // namespace studio
