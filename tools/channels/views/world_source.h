// The state of a simulator as channels of ROS 2 messages that any viewer knows: the poses of models as tf, the clock, and each sensor and
// drive. A channel is open at the exchange while its iface exists. A sensor works, and samples come, while its channel is wanted.
//
//   /clock                                      rosgraph_msgs/msg/Clock
//   /tf, /tf_static                             tf2_msgs/msg/TFMessage: models in `world`, links and sensors on their models
//   /sim/shapes                                 visualization_msgs/msg/MarkerArray: what the links look like
//   /sim/joints/MODEL                           sensor_msgs/msg/JointState
//   /sim/TYPE/NAME, "::" in names as "/"        LaserScan, Odometry, Imu, ... (docs/recording-format.md has the table)
//
// With takes_part it is a participant of the last phase: in lock step nothing is lost and time waits until all sinks have room, else it is
// woken when something is due and time goes on. It has a thread of its own; any thread may call it.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/result.h"
#include "channels/exchange.h"
#include "channels/views/iface_view.h"

namespace channels {

struct WorldSourceOptions {
  std::uint32_t server_id = 0;
  double pose_rate = 50;  // [Hz, simulated] of tf, the clock and drives; 0 < rate <= 1000
  Pictures pictures = Pictures::jpeg;
  bool takes_part = true;             // in the lock step; else it looks sixty times a second of the wall clock, and the newest samples win
  bool wants_all = false;             // else nothing until want()
  std::vector<std::string> excluded;  // with wants_all: topics that fit one of these patterns have no channel
  std::function<void(Time)> each_second{};  // of simulated time; called on the source's thread, of one that takes part within its tick
  std::function<void()> gone{};             // the simulator has ended; called on the source's thread, once
};

class WorldSource {
 public:
  // All channels that there are at this moment are open, and with wants_all the source takes part in the lock step, when it returns. Fails
  // when there is no simulator of that id.
  static base::Result<std::unique_ptr<WorldSource>> open(Exchange& exchange, const WorldSourceOptions& options);
  ~WorldSource();

  // What is the same for long (latched channels) is said anew with each call for it.
  void want(ChannelId channel, bool is_wanted);
  // False when the simulator has gone; the source says nothing more then.
  bool is_live() const;

  struct State;
  explicit WorldSource(std::unique_ptr<State> state);

 private:
  std::unique_ptr<State> state_;
};

}  // namespace channels
