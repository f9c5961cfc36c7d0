// A participant of DDS that writes and reads encoded messages. The only part that includes Fast DDS. One thread at a time: Fast DDS's own
// threads put received samples into a queue, and deliver() passes them on.
//
// Writers keep the last samples. They never wait: a sample that is replaced before every reliable reader has confirmed it is counted. A
// sample without a present or future reader is not encoded. Errors name the object that could not be created.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace ros2 {

// The GUID of an entity: 12 bytes of its participant, 4 of itself; in network order.
using Guid = std::array<std::uint8_t, 16>;

enum class Network {
  host,      // participants of this computer find it; it sends nothing to others
  lan,       // multicast on all interfaces, for one hop
  loopback,  // only those that use 127.0.0.1
};

// By its name here; nothing for other names.
inline std::optional<Network> network_of(std::string_view name) {
  if (name == "host") return Network::host;
  if (name == "lan") return Network::lan;
  if (name == "loopback") return Network::loopback;
  return std::nullopt;
}

struct ParticipantSettings {
  std::uint32_t domain = 0;  // 0..232
  Network network = Network::host;
  std::string user_data = "enclave=/;";
  std::string log_name = "ros2-gateway";    // of the lines that are logged
  std::string distro_setting = "--distro";  // where a user chooses the family of ROS 2
  std::function<void()> on_news{};          // called by threads of DDS when deliver() has something to do; instead of the descriptor
};

struct EndpointSettings {
  std::string topic{}, type{};  // as on the wire: "rt/scan", "sensor_msgs::msg::dds_::LaserScan_"
  std::string user_data{};
  bool is_transient = false;  // readers that come late receive the last samples
  std::size_t depth = 10;     // samples that are kept; readers: all, as deliver() takes them
  bool is_large = false;      // sent by a thread of its own
  bool is_local_ignored = false;
  bool is_reliable = true;  // a reader that is not takes the samples of all writers
};

// An endpoint of another participant.
struct Peer {
  Guid guid{};
  bool is_writer = false;
  bool is_gone = false;
  std::string topic, type, user_data;
  bool is_reliable = false, is_transient = false;
  std::string unmatched_policy{};  // a QoS policy that no endpoint of this process matches, such as "a deadline"; empty: none
};

// What relates a reply of a service to its request, in the form of rmw_fastrtps.
struct SampleIdentity {
  Guid writer{};
  std::int64_t sequence = 0;
  bool operator==(const SampleIdentity&) const = default;
};

struct Received {
  SampleIdentity identity;
  std::optional<SampleIdentity> related;
  std::vector<std::uint8_t> bytes;  // with the head of four bytes
};

class Writer {
 public:
  virtual ~Writer() = default;
  virtual const Guid& guid() const = 0;
  virtual const EndpointSettings& settings() const = 0;
  // Those that are matched, as of the last deliver().
  virtual const std::vector<Guid>& readers() const = 0;
  // `fill` writes the message into room of `size` bytes. False when there is no memory.
  virtual bool write(std::size_t size, const std::function<void(std::span<char>)>& fill,
                     const std::optional<SampleIdentity>& related = std::nullopt) = 0;
  // Samples that a reader may have missed.
  virtual std::uint64_t lost() const = 0;
  // Of all calls of write().
  virtual std::chrono::nanoseconds longest_write() const = 0;
  // Replies of services: those with an identity go to readers of Fast DDS and others, those without to all but readers of Fast DDS.
  virtual void separate_by_vendor() = 0;
};

class Reader {
 public:
  virtual ~Reader() = default;
  virtual const Guid& guid() const = 0;
  virtual const EndpointSettings& settings() const = 0;
  virtual const std::vector<Guid>& writers() const = 0;
};

class Participant {
 public:
  static base::Result<std::unique_ptr<Participant>> open(const ParticipantSettings& settings);
  virtual ~Participant() = default;  // after its writers and readers

  virtual const Guid& guid() const = 0;
  virtual const ParticipantSettings& settings() const = 0;
  // `on_match` is called by deliver() when a reader comes or goes.
  virtual base::Result<std::unique_ptr<Writer>> make_writer(EndpointSettings settings, std::function<void()> on_match = {}) = 0;
  virtual base::Result<std::unique_ptr<Reader>> make_reader(EndpointSettings settings, std::function<void(Received&)> on_sample) = 0;
  // `on_peer` is called by deliver() for each remote endpoint that comes or goes.
  virtual void watch(std::function<void(const Peer&)> on_peer) = 0;

  // Readable when deliver() has something to do; an eventfd.
  virtual int descriptor() const = 0;
  // True when a reader or a writer was matched, or is no more.
  virtual bool deliver() = 0;
  // Samples that were thrown away because too many came at once.
  virtual std::uint64_t refused() const = 0;
};

// By its GUID: made by eProsima (Fast DDS), or by others.
inline bool is_fast_dds(const Guid& guid) { return guid[0] == 1 && guid[1] == 15; }

}  // namespace ros2
