#include "gateway.h"

#include <errno.h>
#include <signal.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>

#include "base/descriptors.h"
#include "base/log.h"
#include "base/text.h"

namespace gateway {
namespace {

// What an event is about: the kind in the upper half of the tag, which one in the lower.
enum class Kind : std::uint32_t { signal, alarm, async_request, long_request, port, session };
constexpr std::uint64_t tag(Kind kind, std::uint64_t which = 0) { return static_cast<std::uint64_t>(kind) << 56 | which; }
constexpr Kind kind_of(std::uint64_t value) { return static_cast<Kind>(value >> 56); }
constexpr std::uint64_t which_of(std::uint64_t value) { return value & ((std::uint64_t{1} << 56) - 1); }

// Descriptors that clients leave: for ifaces, requests and the log.
std::size_t client_limit(std::size_t descriptors) {
  constexpr std::size_t other_descriptors = 128;
  return descriptors == 0 ? 256 : descriptors - std::min(other_descriptors, descriptors / 2);
}

constexpr int look_period = 200;  // [ms] between looks at the simulator's life

}  // namespace

Gateway::Gateway(Options options)
    : options_(std::move(options)),
      descriptors_(base::raise_descriptor_limit()),
      epoll_(::epoll_create1(EPOLL_CLOEXEC)),
      async_requests_(options_.server_id),
      long_requests_(options_.server_id),
      simulator_(
          options_.server_id, async_requests_, real_time_, [this](const std::vector<ListedIface>& ifaces) { arrange(ifaces); },
          [this] { lose(); }) {}

Gateway::~Gateway() {
  sessions_.clear();  // before the robots that they use
  if (signals_ >= 0) ::close(signals_);
  ::close(epoll_);
}

void Gateway::add(int descriptor, std::uint64_t what) {
  epoll_event event{};
  event.events = EPOLLIN;
  event.data.u64 = what;
  ::epoll_ctl(epoll_, EPOLL_CTL_ADD, descriptor, &event);
}

base::Result<void> Gateway::run() {
  constexpr std::size_t fewest = 32;
  if (descriptors_ != 0 && descriptors_ < fewest)
    return base::Error{fmt::format("too few file descriptors: {} may be open, expected at least {}", descriptors_, fewest)};
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  signals_ = ::signalfd(-1, &signals, SFD_CLOEXEC | SFD_NONBLOCK);
  if (epoll_ < 0 || signals_ < 0 || alarm_.descriptor() < 0 || async_requests_.descriptor() < 0 || long_requests_.descriptor() < 0)
    return base::Error{"no file descriptors left"};
  add(signals_, tag(Kind::signal));
  add(alarm_.descriptor(), tag(Kind::alarm));
  add(async_requests_.descriptor(), tag(Kind::async_request));
  add(long_requests_.descriptor(), tag(Kind::long_request));
  if (options_.config) {
    for (const ConfiguredPort& port : *options_.config) {
      if (auto good = open_port(port.port); !good) return good;
    }
  }
  if (const auto words = describe(options_.access, options_.address); !words.empty())
    base::log(base::Level::warn, "player-gateway", "{}", words);
  simulator_.look();
  if (!simulator_.is_there()) base::log(base::Level::info, "player-gateway", "waiting for simulator {}", options_.server_id);
  auto next_look = std::chrono::steady_clock::now();
  while (!is_over_ && !failed_) {
    std::array<epoll_event, 64> events;
    const int count = ::epoll_wait(epoll_, events.data(), events.size(), look_period);
    for (int i = 0; i < count; ++i) handle(events[static_cast<std::size_t>(i)]);
    if (const auto now = std::chrono::steady_clock::now(); now >= next_look) {
      next_look = now + std::chrono::milliseconds(look_period);
      simulator_.look();
      check_timeouts();
      set_accepting(true);
    }
    serve_clients();
    watch_sources();
  }
  if (failed_) return *failed_;
  return {};
}

void Gateway::handle(const epoll_event& event) {
  const std::uint64_t which = which_of(event.data.u64);
  switch (kind_of(event.data.u64)) {
    case Kind::signal:
      is_over_ = true;
      return;
    case Kind::alarm:
      alarm_.clear();
      return take_samples();
    case Kind::async_request:
      return async_requests_.deliver();
    case Kind::long_request:
      return long_requests_.deliver();
    case Kind::port:
      return accept(ports_[which]);
    case Kind::session:
      if (const auto found = sessions_.find(which); found != sessions_.end()) {
        // A client that is not listened to while it waits still can vanish: errors are always told, and received.
        if ((event.events & (EPOLLIN | EPOLLERR | EPOLLHUP)) != 0) found->second->receive();
      }
  }
}

// ---- the world ----

void Gateway::arrange(const std::vector<ListedIface>& ifaces) {
  std::vector<std::string> missing;
  auto plans = options_.config ? plan_by_config(*options_.config, ifaces, missing) : plan_by_world(ifaces, options_.first_port);
  if (!options_.config && arranged_for_ == simulator_.met()) {
    std::vector<std::string> robots;
    for (const Port& port : ports_) robots.push_back(port.robot->name());
    plans = keep_ports(std::move(plans), robots, options_.first_port);
  }
  arranged_for_ = simulator_.met();
  if (missing != missing_) {
    for (const auto& one : missing) base::log(base::Level::warn, "player-gateway", "{}", one);
    missing_ = std::move(missing);
  }
  serve_ports(std::move(plans));
}

void Gateway::serve_ports(std::vector<PortPlan> plans) {
  const FindSource find = [this](shm::IfaceType type, const std::string& name) { return simulator_.find(type, name); };
  for (std::size_t i = 0; i < plans.size(); ++i) {
    if (i == ports_.size()) {
      if (auto good = open_port(plans[i].port); !good) {
        // At the start somebody is there to choose another port; later the robots that are served go on.
        if (!is_serving_) failed_ = good.error();
        if (is_serving_) base::log(base::Level::error, "player-gateway", "{}: {}", plans[i].name, good.error().message);
        return;
      }
    }
    Port& port = ports_[i];
    port.robot->arrange(plans[i], find);
    std::string line = "port " + std::to_string(port.robot->port()) + ": " + plans[i].name + ":";
    for (const auto& word : port.robot->shown()) line += " " + word;
    if (line == port.said) continue;
    port.said = line;
    std::printf("%s\n", base::printable(line).c_str());
    std::fflush(stdout);
  }
  // Of a world that had more robots.
  for (std::size_t i = plans.size(); i < ports_.size(); ++i) ports_[i].robot->arrange({0, std::string(no_robot), {}}, find);
  is_serving_ = true;
}

base::Result<void> Gateway::open_port(std::uint16_t number) {
  auto listener = Listener::open(options_.address, number);
  if (!listener) return listener.error();
  const Services services{async_requests_, long_requests_, timeline_, real_time_};
  auto robot = std::make_unique<Robot>(listener->port(), services);
  add(listener->socket(), tag(Kind::port, ports_.size()));
  ports_.push_back({std::move(*listener), std::move(robot), ""});
  return {};
}

void Gateway::lose() {
  for (const Port& port : ports_) port.robot->detach();
}

void Gateway::take_samples() {
  // Read all first: a device that shows two of them shows those of one moment.
  std::vector<std::shared_ptr<Source>> fresh;
  for (auto& source : simulator_.sources()) {
    if (source->is_read() && source->take_news()) fresh.push_back(std::move(source));
  }
  for (const auto& source : fresh) {
    for (const Port& port : ports_) {
      for (const auto& device : port.robot->all()) {
        if (device->source() == source || (device->companion() == source && device->shows_companion())) device->take_sample();
      }
    }
  }
}

void Gateway::watch_sources() {
  std::vector<SharedSegment> segments;
  for (const auto& source : simulator_.sources()) {
    if (!source->is_read()) continue;
    if (auto segment = source->segment()) segments.push_back(std::move(segment));
  }
  if (segments == watched_) return;
  watched_ = segments;
  alarm_.watch(std::move(segments));
}

// ---- clients ----

void Gateway::accept(Port& port) {
  // A few at a time: those who are there already are not to wait for those who come.
  for (int i = 0; i < 16; ++i) {
    auto accepted = port.listener.accept();
    if (accepted.is_exhausted) {
      base::log(base::Level::warn, "player-gateway", "no file descriptors left: {} clients are connected", sessions_.size());
      return set_accepting(false);
    }
    if (accepted.socket < 0) return;
    const Entry entry = options_.access.entry(accepted.socket);
    if (entry == Entry::refused || !make_room()) {
      ::close(accepted.socket);
      refuse(port, accepted.peer, entry == Entry::refused ? "of another account or host" : "too many clients");
      continue;
    }
    const std::uint64_t id = next_session_++;
    auto session = std::make_unique<Session>(accepted.socket, std::move(accepted.peer), options_.access, entry == Entry::needs_key,
                                             *port.robot, timeline_);
    session->known_events = EPOLLIN;
    add(accepted.socket, tag(Kind::session, id));
    sessions_.emplace(id, std::move(session));
  }
}

bool Gateway::make_room() {
  if (sessions_.size() < client_limit(descriptors_)) return true;
  const auto oldest = std::find_if(sessions_.begin(), sessions_.end(), [](const auto& entry) { return !entry.second->is_admitted(); });
  if (oldest == sessions_.end()) return false;
  oldest->second->give_way();
  sessions_.erase(oldest);
  return true;
}

void Gateway::refuse(const Port& port, const std::string& peer, const std::string& why) {
  constexpr std::chrono::seconds quiet{1};  // between lines, whatever comes
  const auto now = std::chrono::steady_clock::now();
  if (now - refusals_.told < quiet) {
    ++refusals_.untold;
    return;
  }
  base::log(base::Level::warn, "player-gateway", "port {}: {} rejected: {}{}", port.robot->port(), peer, why,
            refusals_.untold > 0 ? fmt::format(" ({} others before it)", refusals_.untold) : std::string());
  refusals_ = {now, 0};
}

void Gateway::check_timeouts() {
  const auto now = std::chrono::steady_clock::now();
  for (const auto& [id, session] : sessions_) session->check_timeouts(now);
}

void Gateway::set_accepting(bool is_accepting) {
  if (is_accepting == is_accepting_) return;
  is_accepting_ = is_accepting;
  for (std::size_t i = 0; i < ports_.size(); ++i) {
    epoll_event event{};
    event.events = is_accepting ? static_cast<std::uint32_t>(EPOLLIN) : 0U;
    event.data.u64 = tag(Kind::port, i);
    ::epoll_ctl(epoll_, EPOLL_CTL_MOD, ports_[i].listener.socket(), &event);
  }
}

void Gateway::serve_clients() {
  for (auto entry = sessions_.begin(); entry != sessions_.end();) {
    Session& session = *entry->second;
    session.serve();
    if (session.is_over()) {
      entry = sessions_.erase(entry);
      continue;
    }
    if (const std::uint32_t wanted = session.wanted_events(); wanted != session.known_events) {
      epoll_event event{};
      event.events = session.known_events = wanted;
      event.data.u64 = tag(Kind::session, entry->first);
      ::epoll_ctl(epoll_, EPOLL_CTL_MOD, session.socket(), &event);
    }
    ++entry;
  }
}

}  // namespace gateway
