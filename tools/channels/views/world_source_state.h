// State of a WorldSource. It belongs to its thread, except `shared`.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "base/guarded.h"
#include "channels/views/model_frames.h"
#include "channels/views/world_source.h"
#include "shm/lockstep.h"
#include "shm/words.h"

namespace channels {

using std::chrono::nanoseconds;

// [Hz]
inline nanoseconds period_of(double rate) {
  constexpr double highest = 1000;
  return nanoseconds(std::llround(1e9 / std::clamp(rate, 1e-3, highest)));
}

// Moments of simulated time a period apart, at multiples of it; time may start again.
class Due {
 public:
  explicit Due(nanoseconds period) : period_(period) {}
  bool is_due(nanoseconds now) {
    if (last_ && *last_ <= now && now / period_ == *last_ / period_) return false;
    last_ = now;
    return true;
  }
  void restart() { last_.reset(); }

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

inline bool is_gone(const shm::Iface& iface) { return shm::load(iface.segment().header().state) != RTMSIM_STATE_LIVE; }

// The joints of a model.
struct Joints {
  ChannelId id = 0;
  bool is_wanted = false;
  std::size_t model = 0;  // its place in Limbs::models
};

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
  base::Guarded<Shared, base::Rank::tasks> shared;
  std::condition_variable changed;
  std::atomic<bool> is_live{true};  // relaxed: says nothing but itself

  // ---- of the thread ----
  Exchange& exchange;
  Batch batch;
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
  Due pose_due, second_due{std::chrono::seconds(1)};
  std::uint64_t clock_seen = 0;
  std::optional<nanoseconds> poses_taken;  // when: of poses that are taken and not told yet
  bool are_limbs_taken = false;
  std::optional<shm::Participant> participant;
  nanoseconds period{0};
  bool observes = false;  // in the ticks from the next but one on
  bool is_tick_unsure = false;
  bool gives_precedence = false;
  std::thread thread;

  bool is_excluded(const std::string& topic) const;
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
  void choose_turn();
  void give_precedence();
  bool says_joints() const {
    return std::ranges::any_of(joints, [](const auto& one) { return one.second.is_wanted; });
  }
  void say_static();
  void say_shapes();
  void take(Shown& one);
  void take_poses(bool with_limbs);
  void take(std::optional<nanoseconds> tick);
  void say_poses(nanoseconds now);
  void say_limbs(nanoseconds now, const std::map<std::string, shm::Pose>& places, ros::TFMessage& message);
  void say_samples();
  void say();
  bool is_ending() const { return shared.lock()->is_ending; }
  bool join();
  void leave();
  void wait();
  void run();
};

}  // namespace channels
