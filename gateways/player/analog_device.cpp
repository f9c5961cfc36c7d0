#include "analog_device.h"

#include <vector>

#include "protocol/payloads.h"

namespace gateway {

void Analog::show_sample() {
  std::vector<double> values;
  if (iface().type() == shm::IfaceType::altimeter) {
    const auto& sample = iface().sample<shm::AltimeterSample>();
    values = {sample.height, sample.climb};
  } else if (iface().type() == shm::IfaceType::air_pressure) {
    values = {iface().sample<shm::AirPressureSample>().pressure};
  } else {
    const auto& sample = iface().sample<shm::ForceTorqueSample>();
    values.assign(std::begin(sample.force), std::end(sample.force));
    values.insert(values.end(), std::begin(sample.torque), std::end(sample.torque));
  }
  publish(1, player::encode_voltages(values), iface().sample<shm::Stamp>());
}

std::optional<Answer> Analog::answer(std::uint8_t, const std::string&, const Later&) { return nack(); }

}  // namespace gateway
