#include "map_device.h"

#include <zlib.h>

#include <utility>

#include "base/log.h"
#include "protocol/payloads.h"

namespace gateway {

std::string map_cells(const shm::WorldMap& map, const player::MapTile& tile) {
  constexpr std::uint8_t grey_occupied = 0, grey_unknown = 205;
  const auto columns = static_cast<std::uint32_t>(map.area.width), rows = static_cast<std::uint32_t>(map.area.height);
  if (tile.column >= columns || tile.width > columns - tile.column || tile.row >= rows || tile.height > rows - tile.row) return {};
  std::string cells;
  cells.reserve(std::size_t{tile.width} * tile.height);
  for (std::uint32_t row = tile.row; row < tile.row + tile.height; ++row) {
    for (std::uint32_t column = tile.column; column < tile.column + tile.width; ++column) {
      const std::uint8_t grey = map.pixels[std::size_t{rows - 1 - row} * columns + column];
      cells += static_cast<char>(grey == grey_occupied ? 1 : grey == grey_unknown ? 0 : -1);
    }
  }
  return cells;
}

Answer Map::tile(const std::string& payload) const {
  const auto wanted = player::decode_map_tile(payload);
  if (!wanted) return nack();
  const std::string cells = map_cells(*map_, *wanted);
  if (cells.empty()) return nack();
  uLongf size = ::compressBound(cells.size());
  std::string packed(size, '\0');
  if (::compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(cells.data()), cells.size()) != Z_OK)
    return nack();
  packed.resize(size);
  return packed.size() < player::max_message - 64 ? ack(player::encode_map_tile(*wanted, packed)) : nack();
}

std::optional<Answer> Map::answer(std::uint8_t subtype, const std::string& payload, const Later& later) {
  constexpr std::uint8_t get_info = 1;
  if (subtype != get_info) return tile(payload);
  services_.errands.post(shm::ExportRequest{true}, [map = map_, later](const base::Result<shm::Reply>& reply) {
    auto made = reply ? shm::make_map(reply->text, {}) : base::Result<shm::WorldMap>(reply.error());
    if (!made) {
      base::log(base::Level::warn, "player-gateway", "{}", made.error().message);
      return later(nack());
    }
    *map = std::move(*made);
    const auto& area = map->area;
    later(ack(player::encode_map_info(area.resolution, static_cast<std::uint32_t>(area.width), static_cast<std::uint32_t>(area.height),
                                      {area.x, area.y, 0})));
  });
  return std::nullopt;
}

}  // namespace gateway
