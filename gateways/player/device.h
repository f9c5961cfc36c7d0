// The common part of all devices of a port: subscriptions, source of the samples, and sending of messages to clients. One thread at a
// time.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "common/async_requests.h"
#include "common/source.h"
#include "joint_group.h"
#include "outbox.h"
#include "protocol/message.h"
#include "protocol/payloads.h"
#include "real_time.h"
#include "served.h"
#include "shm/iface_types.h"
#include "timeline.h"

namespace gateway {

// Whoever gets data; leaves all devices before it ends.
class Client {
 public:
  virtual ~Client() = default;
  virtual void deliver(const player::Address& device, std::uint8_t subtype, const SharedBytes& message) = 0;
};

struct Answer {
  bool is_ack = false;
  std::string payload;
};
inline Answer ack(std::string payload = {}) { return {true, std::move(payload)}; }
inline Answer nack() { return {}; }
using Later = std::function<void(Answer)>;

// What devices share.
struct Services {
  AsyncRequests& async_requests;
  AsyncRequests& long_requests;  // with work that would delay the others
  Timeline& timeline;
  RealTime& real_time;
};

class Device {
 public:
  Device(const player::Address& address, std::uint32_t robot, Services services);
  virtual ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  const player::Address& address() const { return address_; }
  // Also news of the companion are shown.
  virtual bool shows_companion() const { return false; }
  // Before it is attached: the joints that it shows, of devices that show joints.
  virtual void choose(const JointGroup&) {}
  // Names the iface, by its end where it is long: at most 62 characters.
  std::string driver() const;

  // The simulator has (again) what this device shows; a companion is what it shows besides (the magnetometer of an imu). Clients that are
  // subscribed stay it.
  void attach(std::shared_ptr<Source> source, std::shared_ptr<Source> companion = nullptr);
  void detach();
  const std::shared_ptr<Source>& source() const { return source_; }
  const std::shared_ptr<Source>& companion() const { return companion_; }

  // Counted per client. Rejected while there is nothing to show.
  base::Result<void> subscribe(Client& client);
  // False when it was not subscribed.
  bool unsubscribe(Client& client);
  // Takes back all of the client's subscriptions.
  void leave(Client& client);
  bool is_subscribed(const Client& client) const;
  bool is_used() const { return !subscribers_.empty(); }

  // The source has a new sample or frame.
  void take_sample();
  // What others who read the source have got already: a newcomer does not wait for the next one, which never comes while time stands still.
  void show_latest(Client& newcomer);
  // Nothing: `later` will be called with the answer, from the same thread.
  std::optional<Answer> request(std::uint8_t subtype, const std::string& payload, const Later& later);
  // Of a client that is subscribed; false when there is no such command.
  bool command(Client& client, std::uint8_t subtype, const std::string& payload);

 protected:
  virtual ServedTable served() const = 0;
  // All only while there is a source, and for messages that are in the table.
  virtual void show_sample() {}
  virtual std::optional<Answer> answer(std::uint8_t subtype, const std::string& payload, const Later& later) = 0;
  virtual void obey(Client&, std::uint8_t /*subtype*/, const std::string& /*payload*/) {}
  // Of the driver, by name: read by requests of clients, and set if it can be.
  virtual std::optional<player::PropertyValue> property(const std::string& key) const;
  virtual bool set_property(const player::DriverProperty&) { return false; }
  // A client that was subscribed no longer is.
  virtual void forget(Client&) {}
  virtual void on_attach() {}
  // The last subscriber has left.
  virtual void on_unused() {}
  // False for devices that never have data.
  virtual bool has_data() const { return true; }
  // The reason that subscriptions are rejected for; none: they are accepted.
  virtual base::Result<void> check() const { return {}; }

  std::uint32_t port() const { return robot_; }
  shm::Iface& iface() const { return source_->iface(); }
  // What is shown just now is shown to a newcomer alone, who should not wait.
  bool is_for_newcomer() const { return newcomer_ != nullptr; }
  // To all subscribers but one, or the newcomer, with one encoding.
  void publish(std::uint8_t subtype, const std::string& payload, const shm::Stamp& stamp, const Client* but = nullptr);
  // Lets the simulator do it; the answer is an empty ack when it did.
  std::nullopt_t ask(shm::Request request, const Later& later);

  Services services_;

 private:
  struct Subscriber {
    Client* client;
    int count;
  };
  std::vector<Subscriber>::iterator find(const Client& client);
  void remove(std::vector<Subscriber>::iterator subscriber);
  // Those that each interface has: capabilities and properties.
  Answer answer_universal(std::uint8_t subtype, const std::string& payload);
  base::Result<void> start_reading();
  void stop_reading();

  const player::Address address_;
  const std::uint32_t robot_;
  std::shared_ptr<Source> source_, companion_;
  bool is_reading_ = false;
  std::vector<Subscriber> subscribers_;
  Client* newcomer_ = nullptr;  // the only one that a sample is shown to just now
  double last_time_ = 0;
};

// ---- for the devices ----
player::Pose3d to_pose3d(const shm::Pose& pose);
// What clients may see of a range: never NaN, negative or infinite; no hit is max_range, too near is min_range.
double seen_range(float range, double min_range, double max_range);

}  // namespace gateway
