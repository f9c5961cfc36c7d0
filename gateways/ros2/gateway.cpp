#include "gateway.h"

#include <signal.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <set>
#include <tuple>

#include "base/descriptors.h"
#include "base/log.h"
#include "base/text.h"
#include "names.h"
#include "parameters.h"
#include "robot_topics.h"

namespace ros2 {
namespace {

constexpr std::chrono::milliseconds look_period{200}, resend_period{50}, tend_period{10};
constexpr std::chrono::seconds report_period{5}, paused_clock_period{1};
constexpr std::chrono::milliseconds idle_wait{20};

constexpr const char* started_key = "started";

// With leading zeros: texts compare as the numbers do.
std::string now_as_text() { return fmt::format("{:020}", std::chrono::system_clock::now().time_since_epoch().count()); }

std::chrono::nanoseconds tick_period(double clock_rate) {
  return std::chrono::nanoseconds(clock_rate > 0 ? static_cast<std::int64_t>(1e9 / clock_rate) : 0);
}

std::set<std::string> robots_in(const Listed& listed) {
  std::set<std::string> robots;
  for (const auto& iface : listed.ifaces) {
    if (iface.type == shm::IfaceType::simulation || iface.type == shm::IfaceType::truth) continue;
    const std::string& scoped = iface.model.empty() ? iface.name : iface.model;
    robots.insert(scoped.substr(0, scoped.find("::")));
  }
  return robots;
}

}  // namespace

Gateway::Gateway(Options options)
    : options_(std::move(options)),
      started_(now_as_text()),
      async_requests_(options_.server_id),
      steps_(options_.server_id),
      lock_step_(options_.is_lockstep ? std::make_unique<LockStepParticipant>(options_.server_id, tick_period(options_.clock_rate))
                                      : nullptr),
      bell_([this] {
        if (lock_step_) lock_step_->interrupt();
      }),
      world_(
          options_.server_id, async_requests_, [this](const Listed& listed) { arrange(listed); }, [this] { lose(); }),
      waits_(options_.waits) {}

Gateway::~Gateway() {
  if (lock_step_) lock_step_->leave();
  robots_.clear();
  services_.reset();
  node_.reset();
  graph_.reset();
  participant_.reset();
  if (signals_ >= 0) ::close(signals_);
}

base::Result<void> Gateway::open() {
  base::raise_descriptor_limit();
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  signals_ = ::signalfd(-1, &signals, SFD_CLOEXEC | SFD_NONBLOCK);
  options_.dds.on_news = [this] { bell_.ring(); };
  auto participant = Participant::open(options_.dds);
  if (!participant) return participant.error();
  participant_ = std::move(*participant);
  auto graph = Graph::open(*participant_, options_.family);
  if (!graph) return graph.error();
  graph_ = std::move(*graph);
  node_ = std::make_unique<Node>(*participant_, *graph_, gateway_node);
  if (options_.has_clock) clock_ = node_->advertise<ros::Clock>("/clock", {.note = started_key + ("=" + started_ + ";")});
  Writer* tf = options_.naming.has_tf_per_robot ? nullptr : node_->advertise<ros::TFMessage>("/tf", {false, 100});
  if (!options_.naming.has_tf_per_robot) tf_static_ = node_->advertise<ros::TFMessage>("/tf_static", {true, 1});
  rosout_ = complete_node(*node_, {.are_served = options_.has_parameters});
  services_ = std::make_unique<SimulationServices>(*node_, world_, async_requests_, steps_, options_.service_prefix, namespaces());
  shared_ = std::make_unique<Shared>(Shared{*participant_, *graph_, world_, options_.naming, tf, options_.command_timeout,
                                            [this](const Arrival& arrival) { return waits_.arrive(arrival); }, options_.has_joint_tf});
  if (!bell_.ring_for(signals_) || !bell_.ring_for(async_requests_.descriptor()) || !bell_.ring_for(steps_.descriptor()))
    return base::Error{"no file descriptors left"};
  return {};
}

base::Result<void> Gateway::run() {
  if (auto done = open(); !done) return done;
  world_.look();
  if (!world_.is_there()) base::log(base::Level::info, "ros2-gateway", "waiting for simulator {}", options_.server_id);
  while (!is_over_ && !failed_) turn_loop();
  report_losses();
  if (rosout_ != nullptr) logs_.send(*rosout_);
  if (failed_) return *failed_;
  return {};
}

void Gateway::turn_loop() {
  const std::uint32_t rings = bell_.rings();
  if (ifaces_.take_news()) take_samples();
  if (rings != answered_) answer_bell();
  answered_ = rings;
  const auto now = std::chrono::steady_clock::now();
  if (now >= next_update_) update(now);
  if (are_sources_due_) choose_sources();
  tend_tick(now);
  sleep(rings);
}

void Gateway::sleep(std::uint32_t rings) {
  if (!lock_step_ || tick_ || !lock_step_->join()) return bell_.sleep(ifaces_, rings, idle_wait);
  if (bell_.rings() != rings) return;
  const auto tick = lock_step_->sleep(idle_wait);
  if (!tick) return;
  // What came before the tick is no answer to it.
  if (const std::uint32_t news = bell_.rings(); news != answered_) {
    answer_bell();
    answered_ = news;
  }
  begin_tick(*tick);
}

void Gateway::update(Time now) {
  next_update_ = now + tend_period;
  node_->update(now);
  services_->update(now);
  if (rosout_ != nullptr) logs_.send(*rosout_);
  for (const auto& robot : robots_) robot->node().update(now);
  graph_->update(now);
  if (now >= next_look_) {
    next_look_ = now + look_period;
    are_sources_due_ = true;
    world_.look();
    watch_other_clocks();
    send_clock(false);
  }
  if (now >= next_report_) {
    next_report_ = now + report_period;
    report_losses();
  }
}

void Gateway::choose_sources() {
  are_sources_due_ = false;
  bool has_changed = false;
  for (const auto& robot : robots_) has_changed = robot->choose_sources() || has_changed;
  choose_clock();
  std::vector<SharedSegment> watched;
  if (world_.clock() && clock_ != nullptr && !clock_->readers().empty()) watched.push_back(world_.clock()->segment());
  for (const auto& source : world_.sources()) {
    if (source->is_read()) watched.push_back(source->segment());
  }
  std::erase(watched, nullptr);
  if (lock_step_) watched.clear();  // the ticks say when there is something new
  if (has_changed && !lock_step_ && is_paused()) async_requests_.post(shm::ShowRequest{}, [](const base::Result<shm::Reply>&) {});
  if (!has_changed && watched == watched_) return;
  ifaces_.replace(watched);
  watched_ = std::move(watched);
}

// A simulator whose ifaces have no reader makes several steps at once. Their clocks would come in bursts.
void Gateway::choose_clock() {
  constexpr double bursts = 200;  // [Hz] of steps together, at most
  const bool is_fast = options_.clock_rate == 0 || options_.clock_rate > bursts / 2;
  const bool is_wanted = is_fast && !lock_step_ && clock_ != nullptr && !clock_->readers().empty();
  const auto wanted = is_wanted ? world_.clock() : nullptr;
  if (wanted == read_clock_) return;
  if (read_clock_) read_clock_->remove_reader();
  read_clock_ = wanted;
  if (!read_clock_) return;
  if (const auto done = read_clock_->add_reader(); !done) {
    base::log(base::Level::warn, "ros2-gateway", "{}", done.error().message);
    read_clock_.reset();
  }
}

bool Gateway::is_paused() const {
  return world_.clock() && world_.clock()->iface().read() && world_.clock()->iface().sample<shm::SimulationSample>().paused != 0;
}

// Time would jump back and forth between two of them. Of two gateways the older one goes on.
void Gateway::watch_other_clocks() {
  const auto peers = graph_->peers_of("rt/clock");
  const auto other = std::ranges::find_if(peers, [this](const Peer* peer) {
    if (!peer->is_writer || clock_ == nullptr) return false;
    const auto started = value_in(peer->user_data, started_key);
    return !started || std::tie(*started, peer->guid) < std::tie(started_, clock_->guid());
  });
  const bool is_foreign = other != peers.end();
  if (is_foreign && !is_clock_foreign_)
    base::log(base::Level::error, "ros2-gateway",
              "another node publishes /clock: {}. This gateway does not publish it until that one has ended",
              graph_->node_of((*other)->guid));
  is_clock_foreign_ = is_foreign;
}

void Gateway::answer_bell() {
  signalfd_siginfo signal{};
  if (::read(signals_, &signal, sizeof signal) == sizeof signal) is_over_ = true;
  if (participant_->deliver()) are_sources_due_ = true;
  async_requests_.deliver();
  steps_.deliver();
}

// ---- the world ----

Namespaces Gateway::namespaces() {
  return {[this](const std::string& space) {
            const auto user =
                std::ranges::find_if(robots_, [&](const auto& robot) { return options_.naming.names_of(robot->model()).space == space; });
            return user == robots_.end() ? std::string() : (*user)->model();
          },
          [this](const std::string& model, const std::string& space) {
            options_.naming.spaces.erase(model);
            if (!space.empty()) options_.naming.spaces[model] = space;
          }};
}

void Gateway::arrange(const Listed& listed) {
  const auto wanted = robots_in(listed);
  // Another one may have the name of one that was deleted.
  std::erase_if(robots_, [&](const auto& robot) { return !wanted.contains(robot->model()) || robot->is_gone(); });
  for (const auto& model : wanted) {
    if (std::ranges::any_of(robots_, [&](const auto& robot) { return robot->model() == model; })) continue;
    const auto has_names = [&](const auto& robot) {
      return options_.naming.names_of(robot->model()).space == options_.naming.names_of(model).space;
    };
    if (const auto same = std::ranges::find_if(robots_, has_names); same != robots_.end()) {
      base::log(base::Level::error, "ros2-gateway",
                "robot {} is not served: robot {} has the namespace {} already; give it another one with --config", model, (*same)->model(),
                options_.naming.names_of(model).space);
      continue;
    }
    robots_.push_back(std::make_unique<Robot>(*shared_, model, listed));
    std::string line = "node " + robots_.back()->node().name().full() + ":";
    for (const auto& topic : robots_.back()->topics()) line += " " + topic.substr(0, topic.find(' '));
    std::printf("%s\n", base::printable(line).c_str());
    if (!options_.naming.is_one_node) complete_node(robots_.back()->node(), {.are_served = options_.has_parameters});
  }
  std::printf("domain %u: %zu robots\n", options_.dds.domain, robots_.size());
  std::fflush(stdout);
  name_unknown(listed);
  are_sources_due_ = true;
  send_static_transforms();
}

void Gateway::name_unknown(const Listed& listed) {
  const auto models = robots_in(listed);
  KnownNames known{{models.begin(), models.end()}, {}, command_topics(), {}};
  for (const auto& iface : listed.ifaces) known.ifaces.push_back(iface.name);
  for (const auto& robot : robots_) known.types.insert(robot->types().begin(), robot->types().end());
  auto lines = lines_of_unknown_names(options_.naming, options_.waits, known);
  if (lock_step_ && world_.clock() && world_.clock()->iface().info<shm::SimulationInfo>().lockstep == 0)
    lines.push_back("--lockstep: time does not wait, because the simulator was started without --lockstep");
  std::ranges::move(lines_of_shared_names(used_names()), std::back_inserter(lines));
  for (const auto& line : lines) {
    if (named_.insert(line).second) base::log(base::Level::warn, "ros2-gateway", "{}", line);
  }
}

UsedNames Gateway::used_names() const {
  UsedNames used{{}, command_topics(), {}};
  const auto add = [&](const Node& node) {
    for (const auto& writer : node.writers()) used.writers[writer->settings().topic.substr(2)].insert(type_of_ros(writer->settings().type));
  };
  add(*node_);
  for (const auto& robot : robots_) {
    add(robot->node());
    if (!options_.naming.has_tf_per_robot) used.frame_prefixes[robot->model()] = options_.naming.names_of(robot->model()).frame_prefix;
  }
  return used;
}

void Gateway::send_static_transforms() {
  ros::TFMessage message;
  for (const auto& robot : robots_) {
    robot->send_static_transforms();
    const auto own = robot->static_transforms();
    message.transforms.insert(message.transforms.end(), own.begin(), own.end());
  }
  if (tf_static_ != nullptr) publish(*tf_static_, message);
}

void Gateway::lose() {
  robots_.clear();
  options_.naming.spaces.clear();
  read_clock_.reset();
  clock_ns_ = -1;
  are_sources_due_ = true;
}

void Gateway::take_samples() {
  for (const auto& robot : robots_) robot->read();
  send_clock(false);
  for (const bool is_first : {true, false}) {
    for (const auto& robot : robots_) robot->show(is_first);
  }
}

void Gateway::send_clock(bool is_forced) {
  const auto& source = world_.clock();
  if (!source || !source->iface().read() || clock_ == nullptr || is_clock_foreign_) return;
  const auto& sample = source->iface().sample<shm::SimulationSample>();
  const std::int64_t now = tick_ ? tick_->now.count() : sample.stamp.sim_time_ns;
  const auto wall = std::chrono::steady_clock::now();
  const std::int64_t period = options_.clock_rate > 0 ? static_cast<std::int64_t>(1e9 / options_.clock_rate) : 1;
  const bool is_reset = clock_ns_ < 0 || sample.stamp.resets != resets_ || now < clock_ns_;
  const bool is_due =
      sample.paused != 0 ? now != clock_ns_ || wall >= clock_sent_ + paused_clock_period : now / period != clock_ns_ / period;
  if (!is_forced && !is_reset && !is_due) return;
  clock_ns_ = now;
  clock_sent_ = wall;
  publish(*clock_, ros::Clock{ros::to_time(std::chrono::nanoseconds(now))});
  if (!is_reset) return;
  if (sample.stamp.resets != resets_) waits_.rewind();
  resets_ = sample.stamp.resets;
  send_static_transforms();
}

// ---- lock step ----

std::vector<std::string> Gateway::command_topics() const {
  std::vector<std::string> topics;
  for (const auto& robot : robots_) topics.insert(topics.end(), robot->commands().topics().begin(), robot->commands().topics().end());
  return topics;
}

void Gateway::begin_tick(const shm::Tick& tick) {
  tick_ = tick;
  tick_start_ = std::chrono::steady_clock::now();
  waits_.begin(tick.now, command_topics());
  for (const auto& robot : robots_) robot->read();
  send_clock(waits_.is_waiting());
  for (const bool is_first : {true, false}) {
    for (const auto& robot : robots_) robot->show(is_first);
  }
  tend_tick(tick_start_);
}

void Gateway::tend_tick(Time now) {
  if (!tick_) return;
  if (waits_.is_waiting() && now >= tick_start_ + options_.wait_timeout) {
    const auto words = fmt::format(
        "no command on {} for the tick at t = {} s within {} s", base::join({waits_.missing().begin(), waits_.missing().end()}, ", "),
        std::chrono::duration<double>(tick_->now).count(), std::chrono::duration<double>(options_.wait_timeout).count());
    waits_.give_up();
    if (options_.on_timeout == OnTimeout::fail) {
      failed_ = base::Error{words};
      return;
    }
    base::log(base::Level::warn, "ros2-gateway", "{}", words);
    if (options_.on_timeout == OnTimeout::stop) async_requests_.post(shm::PauseRequest{}, [](const base::Result<shm::Reply>&) {});
  }
  if (waits_.is_waiting()) {
    // Readers of the clock are best effort: it may be lost.
    if (now >= clock_sent_ + resend_period) send_clock(true);
    return;
  }
  tick_.reset();
  lock_step_->finish();
}

// ---- losses ----

void Gateway::report_losses() {
  std::vector<const Node*> nodes = {node_.get()};
  for (const auto& robot : robots_) nodes.push_back(&robot->node());
  std::map<std::string, std::uint64_t> damaged;  // robots may share a node
  for (const Node* node : nodes) {
    for (const auto& writer : node->writers()) report_lost(*writer);
    damaged[node->name().full()] += node->damaged();
  }
  for (const auto& [node, count] : damaged) {
    if (const auto more = growth(node, count); more > 0)
      base::log(base::Level::warn, "ros2-gateway",
                "node {}: {} messages or requests could not be read: they are no plain CDR of their types", node, more);
  }
  if (const auto more = growth("", participant_->refused()); more > 0)
    base::log(base::Level::warn, "ros2-gateway", "{} received samples were thrown away: too many came at once", more);
}

void Gateway::report_lost(const Writer& writer) {
  if (writer.lost() == 0) return;  // several nodes have /rosout
  const auto more = growth(writer.settings().topic, writer.lost());
  if (more == 0) return;
  std::set<std::string> readers;
  for (const Guid& reader : writer.readers()) readers.insert(graph_->node_of(reader));
  base::log(base::Level::warn, "ros2-gateway",
            "{}: {} samples were not confirmed in time by every reader ({}). The longest write took {:.2f} ms",
            writer.settings().topic.substr(2), more,
            readers.empty() ? "the readers have left" : base::join({readers.begin(), readers.end()}, ", "),
            std::chrono::duration<double, std::milli>(writer.longest_write()).count());
}

// Of a count since the last report. A robot that is made again counts from 0.
std::uint64_t Gateway::growth(const std::string& what, std::uint64_t count) {
  auto& before = reported_[what];
  const std::uint64_t more = count >= before ? count - before : count;
  before = count;
  return more;
}

}  // namespace ros2
