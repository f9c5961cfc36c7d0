#include "opaque_device.h"

#include "protocol/payloads.h"

namespace gateway {

void Opaque::obey(Client& client, std::uint8_t, const std::string& payload) {
  const auto bytes = player::decode_opaque(payload);
  if (!bytes || !iface().read()) return;
  publish(1, player::encode_opaque(*bytes), iface().sample<shm::SimulationSample>().stamp, &client);
}

void Digital::show_sample() {
  const auto view = iface().bumper();
  publish(1, player::encode_bits({view.sample->total > 0}), view.sample->stamp);
}

}  // namespace gateway
