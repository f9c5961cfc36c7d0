// The values for plots: samples of ifaces and OutPorts. A thread of its own reads shared memory and collects samples
// of ports; a worker connects to ports. A subscription continues when its source was unavailable for a while. Any
// thread.
#pragma once

#include <omniORB4/CORBA.h>

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "base/guarded.h"
#include "studio/client_message.h"
#include "studio/workers.h"

namespace studio {

struct WatchKey {
  std::uint64_t viewer = 0;
  std::uint32_t watch = 0;  // as the viewer calls it
  auto operator<=>(const WatchKey&) const = default;
};

struct WatchOrder {
  std::string topic;                 // "TYPE:IFACE", or "/HOST/.../NAME.rtc:PORT"
  std::vector<std::string> members;  // "velocity[0]", "pose.position[2]"; none: whole samples
  double hz = 30;                    // of events
};

struct SignalSettings {
  CORBA::ORB_ptr orb = CORBA::ORB::_nil();
  std::string name_server;
  std::uint32_t server_id = 0;
  std::chrono::milliseconds call_limit{1000};
};

// One value with the time that it belongs to [s].
struct SignalSample {
  double time = 0;
  Json value;
  std::optional<double> latency{};  // [s] from its time stamp until it was here, by the clock of the stamp
};

// Where samples of one topic come from. The thread of the signals only, except where said.
class SignalSource {
 public:
  virtual ~SignalSource() = default;
  // What has come since the last call, at most 256, the newest.
  virtual std::vector<SignalSample> take() = 0;
  // Why nothing comes; empty: all is well.
  virtual std::string problem() = 0;
};

std::unique_ptr<SignalSource> iface_source(const SignalSettings& settings, const std::string& topic);
std::unique_ptr<SignalSource> port_source(const SignalSettings& settings, const std::string& topic, Workers& workers);

// "a.b[2].c" in a JSON value; null when there is no such place.
Json member_at(const Json& value, const std::string& path);

class Signals {
 public:
  using Tell = std::function<void(WatchKey, std::string)>;  // an event "values", on the thread of the signals

  // The workers must live longer.
  Signals(SignalSettings settings, Workers& workers, Tell tell);
  ~Signals();
  Signals(const Signals&) = delete;
  Signals& operator=(const Signals&) = delete;

  // Takes the place of one with this key.
  base::Result<void> watch(const WatchKey& key, WatchOrder order);
  void unwatch(const WatchKey& key);
  void unwatch_all(std::uint64_t viewer);

 private:
  using Clock = std::chrono::steady_clock;
  struct Data {
    std::map<WatchKey, WatchOrder> orders;
    std::uint64_t changes = 0;
    bool is_ending = false;
  };
  struct Watch {
    WatchOrder order;
    Clock::time_point next{};
    std::vector<double> times;
    Json rows = Json::array();
    Json whole;
    std::string told_problem;
    std::optional<double> latency;
    bool is_new = true;
  };
  // How many samples a second have come, over the last one or two.
  struct Rate {
    void count(std::size_t samples, Clock::time_point now);
    std::size_t counted = 0;
    Clock::time_point since = Clock::now();
    std::optional<double> hz;
  };
  struct Source {
    std::unique_ptr<SignalSource> source;
    std::optional<SignalSample> last;  // for those who begin to watch while nothing comes
    Rate rate;
  };
  void run();
  void take_orders();
  void gather();
  static void add(Watch& watch, const SignalSample& sample);
  void flush(const WatchKey& key, Watch& watch, Source& from);

  const SignalSettings settings_;
  Workers& workers_;
  const Tell tell_;
  // The thread's:
  std::uint64_t changes_ = 0;
  std::map<WatchKey, Watch> watches_;
  std::map<std::string, Source> sources_;  // by topic
  base::Guarded<Data, base::Rank::manager> data_;
  std::condition_variable changed_;
  std::thread thread_;  // last: it uses all of these
};

}  // namespace studio
