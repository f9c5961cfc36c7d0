#include "power_device.h"

#include <utility>

#include "protocol/payloads.h"

namespace gateway {

void Power::show_sample() {
  constexpr double seconds = 3600;  // in an hour
  const auto& sample = iface().sample<shm::BatterySample>();
  player::PowerState state;
  state.volts = static_cast<float>(sample.voltage);
  state.percent = static_cast<float>(100 * sample.level);
  state.joules = static_cast<float>(sample.charge * seconds * iface().info<shm::BatteryInfo>().constant);
  state.watts = static_cast<float>(-sample.voltage * sample.current);
  state.charging = sample.state == RTMSIM_BATTERY_CHARGES ? 1 : -1;
  publish(1, player::encode(state), sample.stamp);
}

bool Power::charge(bool is_on) {
  if (!iface().command(shm::CommandKind::charge, std::array{is_on ? 1.0 : 0.0})) return false;
  is_charging_ = is_on;
  return true;
}

std::optional<Answer> Power::answer(std::uint8_t, const std::string& payload, const Later&) {
  const auto policy = player::decode_charging_policy(payload);
  if (!policy || !policy->has_output) return nack();
  const bool can_charge = iface().info<shm::BatteryInfo>().charging_time > 0;
  return (can_charge || !policy->has_input) && charge(policy->has_input) ? ack() : nack();
}

// Who connects a charger and goes disconnects it.
void Power::on_unused() {
  if (std::exchange(is_charging_, false) && source()) charge(false);
}

}  // namespace gateway
