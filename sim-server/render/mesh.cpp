// Generated meshes.
#include "render/mesh.h"

#include <cmath>
#include <numbers>

namespace sim {
namespace {

std::array<float, 3> to_array(const Eigen::Vector3d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

void add_vertex(Mesh& mesh, const Eigen::Vector3d& position, const Eigen::Vector3d& normal, double u, double v) {
  mesh.vertices.push_back({to_array(position), to_array(normal), {static_cast<float>(u), static_cast<float>(v)}});
}

void add_quad(Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
  mesh.indices.insert(mesh.indices.end(), {a, b, c, a, c, d});
}

void finish_shape(Mesh& mesh) {
  mesh.parts.assign(1, {0, static_cast<std::uint32_t>(mesh.indices.size()), MaterialDef{}, {}, false});
  finish(mesh);
}

// A surface of revolution about z. Profile points run from the top to the bottom.
struct ProfilePoint {
  double radius, z;
  Eigen::Vector2d normal;  // outwards, upwards
  double v;
};

void add_lathe(Mesh& mesh, const std::vector<ProfilePoint>& profile, int segments) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const auto& p : profile) {
    for (int s = 0; s <= segments; ++s) {
      const double angle = 2 * std::numbers::pi * s / segments;
      const Eigen::Vector3d out(std::cos(angle), std::sin(angle), 0);
      add_vertex(mesh, out * p.radius + Eigen::Vector3d(0, 0, p.z), out * p.normal.x() + Eigen::Vector3d(0, 0, p.normal.y()),
                 static_cast<double>(s) / segments, p.v);
    }
  }
  const auto row = static_cast<std::uint32_t>(segments + 1);
  for (std::uint32_t r = 0; r + 1 < profile.size(); ++r) {
    for (std::uint32_t s = 0; s < static_cast<std::uint32_t>(segments); ++s) {
      const std::uint32_t top = first + r * row + s;
      const std::uint32_t bottom = top + row;
      if (profile[r + 1].radius > 0) mesh.indices.insert(mesh.indices.end(), {top, bottom, bottom + 1});
      if (profile[r].radius > 0) mesh.indices.insert(mesh.indices.end(), {top, bottom + 1, top + 1});
    }
  }
}

void add_disc(Mesh& mesh, double radius, double z, bool is_up, int segments) {
  const Eigen::Vector3d normal(0, 0, is_up ? 1 : -1);
  const auto middle = static_cast<std::uint32_t>(mesh.vertices.size());
  add_vertex(mesh, {0, 0, z}, normal, 0.5, 0.5);
  for (int s = 0; s <= segments; ++s) {
    const double angle = 2 * std::numbers::pi * s / segments;
    add_vertex(mesh, {radius * std::cos(angle), radius * std::sin(angle), z}, normal, 0.5 + 0.5 * std::cos(angle),
               0.5 - 0.5 * std::sin(angle));
  }
  for (std::uint32_t s = 1; s <= static_cast<std::uint32_t>(segments); ++s) {
    const std::uint32_t a = middle + s;
    if (is_up)
      mesh.indices.insert(mesh.indices.end(), {middle, a, a + 1});
    else
      mesh.indices.insert(mesh.indices.end(), {middle, a + 1, a});
  }
}

}  // namespace

void finish(Mesh& mesh) {
  mesh.bounds.setEmpty();
  for (auto& part : mesh.parts) {
    const std::span<const std::uint32_t> indices(mesh.indices.data() + part.first_index, part.index_count);
    part.bounds.setEmpty();
    for (const auto index : indices)
      part.bounds.extend(Eigen::Vector3f(Eigen::Map<const Eigen::Vector3f>(mesh.vertices[index].position.data())));
    mesh.bounds.extend(part.bounds);
    const auto normal = [&](std::size_t i) { return Eigen::Map<const Eigen::Vector3f>(mesh.vertices[indices[i]].normal.data()); };
    part.is_faceted = true;
    for (std::size_t i = 0; i + 2 < indices.size() && part.is_faceted; i += 3)
      part.is_faceted = normal(i).dot(normal(i + 1)) > 0.999999F && normal(i).dot(normal(i + 2)) > 0.999999F;
  }
}

Mesh make_box() {
  Mesh mesh;
  // For each face its normal, and which way the image's u and v run on it.
  const Eigen::Vector3d faces[6][3] = {
      {{1, 0, 0}, {0, 1, 0}, {0, 0, -1}},  {{-1, 0, 0}, {0, -1, 0}, {0, 0, -1}}, {{0, 1, 0}, {-1, 0, 0}, {0, 0, -1}},
      {{0, -1, 0}, {1, 0, 0}, {0, 0, -1}}, {{0, 0, 1}, {1, 0, 0}, {0, -1, 0}},   {{0, 0, -1}, {1, 0, 0}, {0, 1, 0}},
  };
  for (const auto& [normal, u, v] : faces) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    const Eigen::Vector3d corner = 0.5 * (normal - u - v);
    add_vertex(mesh, corner, normal, 0, 0);
    add_vertex(mesh, corner + v, normal, 0, 1);
    add_vertex(mesh, corner + u + v, normal, 1, 1);
    add_vertex(mesh, corner + u, normal, 1, 0);
    add_quad(mesh, first, first + 1, first + 2, first + 3);
  }
  mesh.is_closed = true;
  finish_shape(mesh);
  return mesh;
}

Mesh make_sphere(int rings, int segments) {
  Mesh mesh;
  std::vector<ProfilePoint> profile;
  for (int r = 0; r <= rings; ++r) {
    const double polar = std::numbers::pi * r / rings;
    const Eigen::Vector2d normal(std::sin(polar), std::cos(polar));
    const double radius = r == 0 || r == rings ? 0 : 0.5 * normal.x();
    profile.push_back({radius, 0.5 * normal.y(), normal, static_cast<double>(r) / rings});
  }
  add_lathe(mesh, profile, segments);
  mesh.is_closed = true;
  mesh.round = {RoundKind::capsule, 0.5F, 0};
  finish_shape(mesh);
  return mesh;
}

Mesh make_cylinder(int segments) {
  Mesh mesh;
  add_lathe(mesh, {{0.5, 0.5, {1, 0}, 0}, {0.5, -0.5, {1, 0}, 1}}, segments);
  add_disc(mesh, 0.5, 0.5, true, segments);
  add_disc(mesh, 0.5, -0.5, false, segments);
  mesh.is_closed = true;
  mesh.round = {RoundKind::cylinder, 0.5F, 0.5F};
  finish_shape(mesh);
  return mesh;
}

Mesh make_cone(double radius, double length, int segments) {
  Mesh mesh;
  const Eigen::Vector2d normal = Eigen::Vector2d(length, radius).normalized();
  add_lathe(mesh, {{0, length / 2, normal, 0}, {radius, -length / 2, normal, 1}}, segments);
  add_disc(mesh, radius, -length / 2, false, segments);
  mesh.is_closed = true;
  finish_shape(mesh);
  return mesh;
}

Mesh make_plane() {
  Mesh mesh;
  add_vertex(mesh, {-0.5, 0.5, 0}, {0, 0, 1}, 0, 0);
  add_vertex(mesh, {-0.5, -0.5, 0}, {0, 0, 1}, 0, 1);
  add_vertex(mesh, {0.5, -0.5, 0}, {0, 0, 1}, 1, 1);
  add_vertex(mesh, {0.5, 0.5, 0}, {0, 0, 1}, 1, 0);
  add_quad(mesh, 0, 1, 2, 3);
  finish_shape(mesh);
  return mesh;
}

Mesh make_capsule(double radius, double length, int rings, int segments) {
  Mesh mesh;
  const double whole = length + std::numbers::pi * radius;
  std::vector<ProfilePoint> profile;
  for (int half = 0; half < 2; ++half) {
    for (int r = 0; r <= rings / 2; ++r) {
      const double polar = std::numbers::pi / 2 * (half + 2.0 * r / rings);
      const Eigen::Vector2d normal(std::sin(polar), std::cos(polar));
      const bool is_pole = (half == 0 && r == 0) || (half == 1 && r == rings / 2);
      const double z = radius * normal.y() + (half == 0 ? 0.5 : -0.5) * length;
      profile.push_back({is_pole ? 0 : radius * normal.x(), z, normal, (polar * radius + half * length) / whole});
    }
  }
  add_lathe(mesh, profile, segments);
  mesh.is_closed = true;
  mesh.round = {RoundKind::capsule, static_cast<float>(radius), static_cast<float>(0.5 * length)};
  finish_shape(mesh);
  return mesh;
}

Mesh make_height_grid(int columns, int rows, double width, double depth, std::span<const float> heights) {
  Mesh mesh;
  const double dx = width / (columns - 1);
  const double dy = depth / (rows - 1);
  const auto height = [&](int column, int row) {
    const int c = std::clamp(column, 0, columns - 1);
    const int r = std::clamp(row, 0, rows - 1);
    return static_cast<double>(heights[static_cast<std::size_t>(r) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(c)]);
  };
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) {
      const Eigen::Vector3d normal((height(c - 1, r) - height(c + 1, r)) / (2 * dx), (height(c, r + 1) - height(c, r - 1)) / (2 * dy), 1);
      add_vertex(mesh, {c * dx - 0.5 * width, 0.5 * depth - r * dy, height(c, r)}, normal.normalized(),
                 static_cast<double>(c) / (columns - 1), static_cast<double>(r) / (rows - 1));
    }
  }
  for (int r = 0; r + 1 < rows; ++r) {
    for (int c = 0; c + 1 < columns; ++c) {
      const auto a = static_cast<std::uint32_t>(r * columns + c);
      const std::uint32_t below = a + static_cast<std::uint32_t>(columns);
      mesh.indices.insert(mesh.indices.end(), {a, below, a + 1, a + 1, below, below + 1});
    }
  }
  finish_shape(mesh);
  return mesh;
}

Mesh make_flat(std::span<const Eigen::Vector3d> vertices, std::span<const std::array<std::uint32_t, 3>> triangles) {
  Mesh mesh;
  for (const auto& triangle : triangles) {
    const Eigen::Vector3d& a = vertices[triangle[0]];
    const Eigen::Vector3d cross = (vertices[triangle[1]] - a).cross(vertices[triangle[2]] - a);
    if (cross.norm() < 1e-15) continue;
    const Eigen::Vector3d normal = cross.normalized();
    const bool is_level = std::abs(normal.z()) > 0.7;
    for (const auto index : triangle) {
      const Eigen::Vector3d& p = vertices[index];
      const double along = is_level ? p.x() : p.x() * -normal.y() + p.y() * normal.x();
      mesh.indices.push_back(static_cast<std::uint32_t>(mesh.vertices.size()));
      add_vertex(mesh, p, normal, along, is_level ? -p.y() : -p.z());
    }
  }
  finish_shape(mesh);
  return mesh;
}

}  // namespace sim
