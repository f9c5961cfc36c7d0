#include "map_device.h"

#include <zlib.h>

#include <utility>

#include "base/log.h"
#include "protocol/payloads.h"

namespace gateway {
namespace {

constexpr std::uint8_t get_info = 1, get_tile = 2;  // of map; 3 gets lines
constexpr std::uint8_t get_layer = 3;               // of vectormap; 1 gets the layers
constexpr std::string_view layer = "walls";

Answer fitting(std::string payload) {
  if (payload.size() < player::max_message - 64) return ack(std::move(payload));
  base::log(base::Level::warn, "player-gateway", "a part of the map has {} bytes, more than the 8 MiB that Player can send",
            payload.size());
  return nack();
}

}  // namespace

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
  return fitting(player::encode_map_tile(*wanted, packed));
}

void MapDevice::make(std::function<void(const shm::WorldMap*)> done) {
  constexpr int max_cells = 4096;  // a side: seconds of work
  const auto made = std::make_shared<base::Result<shm::WorldMap>>(base::Error{""});
  const auto work = [made](const base::Result<shm::Reply>& reply) {
    shm::MapOptions options;
    options.max_cells = max_cells;
    options.may_coarsen = true;
    *made = reply ? shm::make_map(reply->text, options) : base::Result<shm::WorldMap>(reply.error());
  };
  services_.long_requests.post(
      shm::ExportRequest{true},
      [made, map = map_, done = std::move(done)](const base::Result<shm::Reply>& reply) {
        if (!reply || !*made) {
          base::log(base::Level::warn, "player-gateway", "{}", (reply ? made->error() : reply.error()).message);
          return done(nullptr);
        }
        *map = std::move(**made);
        done(map.get());
      },
      AsyncRequests::limit, work);
}

std::vector<player::Segment> MapDevice::lines_of(const shm::WorldMap& map) {
  std::vector<player::Segment> lines;
  for (const shm::MapLine& line : map.lines) lines.push_back({line.x0, line.y0, line.x1, line.y1});
  return lines;
}

std::optional<Answer> Map::answer(std::uint8_t subtype, const std::string& payload, const Later& later) {
  if (subtype == get_tile) return tile(payload);
  make([later, subtype](const shm::WorldMap* map) {
    if (map == nullptr) return later(nack());
    const auto& area = map->area;
    const std::string info = player::encode_map_info(area.resolution, static_cast<std::uint32_t>(area.width),
                                                     static_cast<std::uint32_t>(area.height), {area.x, area.y, 0});
    later(fitting(subtype == get_info ? info : player::encode_map_lines(lines_of(*map))));
  });
  return std::nullopt;
}

std::optional<Answer> VectorMap::answer(std::uint8_t subtype, const std::string& payload, const Later& later) {
  if (subtype == get_layer) {
    const auto name = player::decode_vectormap_layer(payload);
    return name && *name == layer ? fitting(player::encode_vectormap_layer(layer, lines_of(*map_))) : nack();
  }
  make([later](const shm::WorldMap* map) {
    if (map == nullptr) return later(nack());
    const auto& area = map->area;
    later(ack(player::encode_vectormap_info(
        layer, {area.x, area.y, area.x + area.width * area.resolution, area.y + area.height * area.resolution})));
  });
  return std::nullopt;
}

}  // namespace gateway
