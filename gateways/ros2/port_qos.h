// The QoS of a port on a topic, from the properties of its connection. NAME is the transport: ros2, fast-rtps, cyclone-dds. Of these
// spellings the first that has a value counts:
//
//   NAME.writer_qos.* and NAME.reader_qos.*             as OpenRTM's ROS2Transport of Python
//   NAME.publisher.qos.* and NAME.subscriber.qos.*      as OpenRTM's FastRTPSTransport of C++
//   NAME.reliability, NAME.durability, NAME.depth       for both directions: reliable, best_effort; volatile, transient_local; a number
//
// Without a reliability a writer is reliable, and a reader receives from all writers.
//
// Pure, except for warnings; any thread.
#pragma once

#include <coil/Properties.h>

#include <string>

#include "base/result.h"
#include "dds/participant.h"

namespace ros2 {

struct PortTopic {
  EndpointSettings endpoint{};
  bool takes_all = false;  // a reader of reliable and of best effort writers
};

// Fails at a key below `name` that means nothing, with the key that was most likely meant. Warns of a policy that OpenRTM has and this
// transport does not. A mapping of an author's own may read keys that are not known here.
base::Result<void> check_keys(const coil::Properties& connection, const std::string& name, bool is_own_mapping);

base::Result<void> read_qos(const coil::Properties& connection, const std::string& name, bool is_writer, PortTopic& topic);

}  // namespace ros2
