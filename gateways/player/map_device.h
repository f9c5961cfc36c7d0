// map and vectormap: the static part of the world, as an occupancy grid in tiles and as lines. They publish no data. One thread at a time.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <vector>

#include "device.h"
#include "shm/world_map.h"

namespace gateway {

// Makes the map, in the thread of the long async_requests: cells grow where it would have more than 4096 a side.
class MapDevice : public Device {
 public:
  using Device::Device;
  static constexpr std::array shows{shm::IfaceType::simulation};

 protected:
  bool has_data() const override { return false; }
  // `done` gets the map as it is now, or nothing, which has been logged.
  void make(std::function<void(const shm::WorldMap*)> done);
  static std::vector<player::Segment> lines_of(const shm::WorldMap& map);

  std::shared_ptr<shm::WorldMap> map_ = std::make_shared<shm::WorldMap>();  // also of answers that come after the device has gone
};

// Each request for the size or the lines makes the map again; tiles are of the last map.
class Map final : public MapDevice {
 public:
  using MapDevice::MapDevice;
  static constexpr std::array table = std::to_array<Served>({
      {player::Type::request, 1, "scale [m], size and origin of the occupancy map"},
      {player::Type::request, 2, "tiles, compressed by zlib: -1 free, 0 unknown, 1 occupied"},
      {player::Type::request, 3, "outlines as lines"},
  });

 private:
  ServedTable served() const override { return table; }
  std::optional<Answer> answer(std::uint8_t subtype, const std::string& payload, const Later& later) override;
  Answer tile(const std::string& payload) const;
};

// Each request for the layers makes the map again; the layer is of the last map.
class VectorMap final : public MapDevice {
 public:
  using MapDevice::MapDevice;
  static constexpr std::array table = std::to_array<Served>({
      {player::Type::request, 1, "layers and extent"},
      {player::Type::request, 3, "the layer `walls`: outlines of what is static, each line in well known binary"},
  });

 private:
  ServedTable served() const override { return table; }
  std::optional<Answer> answer(std::uint8_t subtype, const std::string& payload, const Later& later) override;
};

// The cells of a tile, the row of the lowest y first; empty when it has none or is not wholly in the map.
std::string map_cells(const shm::WorldMap& map, const player::MapTile& tile);

}  // namespace gateway
