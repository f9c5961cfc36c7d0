#include "views/world_source.h"

#include <fnmatch.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <condition_variable>
#include <cstring>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <thread>
#include <utility>

#include "base/guarded.h"
#include "shm/lockstep.h"
#include "shm/words.h"
#include "views/model_frames.h"
#include "views/shapes.h"

namespace channels {

namespace {

using std::chrono::nanoseconds;
using namespace std::chrono_literals;

constexpr auto look_period = 200ms;  // of the wall clock: how soon ifaces that came or went are seen
constexpr std::uint32_t last_phase = 15;
constexpr double highest_rate = 1000;
constexpr auto join_limit = 5s;
constexpr nanoseconds glance_period = 16ms;  // of the wall clock, for those who do not take part

nanoseconds period_of(double rate) { return nanoseconds(std::llround(1e9 / std::clamp(rate, 1e-3, highest_rate))); }

// Moments of simulated time a period apart, at multiples of it; time may start again.
class Due {
 public:
  explicit Due(nanoseconds period) : period_(period) {}
  bool is_due(nanoseconds now) {
    if (last_ && *last_ <= now && now / period_ == *last_ / period_) return false;
    last_ = now;
    return true;
  }

 private:
  nanoseconds period_;
  std::optional<nanoseconds> last_;
};

// An iface and its channels.
struct Shown {
  shm::Iface iface;
  std::unique_ptr<IfaceView> view;
  std::vector<ChannelId> ids;
  std::vector<bool> wanted;
  Due due;
  std::uint64_t last = 0;
  // What was taken and is not told yet: its sample is in the iface's own buffer, a frame is held.
  std::optional<shm::Stamp> taken{};
  std::optional<shm::HeldFrame> frame{};

  bool is_wanted() const { return std::ranges::find(wanted, true) != wanted.end(); }
};

// The true pose of a model.
struct Truth {
  shm::Iface iface;
  std::string model;
  bool is_taken = false;
};

bool is_gone(const shm::Iface& iface) { return shm::load(iface.segment().header().state) != RTMSIM_STATE_LIVE; }

// The joints of a model.
struct Joints {
  ChannelId id = 0;
  bool is_wanted = false;
  std::size_t model = 0;  // its place in Limbs::models
};

}  // namespace

struct WorldSource::State {
  State(Exchange& to, const WorldSourceOptions& chosen, shm::Iface opened)
      : exchange(to), options(chosen), simulation(std::move(opened)), limbs(chosen.server_id), pose_due(period_of(chosen.pose_rate)) {}

  // ---- shared ----
  struct Shared {
    std::set<ChannelId> wanted;
    std::set<ChannelId> repeated;
    bool is_changed = false;
    bool is_ending = false;
    bool is_ready = false;
    shm::Participant* participant = nullptr;  // of the thread, while it has one
  };
  base::Guarded<Shared, base::Rank::registry> shared;
  std::condition_variable changed;
  std::atomic<bool> is_live{true};  // relaxed: says nothing but itself

  // ---- of the thread ----
  Exchange& exchange;
  const WorldSourceOptions options;
  shm::Iface simulation;
  std::map<std::pair<shm::IfaceType, std::string>, Shown> shown;
  std::vector<Shown*> chosen;                         // of these, those that are wanted: looked at in each tick
  bool is_one_gone = false;                           // of the chosen, or a truth
  std::chrono::steady_clock::time_point next_look{};  // at all of them
  std::map<std::string, Truth> truths;                // by name of the iface
  std::map<std::string, Joints> joints;               // by model
  Limbs limbs;
  std::pair<std::uint32_t, std::uint32_t> listed{};
  ChannelId clock = 0, tf = 0, tf_static = 0, shapes = 0;
  bool says_clock = false, says_tf = false;
  Due pose_due, second_due{1s};
  std::uint64_t clock_seen = 0;
  std::optional<shm::Stamp> poses_taken;  // of poses that are taken and not told yet
  bool are_limbs_taken = false;
  std::optional<shm::Participant> participant;
  nanoseconds period{0};
  std::thread thread;

  bool is_excluded(const std::string& topic) const {
    return options.wants_all && std::ranges::any_of(options.excluded, [&](const std::string& pattern) {
             return ::fnmatch(pattern.c_str(), topic.c_str(), 0) == 0;
           });
  }
  // 0: there is none, and nobody wants it.
  ChannelId open_channel(Channel channel) {
    if (is_excluded(channel.topic)) return 0;
    const auto id = exchange.open(std::move(channel));
    if (!id) return 0;
    if (options.wants_all) {
      auto data = shared.lock();
      data->wanted.insert(*id);
      data->repeated.insert(*id);
      data->is_changed = true;
    }
    return *id;
  }

  void close_channel(ChannelId id) {
    if (id != 0) exchange.close(id);
  }

  void open_common();
  void look();
  void show(const shm::SegmentName& name);
  bool drop_gone();
  void show_joints();
  void take_wishes();
  void subscribe();
  void choose_period();
  bool says_joints() const {
    return std::ranges::any_of(joints, [](const auto& one) { return one.second.is_wanted; });
  }
  void say_static();
  void say_shapes();
  void take(Shown& one);
  void take_poses();
  void take();
  void say_poses(const shm::Stamp& now);
  void say_limbs(const shm::Stamp& now, const std::map<std::string, shm::Pose>& places, ros::TFMessage& message);
  void say_samples();
  void say();
  bool is_ending() const { return shared.lock()->is_ending; }
  bool join();
  void leave();
  void wait();
  void run();
};

void WorldSource::State::open_common() {
  clock = open_channel({"/clock", "cdr", ros::schema<ros::Clock>(), {}});
  tf = open_channel({"/tf", "cdr", ros::schema<ros::TFMessage>(), {}});
  tf_static = open_channel({"/tf_static", "cdr", ros::schema<ros::TFMessage>(), {{"latched", "yes"}}});
  shapes = open_channel({"/sim/shapes", "cdr", ros::schema<ros::MarkerArray>(), {{"latched", "yes"}}});
}

// ---- what there is ----

void WorldSource::State::show(const shm::SegmentName& name) {
  if (name.type == shm::IfaceType::truth ? truths.contains(name.iface) : shown.contains({name.type, name.iface})) return;
  auto iface = shm::Iface::open(options.server_id, name.type, name.iface);
  if (!iface) return;  // it has gone again
  if (name.type == shm::IfaceType::truth) {
    const std::string model = text_of(iface->info<shm::TruthInfo>().model);
    truths.emplace(name.iface, Truth{std::move(*iface), model});
    return;
  }
  auto view = view_of(*iface, options.pictures);
  if (!view) return;
  Shown one{std::move(*iface), std::move(view), {}, {}, Due(period_of(options.pose_rate))};
  for (const Channel& channel : one.view->channels) one.ids.push_back(open_channel(channel));
  one.wanted.resize(one.ids.size());
  shown.emplace(std::pair(name.type, name.iface), std::move(one));
}

// True when something had.
bool WorldSource::State::drop_gone() {
  std::size_t count = std::erase_if(truths, [&](const auto& entry) { return is_gone(entry.second.iface); });
  count += std::erase_if(shown, [&](const auto& entry) {
    if (!is_gone(entry.second.iface)) return false;
    for (const ChannelId id : entry.second.ids) close_channel(id);
    std::erase(chosen, &entry.second);
    return true;
  });
  return count > 0;
}

void WorldSource::State::show_joints() {
  const auto& models = limbs.models();
  std::erase_if(joints, [&](const auto& entry) {
    const bool is_there = std::ranges::any_of(models, [&](const ModelFrames& model) { return model.name == entry.first; });
    if (!is_there) close_channel(entry.second.id);
    return !is_there;
  });
  for (std::size_t i = 0; i < models.size(); ++i) {
    if (models[i].is_rigid || models[i].axes.empty()) continue;
    const auto [one, is_new] = joints.try_emplace(models[i].name);
    one->second.model = i;
    if (is_new)
      one->second.id = open_channel({"/sim/joints/" + models[i].name, "cdr", ros::schema<ros::JointState>(), {{"model", models[i].name}}});
  }
}

// Opens what has come and closes what has gone. Asks the simulator: not within a tick.
void WorldSource::State::look() {
  if (!simulation.read()) return;
  const auto& sample = simulation.sample<shm::SimulationSample>();
  const std::pair now{sample.ifaces, sample.models};
  if (const auto moment = std::chrono::steady_clock::now(); is_one_gone || moment >= next_look) {
    next_look = moment + look_period;
    is_one_gone = drop_gone();
  }
  if (!std::exchange(is_one_gone, false) && now == listed && now != std::pair{0U, 0U}) return;
  listed = now;
  for (const auto& found : shm::find_segments(options.server_id)) {
    if (found.is_readable && found.is_alive && found.name.type != shm::IfaceType::simulation) show(found.name);
  }
  if (limbs.learn()) show_joints();  // a simulator that does not answer is going
  auto data = shared.lock();
  data->is_changed = true;
  data->repeated.insert({tf_static, shapes});
}

// ---- what is wanted ----

void WorldSource::State::take_wishes() {
  std::set<ChannelId> wanted;
  bool is_static_due = false, are_shapes_due = false;
  {
    auto data = shared.lock();
    if (!data->is_changed) return;
    data->is_changed = false;
    wanted = data->wanted;
    const auto repeated = std::exchange(data->repeated, {});
    is_static_due = repeated.contains(tf_static) && wanted.contains(tf_static);
    are_shapes_due = repeated.contains(shapes) && wanted.contains(shapes);
  }
  for (auto& [key, one] : shown) {
    for (std::size_t i = 0; i < one.ids.size(); ++i) one.wanted[i] = wanted.contains(one.ids[i]);
  }
  chosen.clear();
  for (auto& [key, one] : shown) {
    if (one.is_wanted()) chosen.push_back(&one);
  }
  for (auto& [model, one] : joints) one.is_wanted = wanted.contains(one.id);
  says_clock = wanted.contains(clock);
  says_tf = wanted.contains(tf);
  subscribe();
  choose_period();
  if (is_static_due) say_static();
  if (are_shapes_due) say_shapes();
}

void WorldSource::State::subscribe() {
  const auto set = [](shm::Iface& iface, bool is_wanted) {
    if (is_wanted == iface.is_subscribed()) return;
    if (is_wanted) {
      (void)iface.subscribe();  // when it fails the iface is going, or all its places are taken: it says nothing then
    } else {
      iface.unsubscribe();
    }
  };
  for (auto& [key, one] : shown) set(one.iface, one.is_wanted());
  for (auto& [name, truth] : truths) set(truth.iface, says_tf);
}

void WorldSource::State::choose_period() {
  double rate = says_tf || says_clock || says_joints() ? options.pose_rate : 0;
  if (options.each_second) rate = std::max(rate, 1.0);
  for (const Shown* one : chosen) rate = std::max(rate, one->view->rate > 0 ? one->view->rate : options.pose_rate);
  const auto chosen = rate > 0 ? period_of(rate) : nanoseconds(0);
  if (chosen == period) return;
  period = chosen;
  if (period == nanoseconds(0)) leave();
  if (participant) participant->set_period(period);
}

// ---- what is said ----

void WorldSource::State::say_static() {
  ros::TFMessage message;
  for (const auto& model : limbs.models()) {
    if (model.is_static) message.transforms.push_back(transform_of({}, world_frame, model.name, model.pose));
    if (!model.is_rigid) continue;
    for (const auto& link : model.links) message.transforms.push_back(transform_of({}, model.name, link.frame, link.pose));
  }
  for (const auto& [key, one] : shown)
    message.transforms.insert(message.transforms.end(), one.view->frames.begin(), one.view->frames.end());
  const nanoseconds now(simulation.read() ? simulation.sample<shm::SimulationSample>().stamp.sim_time_ns : 0);
  for (auto& transform : message.transforms) transform.header.stamp = ros::to_time(now);
  exchange.put(tf_static, now, ros::encode(message));
}

// All of them, in the place of those before.
void WorldSource::State::say_shapes() {
  auto found = shapes_of(options.server_id);
  if (!found) return;  // a simulator of another version, or one that is going
  ros::MarkerArray message;
  message.markers.push_back({.header = {{}, world_frame}, .action = ros::Marker::remove_all});
  std::ranges::move(*found, std::back_inserter(message.markers));
  const nanoseconds now(simulation.read() ? simulation.sample<shm::SimulationSample>().stamp.sim_time_ns : 0);
  for (auto& marker : message.markers) marker.header.stamp = ros::to_time(now);
  exchange.put(shapes, now, ros::encode(message));
}

// A tick lasts until what there is has been taken: copies of samples, and frames that nobody writes over. Messages are made of it when the
// simulator goes on already.
void WorldSource::State::take(Shown& one) {
  is_one_gone = is_one_gone || is_gone(one.iface);
  if (one.iface.sequence() == one.last) return;
  shm::Stamp stamp{};
  if (shm::has_frames(one.iface.type())) {
    auto frame = one.iface.hold();
    if (!frame || frame->sequence() == one.last) return;
    stamp = frame->head().stamp;
    one.frame = std::move(frame);
  } else {
    if (!one.iface.read()) return;
    std::memcpy(&stamp, one.iface.sample_data().data(), sizeof stamp);
    if (one.view->rate == 0 && !one.due.is_due(nanoseconds(stamp.sim_time_ns))) return;
  }
  one.last = stamp.sequence;
  one.taken = stamp;
}

void WorldSource::State::take_poses() {
  for (auto& [name, truth] : truths) {
    const bool has_gone = says_tf && is_gone(truth.iface);
    is_one_gone = is_one_gone || has_gone;
    truth.is_taken = says_tf && !has_gone && truth.iface.read();
  }
  are_limbs_taken = limbs.has_moving() && (says_tf || says_joints()) && limbs.read();
  if (!are_limbs_taken && limbs.has_moving() && (says_tf || says_joints())) listed = {};  // models have come or gone
}

void WorldSource::State::take() {
  for (Shown* one : chosen) take(*one);
  if (!simulation.read()) return;
  const auto& sample = simulation.sample<shm::SimulationSample>();
  if (std::exchange(clock_seen, sample.stamp.sequence) == sample.stamp.sequence) return;
  const nanoseconds now(sample.stamp.sim_time_ns);
  if (pose_due.is_due(now) || sample.paused != 0) {
    poses_taken = sample.stamp;
    take_poses();
  }
  if (options.each_second && second_due.is_due(now)) options.each_second(now);
}

void WorldSource::State::say_limbs(const shm::Stamp& now, const std::map<std::string, shm::Pose>& places, ros::TFMessage& message) {
  if (!are_limbs_taken) return;
  limbs.add_transforms(now, places, message.transforms);
  for (const auto& [model, one] : joints) {
    if (one.is_wanted) exchange.put(one.id, nanoseconds(now.sim_time_ns), ros::encode(limbs.joints_of(one.model, now)));
  }
}

void WorldSource::State::say_poses(const shm::Stamp& now) {
  const nanoseconds time(now.sim_time_ns);
  if (says_clock) exchange.put(clock, time, ros::encode(ros::Clock{ros::to_time(time)}));
  ros::TFMessage message;
  std::map<std::string, shm::Pose> places;
  for (auto& [name, truth] : truths) {
    if (!truth.is_taken) continue;
    const auto& sample = truth.iface.sample<shm::TruthSample>();
    if (sample.stamp.valid == 0) continue;
    message.transforms.push_back(transform_of(sample.stamp, world_frame, truth.model, sample.pose));
    if (are_limbs_taken) places.emplace(truth.model, sample.pose);
  }
  say_limbs(now, places, message);
  if (says_tf && !message.transforms.empty()) exchange.put(tf, time, ros::encode(message));
}

void WorldSource::State::say_samples() {
  std::vector<Said> said;
  for (Shown* each : chosen) {
    Shown& one = *each;
    const auto stamp = std::exchange(one.taken, std::nullopt);
    if (!stamp) continue;
    said.clear();
    one.view->tell(one.iface, one.frame ? &*one.frame : nullptr, one.wanted, said);
    one.frame.reset();
    for (Said& what : said) {
      if (one.wanted[what.channel]) exchange.put(one.ids[what.channel], nanoseconds(stamp->sim_time_ns), std::move(what.octets));
    }
  }
}

void WorldSource::State::say() {
  say_samples();
  if (const auto now = std::exchange(poses_taken, std::nullopt)) say_poses(*now);
}

// ---- the thread ----

// While participants are counted before time starts it stays away, so that it takes nobody's place.
bool WorldSource::State::join() {
  if (participant) return true;
  if (!simulation.read() || simulation.sample<shm::SimulationSample>().waiting_for > 0) return false;
  auto joined = shm::Participant::join(options.server_id, {.name = "channels", .phase = last_phase, .period = period});
  if (!joined) return false;
  participant.emplace(std::move(*joined));
  shared.lock()->participant = &*participant;
  return true;
}

void WorldSource::State::leave() {
  shared.lock()->participant = nullptr;
  participant.reset();
}

// For the next tick, or until something has changed.
void WorldSource::State::wait() {
  shm::Tick tick;
  if (!options.takes_part) {
    {
      auto data = shared.lock();
      data.wait_for(changed, period > nanoseconds(0) ? glance_period : look_period, [&] { return data->is_changed || data->is_ending; });
    }
    take();
    return say();
  }
  if (period > nanoseconds(0) && join()) {
    const auto what = participant->wait(tick, look_period);
    if (what == shm::Participant::State::dropped || what == shm::Participant::State::closed) leave();
    if (what == shm::Participant::State::closed) is_live.store(false, std::memory_order_relaxed);
    // In ticks alone, so that the same run says the same.
    if (what == shm::Participant::State::tick) take();
    if (participant) participant->finish();
    say();
  } else {
    auto data = shared.lock();
    data.wait_for(changed, look_period, [&] { return data->is_changed || data->is_ending; });
  }
}

void WorldSource::State::run() {
  while (is_live.load(std::memory_order_relaxed) && !is_ending()) {
    wait();
    if (simulation.status() != shm::Status::live) is_live.store(false, std::memory_order_relaxed);
    look();
    take_wishes();
    if (period == nanoseconds(0) || !options.takes_part || (participant && participant->is_active())) {
      shared.lock()->is_ready = true;
      changed.notify_all();
    }
  }
  leave();
  shared.lock()->is_ready = true;
  changed.notify_all();
}

WorldSource::WorldSource(std::unique_ptr<State> state) : state_(std::move(state)) {}

base::Result<std::unique_ptr<WorldSource>> WorldSource::open(Exchange& exchange, const WorldSourceOptions& options) {
  auto simulation = shm::Iface::open(options.server_id, shm::IfaceType::simulation, "world");
  if (!simulation) return simulation.error();
  auto state = std::make_unique<State>(exchange, options, std::move(*simulation));
  state->open_common();
  state->look();
  state->take_wishes();
  State& its = *state;
  state->thread = std::thread([&its] { its.run(); });
  auto source = std::make_unique<WorldSource>(std::move(state));
  {
    auto data = its.shared.lock();
    data.wait_for(its.changed, join_limit, [&] { return data->is_ready; });
  }
  return source;
}

WorldSource::~WorldSource() {
  {
    auto data = state_->shared.lock();
    data->is_ending = true;
    if (data->participant != nullptr) data->participant->interrupt();
  }
  state_->changed.notify_all();
  state_->thread.join();
}

void WorldSource::want(ChannelId channel, bool is_wanted) {
  {
    auto data = state_->shared.lock();
    if (is_wanted) {
      data->wanted.insert(channel);
      data->repeated.insert(channel);
    } else {
      data->wanted.erase(channel);
    }
    data->is_changed = true;
    if (data->participant != nullptr) data->participant->interrupt();
  }
  state_->changed.notify_all();
}

bool WorldSource::is_live() const { return state_->is_live.load(std::memory_order_relaxed); }

}  // namespace channels
