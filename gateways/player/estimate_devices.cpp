#include "estimate_devices.h"

#include <cmath>

#include "protocol/payloads.h"

namespace gateway {

void Localize::show_sample() {
  latest_.clear();
  for (const shm::Hypothesis& one : iface().elements<shm::Hypothesis>()) {
    const double* c = one.covariance;
    latest_.push_back({{one.pose[0], one.pose[1], one.pose[2]}, {c[0], c[3], c[5], c[1], c[4], c[2]}, one.weight});
  }
  const auto& stamp = iface().sample<shm::LocalizationSample>().stamp;
  publish(1, player::encode_hypotheses(static_cast<double>(stamp.sim_time_ns) / 1e9, latest_), stamp);
}

std::optional<Answer> Localize::answer(std::uint8_t, const std::string&, const Later&) { return ack(player::encode_particles(latest_)); }

void Rfid::show_sample() {
  std::vector<std::string> ids;
  for (const shm::RfidTag& tag : iface().elements<shm::RfidTag>()) ids.emplace_back(tag.id);
  publish(1, player::encode_tags(ids), iface().sample<shm::RfidSample>().stamp);
}

std::optional<Answer> Rfid::answer(std::uint8_t, const std::string&, const Later&) { return nack(); }

void Wifi::show_sample() {
  std::vector<player::WifiLink> links;
  for (const shm::Radio& radio : iface().elements<shm::Radio>())
    links.push_back(
        {radio.transmitter, radio.essid, static_cast<std::uint32_t>(radio.frequency), static_cast<int>(std::lround(radio.level))});
  publish(1, player::encode_links(links), iface().sample<shm::WirelessSample>().stamp);
}

std::optional<Answer> Wifi::answer(std::uint8_t, const std::string&, const Later&) { return nack(); }

}  // namespace gateway
