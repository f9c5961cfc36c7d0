// The gateway: ports, clients and the simulator in one event loop. One thread.
//
// Three more threads: that of alarm.h sleeps on the futexes of all subscribed ifaces. Two of async_requests.h send requests to the
// simulator, one of them those with expensive replies, such as maps. So samples are not polled, and a hanging simulator does not delay a
// client.
#pragma once

#include <sys/epoll.h>

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "access_policy.h"
#include "base/result.h"
#include "common/alarm.h"
#include "common/async_requests.h"
#include "listener.h"
#include "mapping.h"
#include "real_time.h"
#include "robot.h"
#include "session.h"
#include "simulator.h"
#include "timeline.h"

namespace gateway {

struct Options {
  std::uint32_t server_id = 0;
  std::string address = "127.0.0.1";
  std::uint16_t first_port = 6665;  // 0: any free ones
  AccessPolicy access;
  std::optional<std::vector<ConfiguredPort>> config;
};

class Gateway {
 public:
  explicit Gateway(Options options);
  ~Gateway();

  // Until SIGINT or SIGTERM, which must be blocked in all threads. Errors: a port that cannot be had.
  base::Result<void> run();

 private:
  struct Port {
    Listener listener;
    std::unique_ptr<Robot> robot;
    std::string said;  // what was printed of it
  };

  void add(int descriptor, std::uint64_t tag);
  void serve_ports(std::vector<PortPlan> plans);
  base::Result<void> open_port(std::uint16_t port);
  void arrange(const std::vector<ListedIface>& ifaces);
  void lose();
  void accept(Port& port);
  // Admits at most as many clients as leave descriptors for ifaces and pictures; of those that have asked for nothing the oldest gives way.
  // False when there is no room.
  bool make_room();
  void refuse(const Port& port, const std::string& peer, const std::string& why);
  void check_timeouts();
  void set_accepting(bool is_accepting);
  void handle(const epoll_event& event);
  void take_samples();
  void watch_sources();
  void serve_clients();

  const Options options_;
  const std::size_t descriptors_;  // that may be open; 0: not known
  int epoll_ = -1, signals_ = -1;
  Timeline timeline_;
  RealTime real_time_;
  AsyncRequests async_requests_, long_requests_;
  Alarm alarm_;
  Simulator simulator_;
  std::vector<Port> ports_;  // only ever more
  std::map<std::uint64_t, std::unique_ptr<Session>> sessions_;
  std::uint64_t next_session_ = 0;
  std::vector<std::string> missing_;  // of the mapping file, as said last
  std::vector<SharedSegment> watched_;
  std::uint64_t arranged_for_ = 0;  // which simulator the ports show
  struct {
    std::chrono::steady_clock::time_point told;
    std::uint64_t untold = 0;
  } refusals_;
  bool is_accepting_ = true;
  bool is_serving_ = false;  // all ports of the first world are open
  bool is_over_ = false;
  std::optional<base::Error> failed_;
};

}  // namespace gateway
