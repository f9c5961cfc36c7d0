// Payloads of what shows the world and ways through it: map, vectormap, planner; and those of plain bytes: opaque, dio.
#include <algorithm>
#include <bit>
#include <cmath>

#include "protocol/payload_codec.h"
#include "protocol/payloads.h"

namespace player {
namespace {

void put(XdrWriter& out, const Segment& segment) {
  for (const double value : {segment.x0, segment.y0, segment.x1, segment.y1}) out.f64(value);
}

// The smallest x and y, then the largest.
Segment extent_of(const std::vector<Segment>& lines) {
  if (lines.empty()) return {};
  Segment extent{lines[0].x0, lines[0].y0, lines[0].x0, lines[0].y0};
  for (const Segment& line : lines) {
    extent.x0 = std::min({extent.x0, line.x0, line.x1});
    extent.y0 = std::min({extent.y0, line.y0, line.y1});
    extent.x1 = std::max({extent.x1, line.x0, line.x1});
    extent.y1 = std::max({extent.y1, line.y0, line.y1});
  }
  return extent;
}

// Well known binary, little endian: a line string of two points.
std::string wkb_of(const Segment& line) {
  std::string bytes("\1\2\0\0\0\2\0\0\0", 9);
  for (const double value : {line.x0, line.y0, line.x1, line.y1}) {
    const auto bits = std::bit_cast<std::uint64_t>(value);
    for (unsigned shift = 0; shift < 64; shift += 8) bytes += static_cast<char>(bits >> shift & 0xff);
  }
  return bytes;
}

Color take_color(XdrReader& in) {
  Color color;
  for (std::uint8_t* channel : {&color.alpha, &color.red, &color.green, &color.blue}) *channel = static_cast<std::uint8_t>(in.small(255));
  return color;
}

Shape2d take_shape(XdrReader& in) {
  Shape2d shape;
  shape.points.resize(in.count(16, max_message / 16));
  for (Point2d& point : shape.points) {
    point.x = in.f64();
    point.y = in.f64();
  }
  shape.color = take_color(in);
  return shape;
}

}  // namespace

// ---- map ----

std::string encode_map_info(double scale, std::uint32_t width, std::uint32_t height, const Pose2d& origin) {
  return written([&](XdrWriter& out) {
    out.f32(static_cast<float>(scale));
    out.u32(width);
    out.u32(height);
    put(out, origin);
  });
}

std::optional<MapTile> decode_map_tile(std::string_view payload) {
  return whole(payload, [](XdrReader& in) {
    MapTile tile;
    for (std::uint32_t* value : {&tile.column, &tile.row, &tile.width, &tile.height}) *value = in.u32();
    for (int i = 0; i < 3; ++i) in.u32();  // cells and their range, which a request does not have
    return tile;
  });
}

std::string encode_map_tile(const MapTile& tile, std::string_view packed) {
  constexpr std::uint32_t range = 1;
  const auto size = static_cast<std::uint32_t>(packed.size());
  return written([&](XdrWriter& out) {
    for (const std::uint32_t value : {tile.column, tile.row, tile.width, tile.height, size, range, size}) out.u32(value);
    out.raw(packed);
  });
}

std::string encode_map_lines(const std::vector<Segment>& lines) {
  const Segment extent = extent_of(lines);
  return written([&](XdrWriter& out) {
    for (const double value : {extent.x0, extent.x1, extent.y0, extent.y1}) out.f32(static_cast<float>(value));
    out.count(lines.size());
    for (const Segment& line : lines) put(out, line);
  });
}

// ---- vectormap ----

std::string encode_vectormap_info(std::string_view layer, const Segment& extent) {
  return written([&](XdrWriter& out) {
    out.u32(0);  // no spatial reference system
    out.count(1);
    out.counted_text(layer);
    put(out, extent);
    put(out, extent);
  });
}

std::string encode_vectormap_layer(std::string_view layer, const std::vector<Segment>& lines) {
  return written([&](XdrWriter& out) {
    out.counted_text(layer);
    out.count(lines.size());
    for (const Segment& line : lines) {
      out.counted_text("wall");
      out.counted_bytes(wkb_of(line));
      out.counted_text("");  // attributes
    }
  });
}

std::optional<std::string> decode_vectormap_layer(std::string_view payload) {
  constexpr std::size_t longest = 256;
  return whole(payload, [](XdrReader& in) {
    std::string name(in.counted_text(longest));
    in.count(4, 0);  // features, which a request does not have
    return name;
  });
}

// ---- planner ----

std::string encode(const PlannerState& state) {
  return written([&](XdrWriter& out) {
    out.boolean(state.is_valid);
    out.boolean(state.is_done);
    for (const Pose2d& pose : {state.pose, state.goal, state.waypoint}) put(out, pose);
    out.i32(state.index);
    out.u32(state.count);
  });
}

std::string encode_waypoints(double length, const std::vector<Pose2d>& waypoints) {
  return written([&](XdrWriter& out) {
    out.f64(length);
    out.count(waypoints.size());
    for (const Pose2d& pose : waypoints) put(out, pose);
  });
}

// ---- graphics2d, graphics3d ----

std::optional<Shape2d> decode_points(std::string_view payload) { return whole(payload, take_shape); }

std::optional<Shape2d> decode_polygon(std::string_view payload) {
  return whole(payload, [](XdrReader& in) {
    Shape2d shape = take_shape(in);
    shape.fill = take_color(in);
    shape.is_filled = in.boolean();
    return shape;
  });
}

std::optional<Drawing> decode_drawing(std::string_view payload) {
  return whole(payload, [](XdrReader& in) {
    Drawing drawing;
    drawing.mode = static_cast<Drawing::Mode>(in.small(static_cast<std::uint32_t>(Drawing::Mode::polygon)));
    drawing.points.resize(in.count(24, max_message / 24));
    for (Point3d& point : drawing.points) {
      for (double* value : {&point.x, &point.y, &point.z}) *value = in.f64();
    }
    drawing.color = take_color(in);
    return drawing;
  });
}

std::optional<Rotation> decode_rotation(std::string_view payload) {
  return whole(payload, [](XdrReader& in) {
    Rotation rotation;
    for (double* value : {&rotation.angle, &rotation.axis.x, &rotation.axis.y, &rotation.axis.z}) *value = in.f64();
    return rotation;
  });
}

// ---- opaque, dio ----

std::optional<std::string> decode_opaque(std::string_view payload) {
  return whole(payload, [](XdrReader& in) { return std::string(in.counted_bytes(max_message)); });
}

std::string encode_opaque(std::string_view bytes) {
  return written([&](XdrWriter& out) { out.counted_bytes(bytes); });
}

std::string encode_bits(const std::vector<bool>& bits) {
  constexpr std::size_t most = 32;
  const std::size_t count = std::min(bits.size(), most);
  std::uint32_t word = 0;
  for (std::size_t i = 0; i < count; ++i) word |= bits[i] ? 1U << i : 0U;
  return written([&](XdrWriter& out) {
    out.u32(static_cast<std::uint32_t>(count));
    out.u32(word);
  });
}

}  // namespace player
