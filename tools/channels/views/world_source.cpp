#include "channels/views/world_source.h"
#include "channels/ros_schema.h"

#include <fnmatch.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

#include "channels/views/world_source_state.h"

namespace channels {

namespace {

using namespace std::chrono_literals;

constexpr auto look_period = 200ms;  // of the wall clock: how soon ifaces that came or went are seen
constexpr std::uint32_t last_phase = 15;
constexpr auto join_limit = 5s;
constexpr int observer_nice = 5;             // above that of the process; 3 is too little
constexpr nanoseconds glance_period = 16ms;  // of the wall clock, for those who do not take part

}  // namespace

bool WorldSource::State::is_excluded(const std::string& topic) const {
  return options.wants_all && std::ranges::any_of(options.excluded, [&](const std::string& pattern) {
           return ::fnmatch(pattern.c_str(), topic.c_str(), 0) == 0;
         });
}

void WorldSource::State::open_common() {
  clock = open_channel({"/clock", "cdr", channels::schema_of<ros::Clock>(), {}});
  tf = open_channel({"/tf", "cdr", channels::schema_of<ros::TFMessage>(), {}});
  tf_static = open_channel({"/tf_static", "cdr", channels::schema_of<ros::TFMessage>(), {{"latched", "yes"}}});
  shapes = open_channel({"/sim/shapes", "cdr", channels::schema_of<ros::MarkerArray>(), {{"latched", "yes"}}});
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
      one->second.id =
          open_channel({"/sim/joints/" + models[i].name, "cdr", channels::schema_of<ros::JointState>(), {{"model", models[i].name}}});
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
  choose_turn();
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

// The simulator goes on while an observer works, and is to go on at once when both want the same processor: a thread of it that was woken
// waited until a whole picture was encoded, 6 % of the time of a run with one camera. A priority that was lowered stays so.
void WorldSource::State::give_precedence() {
  if (gives_precedence || !observes || !options.takes_part || simulation.info<shm::SimulationInfo>().lockstep == 0) return;
  gives_precedence = true;
  (void)::setpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()), ::getpriority(PRIO_PROCESS, 0) + observer_nice);
}

// Links and joints are asked for, which takes time that stands still; all else is looked at while the simulator goes on.
void WorldSource::State::choose_turn() {
  const bool asks = limbs.has_moving() && (says_tf || says_joints());
  // The next tick may have begun as an observer's already, or not: in neither case it is asked for limbs, so that the same run says the
  // same.
  is_tick_unsure = is_tick_unsure || (asks && observes && participant);
  observes = !asks;
  if (participant) participant->set_observing(observes);
}

// ---- the thread ----

// While participants are counted before time starts it stays away, so that it takes nobody's place.
bool WorldSource::State::join() {
  if (participant) return true;
  if (!simulation.read() || simulation.sample<shm::SimulationSample>().waiting_for > 0) return false;
  auto joined = shm::Participant::join(options.server_id,
                                       {.name = "channels", .phase = last_phase, .period = period, .is_tool = true, .observes = observes});
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
    take(std::nullopt);
    return say();
  }
  if (period > nanoseconds(0) && join()) {
    const auto what = participant->wait(tick, look_period);
    if (what == shm::Participant::State::dropped || what == shm::Participant::State::closed) leave();
    if (what == shm::Participant::State::closed) is_live.store(false, std::memory_order_relaxed);
    // In ticks alone, so that the same run says the same.
    if (what == shm::Participant::State::tick) take(tick.now);
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
    give_precedence();
    if (period == nanoseconds(0) || !options.takes_part || (participant && participant->is_active())) {
      shared.lock()->is_ready = true;
      changed.notify_all();
    }
  }
  leave();
  shared.lock()->is_ready = true;
  changed.notify_all();
  if (!is_live.load(std::memory_order_relaxed) && options.gone) options.gone();
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
