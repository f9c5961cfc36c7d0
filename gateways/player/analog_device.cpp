#include "analog_device.h"

#include <algorithm>
#include <vector>

#include "protocol/payloads.h"

namespace gateway {
namespace {

std::vector<double> values_of(const shm::Iface& iface) {
  switch (iface.type()) {
    case shm::IfaceType::altimeter: {
      const auto& sample = iface.sample<shm::AltimeterSample>();
      return {sample.height, sample.climb};
    }
    case shm::IfaceType::air_pressure:
      return {iface.sample<shm::AirPressureSample>().pressure};
    case shm::IfaceType::air_speed: {
      const auto& sample = iface.sample<shm::AirSpeedSample>();
      return {sample.pressure, sample.temperature};
    }
    case shm::IfaceType::dvl: {
      const auto& sample = iface.sample<shm::DvlSample>();
      return {sample.velocity[0], sample.velocity[1], sample.velocity[2], std::min(sample.range, iface.info<shm::DvlInfo>().max_range)};
    }
    case shm::IfaceType::wheels: {
      std::vector<double> angles;
      for (const shm::WheelState& encoder : iface.elements<shm::WheelState>()) angles.push_back(encoder.angle);
      return angles;
    }
    default: {
      const auto& sample = iface.sample<shm::ForceTorqueSample>();
      std::vector<double> values(std::begin(sample.force), std::end(sample.force));
      values.insert(values.end(), std::begin(sample.torque), std::end(sample.torque));
      return values;
    }
  }
}

}  // namespace

void Analog::show_sample() { publish(1, player::encode_voltages(values_of(iface())), iface().sample<shm::Stamp>()); }

std::optional<Answer> Analog::answer(std::uint8_t, const std::string&, const Later&) { return nack(); }

}  // namespace gateway
