// Parts of the views of ifaces. Values; any thread.
#pragma once

#include <optional>
#include <string>

#include "channels/ros_schema.h"
#include "channels/views/iface_view.h"
#include "ros/from_iface.h"

namespace channels {

// Views of devices without scans, images or motors; nothing for other types.
std::optional<IfaceView> plain_view(const shm::Iface& iface);

template <class Message>
Channel channel(const shm::Iface& iface, const std::string& suffix = "") {
  return {topic_of(iface.type(), iface.name()) + suffix,
          "cdr",
          channels::schema_of<Message>(),
          {{"iface", iface.name()}, {"iface_type", std::string(shm::to_text(iface.type()))}}};
}

// A sensor on its model; its frame has the name of the iface.
template <class Info>
void place(IfaceView& view, const shm::Iface& iface) {
  const Info& info = iface.info<Info>();
  view.frames.push_back(transform_of({}, text_of(info.model), iface.name(), info.pose));
  view.rate = info.rate;
}

// A view with one channel: `say` makes the message of the latest sample.
template <class Message, class Info, class Say>
IfaceView simple_view(const shm::Iface& iface, Say say) {
  IfaceView view;
  view.channels = {channel<Message>(iface)};
  place<Info>(view, iface);
  view.tell = [say](shm::Iface& from, const shm::HeldFrame*, Said& said) {
    if (from.sample<shm::Stamp>().valid != 0) said.add(0, say(from, from.name()));
  };
  return view;
}

}  // namespace channels
