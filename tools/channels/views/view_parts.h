// Parts of the views of ifaces. Values; any thread.
#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <string>

#include "channels/views/iface_view.h"

namespace channels {

// Views of devices without scans, images or motors; nothing for other types.
std::optional<IfaceView> plain_view(const shm::Iface& iface);

template <class Message>
Channel channel(const shm::Iface& iface, const std::string& suffix = "") {
  return {topic_of(iface.type(), iface.name()) + suffix,
          "cdr",
          ros::schema<Message>(),
          {{"iface", iface.name()}, {"iface_type", std::string(shm::to_text(iface.type()))}}};
}

inline ros::Time time_of(const shm::Stamp& stamp) { return ros::to_time(std::chrono::nanoseconds(stamp.sim_time_ns)); }

inline ros::Vector3 vector_of(const double* v) { return {v[0], v[1], v[2]}; }

inline std::array<double, 9> diagonal(double a, double b, double c) { return {a, 0, 0, 0, b, 0, 0, 0, c}; }

inline shm::Pose pose_at(double x, double y, double z, double yaw) { return {x, y, z, std::cos(yaw / 2), 0, 0, std::sin(yaw / 2)}; }

// A sensor on its model; its frame has the name of the iface.
template <class Info>
void place(IfaceView& view, const shm::Iface& iface) {
  const Info& info = iface.info<Info>();
  view.frames.push_back(transform_of({}, text_of(info.model), iface.name(), info.pose));
  view.rate = info.rate;
}

// A view with one channel: `say` makes the message of the latest sample.
template <class Message, class Info, class Sample, class Say>
IfaceView simple_view(const shm::Iface& iface, Say say) {
  IfaceView view;
  view.channels = {channel<Message>(iface)};
  place<Info>(view, iface);
  view.tell = [say](shm::Iface& from, const shm::HeldFrame*, Said& said) {
    if (from.sample<Sample>().stamp.valid != 0) said.add(0, say(from));
  };
  return view;
}

}  // namespace channels
