#include "shm/world_map.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <span>

#include "base/text.h"
#include "shm/control.h"

namespace shm {
namespace {

using Json = nlohmann::ordered_json;
using base::Error;
using base::Result;

constexpr double margin = 0.5;  // [m] around what is shown, unless an area is given

struct Shape {
  std::vector<MapPoint> points;  // three for each triangle, in the world
  bool is_plane = false;
};

struct Transform {
  std::array<double, 16> m = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};  // by columns
  MapPoint operator()(const MapPoint& p) const {
    MapPoint out;
    for (std::size_t r = 0; r < 3; ++r) out[r] = m[r] * p[0] + m[4 + r] * p[1] + m[8 + r] * p[2] + m[12 + r];
    return out;
  }
};

Transform pose_of_link(const Json& node) {
  const auto t = node.value("translation", std::array<double, 3>{});
  const auto [x, y, z, w] = node.value("rotation", std::array<double, 4>{0, 0, 0, 1});
  return {{1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w), 0,  //
           2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w), 0,  //
           2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y), 0,  //
           t[0], t[1], t[2], 1}};
}

// Reads what the simulator exports (sim-server/render/gltf.h). Throws what the JSON library throws when that is not as expected.
class Export {
 public:
  explicit Export(const std::string& glb);
  // Of models that are static, or of all.
  std::vector<Shape> shapes(bool with_movable) const;

 private:
  template <class T>
  std::vector<T> values(const Json& accessor, std::size_t count) const;
  std::vector<std::uint32_t> indices(const Json& accessor) const;
  void add(const Json& link, std::vector<Shape>& shapes) const;

  Json json_;
  std::string_view octets_;
};

Export::Export(const std::string& glb) {
  constexpr std::size_t head = 12, chunk_head = 8;
  std::uint32_t size = 0;
  if (glb.size() >= head + chunk_head) std::memcpy(&size, glb.data() + head, sizeof size);
  const std::string_view rest = std::string_view(glb).substr(std::min(glb.size(), head + chunk_head));
  json_ = Json::parse(rest.substr(0, size));
  octets_ = rest.size() > size + chunk_head ? rest.substr(size + chunk_head) : std::string_view();
}

template <class T>
std::vector<T> Export::values(const Json& accessor, std::size_t count) const {
  const auto& view = json_.at("bufferViews").at(accessor.at("bufferView").get<std::size_t>());
  const auto from = view.value("byteOffset", std::size_t{0}) + accessor.value("byteOffset", std::size_t{0});
  std::vector<T> out(accessor.at("count").get<std::size_t>() * count);
  if (from > octets_.size() || out.size() * sizeof(T) > octets_.size() - from) throw std::out_of_range("accessor");
  if (!out.empty()) std::memcpy(out.data(), octets_.data() + from, out.size() * sizeof(T));
  return out;
}

std::vector<std::uint32_t> Export::indices(const Json& accessor) const {
  constexpr int u16_component = 5123;
  if (accessor.at("componentType").get<int>() != u16_component) return values<std::uint32_t>(accessor, 1);
  const auto small = values<std::uint16_t>(accessor, 1);
  return {small.begin(), small.end()};
}

// Parts of one mesh, which differ in material only, are one shape.
void Export::add(const Json& link, std::vector<Shape>& shapes) const {
  const Transform in_world = pose_of_link(link);
  std::map<std::string, Shape> by_mesh;
  for (const auto& child : link.value("children", std::vector<std::size_t>())) {
    const auto& node = json_.at("nodes").at(child);
    if (!node.contains("mesh") || node.contains("skin")) continue;
    const auto& primitive = json_.at("meshes").at(node.at("mesh").get<std::size_t>()).at("primitives").at(0);
    const auto& position = primitive.at("attributes").at("POSITION");
    const auto& accessors = json_.at("accessors");
    const auto places = values<float>(accessors.at(position.get<std::size_t>()), 3);
    Transform in_link;
    if (node.contains("matrix")) in_link.m = node.at("matrix").get<std::array<double, 16>>();
    Shape& shape = by_mesh[position.dump() + (node.contains("matrix") ? node.at("matrix").dump() : "")];
    shape.is_plane = node.at("extras").value("grid", false);
    for (const std::uint32_t i : indices(accessors.at(primitive.at("indices").get<std::size_t>()))) {
      const std::size_t at = std::size_t{3} * i;
      shape.points.push_back(in_world(in_link({places.at(at), places.at(at + 1), places.at(at + 2)})));
    }
  }
  for (auto& [key, shape] : by_mesh) shapes.push_back(std::move(shape));
}

std::vector<Shape> Export::shapes(bool with_movable) const {
  std::vector<Shape> shapes;
  const auto& nodes = json_.at("nodes");
  for (const auto& top : nodes.at(0).value("children", std::vector<std::size_t>())) {
    const auto& model = nodes.at(top);
    const auto extras = model.value("extras", Json::object());
    if (!extras.value("model", false) || (!with_movable && !extras.value("static", false))) continue;
    for (const auto& link : model.value("children", std::vector<std::size_t>())) add(nodes.at(link), shapes);
  }
  return shapes;
}

// Where something stands between the heights, with a margin: xmin, ymin, xmax, ymax. Empty: nothing does.
std::vector<double> area_of(const std::vector<Shape>& shapes, const MapOptions& options) {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  std::vector<double> area = {infinite, infinite, -infinite, -infinite};
  const auto include = [&](double x, double y) {
    area = {std::min(area[0], x - margin), std::min(area[1], y - margin), std::max(area[2], x + margin), std::max(area[3], y + margin)};
  };
  for (const auto& [x, y] : options.places) include(x, y);
  for (const Shape& shape : shapes) {
    for (std::size_t i = 0; !shape.is_plane && i + 2 < shape.points.size(); i += 3) {
      const auto triangle = std::span(shape.points).subspan(i, 3);
      const auto [least, most] = std::ranges::minmax(triangle, {}, [](const MapPoint& p) { return p[2]; });
      if (most[2] <= options.heights[0] || least[2] >= options.heights[1]) continue;
      for (const MapPoint& p : triangle) include(p[0], p[1]);
    }
  }
  return area[0] < area[2] ? area : std::vector<double>();
}

// Corners at multiples of the resolution, so that maps of one world fit on each other.
Result<MapArea> grid_of(const std::vector<double>& area, const MapOptions& options) {
  const double least = std::max(area[2] - area[0], area[3] - area[1]) / (options.max_cells - 2);
  const double r = options.may_coarsen ? std::max(options.resolution, least) : options.resolution;
  const auto down = [&](double v) { return std::floor(v / r + 1e-6); };
  const auto up = [&](double v) { return std::ceil(v / r - 1e-6); };
  const double width = up(area[2]) - down(area[0]), height = up(area[3]) - down(area[1]);
  if (width > options.max_cells || height > options.max_cells) {
    return Error{"map: " + base::format_number(r) + " m makes " + base::format_number(width) + " x " + base::format_number(height) +
                 " cells, expected at most " + std::to_string(options.max_cells) +
                 " a side: give a larger --resolution or a smaller --area"};
  }
  return MapArea{down(area[0]) * r,  down(area[1]) * r, r, static_cast<int>(width), static_cast<int>(height),
                 options.heights[0], options.heights[1]};
}

Result<std::vector<Shape>> shapes_in(const std::string& glb, bool with_movable) {
  try {
    return Export(glb).shapes(with_movable);
  } catch (const std::exception&) {
    return Error{"simulator: its export is not the glTF that this program reads"};
  }
}

}  // namespace

base::Result<WorldMap> make_map(const std::string& glb, const MapOptions& options) {
  const auto shapes = shapes_in(glb, options.with_movable);
  if (!shapes) return shapes.error();
  const auto bounds = options.area.empty() ? area_of(*shapes, options) : options.area;
  if (bounds.empty()) {
    return Error{"map: no static model is between " + base::format_number(options.heights[0]) + " and " +
                 base::format_number(options.heights[1]) + " m; give an area or other heights"};
  }
  const auto area = grid_of(bounds, options);
  if (!area) return area.error();
  OccupancyMap cells(*area);
  std::vector<MapLine> lines;
  for (const Shape& shape : *shapes) {
    if (!shape.is_plane) {
      cells.add_mesh(shape.points);
      add_map_lines(shape.points, 0.5 * (area->low + area->high), lines);
    } else if (shape.points.size() >= 3) {
      const MapPoint &a = shape.points[0], &b = shape.points[1], &c = shape.points[2];
      const MapPoint u{b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v{c[0] - a[0], c[1] - a[1], c[2] - a[2]};
      cells.add_plane(a, {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]});
    }
  }
  return WorldMap{*area, cells.pixels(), std::move(lines)};
}

base::Result<WorldMap> world_map(Requester& requester, const MapOptions& options, std::chrono::nanoseconds timeout) {
  const auto reply = ask_for(requester, ExportRequest{true}, timeout);
  if (!reply) return reply.error();
  return make_map(reply->text, options);
}

}  // namespace shm
