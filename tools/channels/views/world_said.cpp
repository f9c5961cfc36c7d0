// What the simulator shows, said: samples and poses are taken within a tick, and messages made of them when it is over.
#include <cstring>
#include <iterator>
#include <utility>

#include "channels/views/shapes.h"
#include "channels/views/world_source_state.h"

namespace channels {

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

void WorldSource::State::take_poses(bool with_limbs) {
  if (says_tf) {
    for (auto& [name, truth] : truths) {
      const bool has_gone = is_gone(truth.iface);
      is_one_gone = is_one_gone || has_gone;
      truth.is_taken = !has_gone && truth.iface.read();
    }
  }
  const bool asks = with_limbs && limbs.has_moving() && (says_tf || says_joints());
  are_limbs_taken = asks && limbs.read();
  if (asks && !are_limbs_taken) listed = {};  // models have come or gone
}

// Of one tick, or of now without one.
void WorldSource::State::take(std::optional<nanoseconds> tick) {
  const bool with_limbs = !std::exchange(is_tick_unsure, false);
  // What another processor has written comes from its cache, one line in the time of a hundred others: they are asked for ahead.
  constexpr std::size_t brought = 4, expected = 8;
  const auto ahead = [this](std::size_t i) { return i < chosen.size() ? &chosen[i]->iface : nullptr; };
  for (std::size_t i = 0; i < expected; ++i) {
    if (const auto* iface = ahead(i)) iface->expect();
  }
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    if (const auto* iface = ahead(i + expected)) iface->expect();
    if (const auto* iface = ahead(i + brought)) iface->bring();
    take(*chosen[i]);
  }
  if (!tick) {
    if (!simulation.read()) return;
    const auto& sample = simulation.sample<shm::SimulationSample>();
    if (std::exchange(clock_seen, sample.stamp.sequence) == sample.stamp.sequence) return;
    // While time stands still it is said how things are now, too.
    if (sample.paused != 0) pose_due.restart();
    tick = nanoseconds(sample.stamp.sim_time_ns);
  }
  if (pose_due.is_due(*tick)) {
    poses_taken = tick;
    take_poses(with_limbs);
  }
  if (options.each_second && second_due.is_due(*tick)) options.each_second(*tick);
}

void WorldSource::State::say_limbs(nanoseconds now, const std::map<std::string, shm::Pose>& places, ros::TFMessage& message) {
  if (!are_limbs_taken) return;
  shm::Stamp stamp{};
  stamp.sim_time_ns = now.count();
  limbs.add_transforms(stamp, places, message.transforms);
  for (const auto& [model, one] : joints) {
    if (one.is_wanted) exchange.put(one.id, now, ros::encode(limbs.joints_of(one.model, stamp)));
  }
}

void WorldSource::State::say_poses(nanoseconds time) {
  if (says_clock) exchange.put(clock, time, ros::encode(ros::Clock{ros::to_time(time)}));
  if (!says_tf && !are_limbs_taken) return;
  ros::TFMessage message;
  std::map<std::string, shm::Pose> places;
  for (auto& [name, truth] : truths) {
    if (!says_tf || !truth.is_taken) continue;
    const auto& sample = truth.iface.sample<shm::TruthSample>();
    if (sample.stamp.valid == 0) continue;
    message.transforms.push_back(transform_of(sample.stamp, world_frame, truth.model, sample.pose));
    if (are_limbs_taken) places.emplace(truth.model, sample.pose);
  }
  say_limbs(time, places, message);
  if (says_tf && !message.transforms.empty()) exchange.put(tf, time, ros::encode(message));
}

void WorldSource::State::say_samples() {
  for (Shown* each : chosen) {
    Shown& one = *each;
    const auto stamp = std::exchange(one.taken, std::nullopt);
    if (!stamp) continue;
    Said said(batch, one.ids, one.wanted, nanoseconds(stamp->sim_time_ns));
    one.view->tell(one.iface, one.frame ? &*one.frame : nullptr, said);
    one.frame.reset();
  }
  exchange.put(batch);
}

void WorldSource::State::say() {
  say_samples();
  if (const auto now = std::exchange(poses_taken, std::nullopt)) say_poses(*now);
}

}  // namespace channels
