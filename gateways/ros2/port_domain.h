// The node of ROS 2 that the ports of this process share, with its participant of DDS. Created with the first topic; it exists until the
// process ends. Any thread.
//
// Its thread receives the samples of DDS. It calls the receivers after it has released the participant, so a receiver may write and may end
// its own topic. Errors: DDS is out of resources, or cannot use the network.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "base/result.h"
#include "dds/participant.h"
#include "graph.h"

namespace ros2 {

struct PortDomainSettings {
  ParticipantSettings dds;
  std::optional<Family> family;
  NodeName node;
};

class Publication {
 public:
  virtual ~Publication() = default;
  // False if there was no memory. Never waits for a subscriber.
  virtual bool put(std::span<const std::uint8_t> bytes) = 0;
};

class Subscription {
 public:
  virtual ~Subscription() = default;  // waits for a running call of the receiver, except within it
};

using OnBytes = std::function<void(std::span<const std::uint8_t>)>;

// The settings count for the first topic of the process only.
base::Result<std::unique_ptr<Publication>> publish_port(const PortDomainSettings& settings, const EndpointSettings& topic);
// `takes_all`: the samples of all writers, each once, for a topic whose settings are reliable.
base::Result<std::unique_ptr<Subscription>> subscribe_port(const PortDomainSettings& settings, const EndpointSettings& topic,
                                                           bool takes_all, OnBytes receiver);

}  // namespace ros2
