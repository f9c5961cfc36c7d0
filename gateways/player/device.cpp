#include "device.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "base/log.h"

namespace gateway {

Device::Device(const player::Address& address, std::uint32_t robot, Services services)
    : services_(services), address_(address), robot_(robot) {}

Device::~Device() = default;

std::string Device::driver() const {
  constexpr std::size_t room = 62;
  constexpr std::string_view maker = "rtm-sim ", cut = "...";
  std::string name = source_ ? source_->iface().name() : std::string(player::to_text(address_.interface));
  if (maker.size() + name.size() > room) name.replace(0, maker.size() + cut.size() + name.size() - room, cut);
  return std::string(maker) + name;
}

void Device::attach(std::shared_ptr<Source> source, std::shared_ptr<Source> companion) {
  if (source == source_ && companion == companion_) return;
  stop_reading();
  const bool is_new = source != source_;
  source_ = std::move(source);
  companion_ = std::move(companion);
  if (is_new) on_attach();
  if (!is_used()) return;
  if (auto good = start_reading(); !good) base::log(base::Level::warn, "player-gateway", "{}", good.error().message);
}

void Device::detach() {
  stop_reading();
  source_.reset();
  companion_.reset();
}

base::Result<void> Device::start_reading() {
  if (is_reading_ || !has_data()) return {};
  if (auto good = source_->add_reader(); !good) return good;
  if (companion_) {
    if (auto good = companion_->add_reader(); !good) {
      source_->remove_reader();
      return good;
    }
  }
  is_reading_ = true;
  return {};
}

void Device::stop_reading() {
  if (is_reading_) source_->remove_reader();
  if (is_reading_ && companion_) companion_->remove_reader();
  is_reading_ = false;
}

std::vector<Device::Subscriber>::iterator Device::find(const Client& client) {
  return std::find_if(subscribers_.begin(), subscribers_.end(), [&](const Subscriber& one) { return one.client == &client; });
}

base::Result<void> Device::subscribe(Client& client) {
  if (!source_) return base::Error{player::to_text(address_) + " has no data: the simulator does not run, or no longer has it"};
  if (auto good = check(); !good) return good;
  if (auto good = start_reading(); !good) return good;
  if (const auto known = find(client); known != subscribers_.end()) {
    ++known->count;
  } else {
    subscribers_.push_back({&client, 1});
  }
  return {};
}

bool Device::unsubscribe(Client& client) {
  const auto known = find(client);
  if (known == subscribers_.end()) return false;
  if (--known->count == 0) remove(known);
  return true;
}

void Device::leave(Client& client) {
  if (const auto known = find(client); known != subscribers_.end()) remove(known);
}

void Device::remove(std::vector<Subscriber>::iterator subscriber) {
  Client& client = *subscriber->client;
  subscribers_.erase(subscriber);
  forget(client);
  if (is_used()) return;
  stop_reading();
  on_unused();
}

bool Device::is_subscribed(const Client& client) const {
  return std::any_of(subscribers_.begin(), subscribers_.end(), [&](const Subscriber& one) { return one.client == &client; });
}

void Device::take_sample() {
  if (source_ && is_reading_) show_sample();
}

void Device::show_latest(Client& newcomer) {
  if (!source_ || !is_reading_ || !source_->has_sample()) return;
  newcomer_ = &newcomer;
  show_sample();
  newcomer_ = nullptr;
}

std::optional<Answer> Device::request(std::uint8_t subtype, const std::string& payload, const Later& later) {
  if (!source_) return nack();
  if (player::universal_request::is_one(subtype)) return answer_universal(subtype, payload);
  if (!is_served(served(), static_cast<std::uint32_t>(player::Type::request), subtype)) return nack();
  return answer(subtype, payload, later);
}

Answer Device::answer_universal(std::uint8_t subtype, const std::string& payload) {
  if (subtype == player::universal_request::capabilities) {
    const auto asked = player::decode_capability(payload);
    if (!asked) return nack();
    const bool is_request = asked->type == static_cast<std::uint32_t>(player::Type::request);
    const bool is_universal =
        is_request && asked->subtype <= 255 && player::universal_request::is_one(static_cast<std::uint8_t>(asked->subtype));
    return is_universal || is_served(served(), asked->type, asked->subtype) ? ack() : nack();
  }
  auto request = player::decode_driver_property(subtype, payload);
  if (!request) return nack();
  if (!player::universal_request::is_get(subtype)) return set_property(*request) ? ack() : nack();
  auto value = property(request->key);
  if (!value || value->index() != request->value.index()) return nack();
  request->value = std::move(*value);
  return ack(player::encode(*request));
}

std::optional<player::PropertyValue> Device::property(const std::string& key) const {
  return key == "iface" ? std::optional<player::PropertyValue>(iface().name()) : std::nullopt;
}

bool Device::command(Client& client, std::uint8_t subtype, const std::string& payload) {
  if (!source_ || !is_subscribed(client)) return true;
  if (!is_served(served(), static_cast<std::uint32_t>(player::Type::command), subtype)) return false;
  obey(client, subtype, payload);
  return true;
}

void Device::publish(std::uint8_t subtype, const std::string& payload, const shm::Stamp& stamp, const Client* but) {
  assert(is_served(served(), static_cast<std::uint32_t>(player::Type::data), subtype));
  const auto time = services_.timeline.at(source_->server(), stamp.resets, stamp.sim_time_ns);
  if (!time) return;
  // Clients take a sample for new only if its time is later than the one before, which starts at 0.
  last_time_ = std::max(*time, last_time_ + 1e-6);
  services_.timeline.note(last_time_);
  player::Header header{.address = address_, .type = player::Type::data, .subtype = subtype, .timestamp = last_time_, .size = 0};
  const auto message = std::make_shared<const std::string>(player::encode(header, robot_, payload));
  for (const Subscriber& one : subscribers_) {
    if (one.client != but && (newcomer_ == nullptr || newcomer_ == one.client)) one.client->deliver(address_, subtype, message);
  }
}

std::nullopt_t Device::ask(shm::Request request, const Later& later) {
  services_.async_requests.post(std::move(request), [later](const base::Result<shm::Reply>& reply) { later(reply ? ack() : nack()); });
  return std::nullopt;
}

player::Pose3d to_pose3d(const shm::Pose& p) {
  const double roll = std::atan2(2 * (p.qw * p.qx + p.qy * p.qz), 1 - 2 * (p.qx * p.qx + p.qy * p.qy));
  const double pitch = std::asin(std::clamp(2 * (p.qw * p.qy - p.qz * p.qx), -1.0, 1.0));
  const double yaw = std::atan2(2 * (p.qw * p.qz + p.qx * p.qy), 1 - 2 * (p.qy * p.qy + p.qz * p.qz));
  return {p.x, p.y, p.z, roll, pitch, yaw};
}

double seen_range(float range, double min_range, double max_range) {
  if (std::isnan(range)) return max_range;
  return std::clamp(static_cast<double>(range), std::max(0.0, min_range), std::max(0.0, max_range));
}

}  // namespace gateway
