// map: the occupancy of the world by static shapes, in tiles. Has no data. One thread at a time.
#pragma once

#include <array>
#include <memory>

#include "device.h"
#include "shm/world_map.h"

namespace gateway {

// Each request for the size makes the map again; tiles are of the last map.
class Map final : public Device {
 public:
  using Device::Device;
  static constexpr std::array shows{shm::IfaceType::simulation};
  static constexpr std::array table = std::to_array<Served>({
      {player::Type::request, 1, "scale [m], size and origin of the occupancy map"},
      {player::Type::request, 2, "tiles, compressed by zlib: -1 free, 0 unknown, 1 occupied"},
  });

 private:
  ServedTable served() const override { return table; }
  std::optional<Answer> answer(std::uint8_t subtype, const std::string& payload, const Later& later) override;
  bool has_data() const override { return false; }
  Answer tile(const std::string& payload) const;

  std::shared_ptr<shm::WorldMap> map_ = std::make_shared<shm::WorldMap>();  // also of answers that come after the device has gone
};

// The cells of a tile, the row of the lowest y first; empty when it has none or is not wholly in the map.
std::string map_cells(const shm::WorldMap& map, const player::MapTile& tile);

}  // namespace gateway
