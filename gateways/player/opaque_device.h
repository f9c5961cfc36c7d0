// opaque and dio: bytes between clients, and bits of bumpers. One thread at a time.
#pragma once

#include <array>

#include "device.h"

namespace gateway {

// What a client sends goes to the other clients of the device. The simulator does not look at it.
class Opaque final : public Device {
 public:
  using Device::Device;
  static constexpr std::array shows{shm::IfaceType::simulation};
  static constexpr std::array table = std::to_array<Served>({
      {player::Type::data, 1, "bytes that another client has sent"},
      {player::Type::command, 1, "bytes for the other clients, at most 1 MiB"},
  });

 private:
  ServedTable served() const override { return table; }
  bool has_data() const override { return false; }
  std::optional<Answer> answer(std::uint8_t, const std::string&, const Later&) override { return nack(); }
  void obey(Client& client, std::uint8_t subtype, const std::string& payload) override;
};

class Digital final : public Device {
 public:
  using Device::Device;
  static constexpr std::array shows{shm::IfaceType::bumper};
  static constexpr std::array table = std::to_array<Served>({{player::Type::data, 1, "one bit: pressed"}});

 private:
  ServedTable served() const override { return table; }
  void show_sample() override;
  std::optional<Answer> answer(std::uint8_t, const std::string&, const Later&) override { return nack(); }
};

}  // namespace gateway
