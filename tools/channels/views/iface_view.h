// Converts an iface of the simulator to channels of ROS 2 messages. No thread of its own; one thread at a
// time.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/result.h"
#include "channels/channel.h"
#include "channels/exchange.h"
#include "ros/from_iface.h"
#include "shm/client.h"

namespace channels {

enum class Pictures { jpeg, raw };

// Takes what one sample of an iface says, on the channels that are wanted.
class Said {
 public:
  Said(Batch& batch, const std::vector<ChannelId>& ids, const std::vector<bool>& wanted, Time time)
      : batch_(batch), ids_(ids), wanted_(wanted), time_(time) {}

  // `channel`: place in IfaceView::channels
  bool is_wanted(std::size_t channel) const { return channel < wanted_.size() && wanted_[channel]; }
  template <ros::Message T>
  void add(std::size_t channel, const T& message) {
    if (is_wanted(channel)) ros::encode(message, batch_.add(ids_[channel], time_, ros::encoded_size(message)));
  }

 private:
  Batch& batch_;
  const std::vector<ChannelId>& ids_;
  const std::vector<bool>& wanted_;
  const Time time_;
};

struct IfaceView {
  std::vector<Channel> channels;
  // Where the sensor stands on its model, and frames of its own: known before there is a sample.
  std::vector<ros::TransformStamped> frames;
  double rate = 0;  // [Hz] of samples; 0: every step, so that more come than anybody looks at
  // Adds what the latest sample or frame says. Nothing while it says nothing true.
  std::function<void(shm::Iface&, const shm::HeldFrame*, Said&)> tell;
};

// "pioneer2dx::laser" -> "/sim/laser/pioneer2dx/laser"
std::string topic_of(shm::IfaceType type, const std::string& name);

// Nothing for types that are no channel of their own: the clock and the truth of models.
std::unique_ptr<IfaceView> view_of(const shm::Iface& iface, Pictures pictures);

// ---- what they are made with ----

inline constexpr const char* world_frame = "world";

using ros::encoding_of;
using ros::header_of;
using ros::inverse;
using ros::pose_of;
using ros::product;
using ros::text_of;
using ros::transform_of;

}  // namespace channels
