// <geometry> -> GeometryDef: all kinds of SDFormat.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "base/text.h"
#include "world/checks.h"
#include "world/model_builder.h"
#include "world/xml_file.h"
#include "world/xml_values.h"

namespace sim {

namespace {

std::optional<GeometryDef> build_polyline(pugi::xml_node geometry, BuildContext& context) {
  PolylineShape shape;
  shape.height = number_at(geometry.child("polyline"), "height", 1);
  for (pugi::xml_node line : geometry.children("polyline")) {
    std::vector<Eigen::Vector2d> outline;
    for (pugi::xml_node point : line.children("point")) {
      const std::optional<std::vector<double>> n = parse_numbers(text_of(point));
      if (n && n->size() == 2) outline.emplace_back((*n)[0], (*n)[1]);
    }
    if (outline.size() > 1 && (outline.front() - outline.back()).norm() < 1e-9) outline.pop_back();
    if (outline.size() >= 3) {
      shape.outlines.push_back(std::move(outline));
    } else {
      context.complaints.warn(line, "a polyline with fewer than three points is ignored");
    }
  }
  if (!shape.outlines.empty()) return shape;
  context.complaints.drop(geometry, describe_in_context(geometry.parent()) + " has a polyline without an outline and is left out");
  return std::nullopt;
}

HeightmapShape build_heightmap(pugi::xml_node node) {
  HeightmapShape shape;
  shape.path = text_at(node, "uri");
  shape.size = vector3_at(node, "size", shape.size);
  shape.position = vector3_at(node, "pos", shape.position);
  shape.sampling = std::clamp(integer_at(node, "sampling", 1), 1, 16);
  for (pugi::xml_node texture : node.children("texture")) {
    const auto file = [&](const char* key) {
      const std::string path = text_at(texture, key);
      return path.starts_with('/') || path.starts_with(color_file) ? path : std::string();
    };
    shape.textures.push_back({std::max(number_at(texture, "size", 10), 1e-3), file("diffuse"), file("normal")});
  }
  for (pugi::xml_node blend : node.children("blend"))
    shape.blends.emplace_back(number_at(blend, "min_height", 0), number_at(blend, "fade_dist", 0));
  return shape;
}

// Those of a file of elevations begin where they are on the Earth, perhaps far above the models.
void note_elevations(pugi::xml_node geometry, const HeightmapShape& shape, const HeightGrid& grid, BuildContext& context) {
  const std::string kind = base::to_lower(std::filesystem::path(shape.path).extension().string());
  const float lowest = *std::min_element(grid.heights.begin(), grid.heights.end());
  if ((kind != ".tif" && kind != ".tiff") || lowest == 0 || std::string_view(geometry.parent().name()) != "collision") return;
  context.complaints.note(geometry.child("heightmap"),
                          fmt::format("the elevations of {} begin at {:g} m: the lowest place of {} is that far above its <pos>",
                                      shape.path, lowest, describe_in_context(geometry.parent())));
}

// A height map that cannot be read becomes a flat ground: all that stands on it would else fall for ever.
GeometryDef build_ground(pugi::xml_node geometry, BuildContext& context) {
  const pugi::xml_node node = geometry.child("heightmap");
  HeightmapShape shape = build_heightmap(node);
  const PlaneShape flat{{0, 0, 1}, shape.size.head<2>()};
  if (shape.path == missing_file) return flat;  // it has had its line
  const auto grid = context.triangles.heights(shape);
  if (grid) {
    note_elevations(geometry, shape, **grid, context);
    return shape;
  }
  context.complaints.drop(node, grid.error().message + "; a flat ground is taken for " + describe_in_context(geometry.parent()));
  return flat;
}

PlaneShape build_plane(pugi::xml_node node) {
  PlaneShape shape;
  shape.normal = vector3_at(node, "normal", shape.normal).normalized();
  shape.size = vector2_at(node, "size", shape.size);
  return shape;
}

MeshShape build_mesh(pugi::xml_node node) {
  MeshShape shape;
  shape.path = text_at(node, "uri");
  shape.scale = vector3_at(node, "scale", shape.scale);
  shape.submesh = text_at(node, "submesh/name");
  if (shape.submesh == "__default__") shape.submesh.clear();
  shape.center_submesh = bool_at(node, "submesh/center", false);
  return shape;
}

}  // namespace

Eigen::Isometry3d ground_in_shape(pugi::xml_node geometry, const GeometryDef& built) {
  const pugi::xml_node map = geometry.child("heightmap");
  Eigen::Isometry3d place = Eigen::Isometry3d::Identity();
  if (map && std::holds_alternative<PlaneShape>(built)) place.translation() = vector3_at(map, "pos", {0, 0, 0});
  return place;
}

std::optional<GeometryDef> build_geometry(pugi::xml_node geometry, BuildContext& context) {
  if (pugi::xml_node node = geometry.child("box")) return BoxShape{vector3_at(node, "size", {1, 1, 1})};
  if (pugi::xml_node node = geometry.child("sphere")) return SphereShape{number_at(node, "radius", 1)};
  if (pugi::xml_node node = geometry.child("cylinder")) return CylinderShape{number_at(node, "radius", 1), number_at(node, "length", 1)};
  if (pugi::xml_node node = geometry.child("capsule")) return CapsuleShape{number_at(node, "radius", 0.5), number_at(node, "length", 1)};
  if (pugi::xml_node node = geometry.child("cone")) return ConeShape{number_at(node, "radius", 0.5), number_at(node, "length", 1)};
  if (pugi::xml_node node = geometry.child("ellipsoid")) {
    if (std::string_view(geometry.parent().name()) == "collision") {
      context.complaints.note(node, "the ellipsoid of " + describe_in_context(geometry.parent()) + " is approximated");
    }
    return EllipsoidShape{vector3_at(node, "radii", {1, 1, 1})};
  }
  if (pugi::xml_node node = geometry.child("plane")) return build_plane(node);
  if (pugi::xml_node node = geometry.child("mesh"); node && !text_at(node, "uri").empty()) return build_mesh(node);
  if (geometry.child("heightmap")) return build_ground(geometry, context);
  if (geometry.child("polyline")) return build_polyline(geometry, context);
  const pugi::xml_node owner = geometry.parent();
  if (geometry.child("mesh")) {
    context.complaints.drop(owner, "<mesh> of " + describe_in_context(owner) + " has no <uri>; the " + owner.name() + " is left out");
  } else if (const pugi::xml_node image = geometry.child("image")) {
    context.complaints.drop(image, "shapes from images are not simulated; " + describe_in_context(owner) + " is left out");
  } else if (!geometry.child("empty")) {
    context.complaints.warn(owner, describe_in_context(owner) + " has no shape and is ignored");
  }
  return std::nullopt;
}

}  // namespace sim
