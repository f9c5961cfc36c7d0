#include "physics/displacement.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sim {
namespace {

constexpr std::size_t faces_of_block = 64;
constexpr int sides = 64;  // of cylinders and capsules

// An outline (radius, z) from the lower end to the upper one, turned about z. Its ends are on the axis. The radii are such that each
// cross-section has the area of the circle.
TriangleMesh turned(const std::vector<std::pair<double, double>>& outline) {
  const double step = 2 * std::numbers::pi / sides, wider = std::sqrt(step / std::sin(step));
  TriangleMesh mesh;
  for (const auto& [radius, z] : outline) {
    for (int i = 0; i < sides; ++i) mesh.vertices.emplace_back(wider * radius * std::cos(i * step), wider * radius * std::sin(i * step), z);
  }
  for (std::size_t ring = 0; ring + 1 < outline.size(); ++ring) {
    for (int i = 0; i < sides; ++i) {
      const auto low = static_cast<std::uint32_t>(ring * sides), high = low + sides;
      const auto here = static_cast<std::uint32_t>(i), next = static_cast<std::uint32_t>((i + 1) % sides);
      mesh.triangles.push_back({low + here, low + next, high + next});
      mesh.triangles.push_back({low + here, high + next, high + here});
    }
  }
  return mesh;
}

TriangleMesh box_triangles(const Eigen::Vector3d& size) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.emplace_back(0.5 *
                               Eigen::Vector3d((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1, (i & 4) != 0 ? 1 : -1).cwiseProduct(size));
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

TriangleMesh capsule_triangles(const CapsuleShape& capsule) {
  constexpr int rings = 24;  // of each end
  std::vector<std::pair<double, double>> outline;
  for (int end = -1; end <= 1; end += 2) {
    for (int i = 0; i <= rings; ++i) {
      const double angle = std::numbers::pi / 2 * (end < 0 ? i - rings : i) / rings;
      outline.emplace_back(capsule.radius * std::max(std::cos(angle), 0.0), end * capsule.length / 2 + capsule.radius * std::sin(angle));
    }
  }
  outline.front().first = outline.back().first = 0;
  return turned(outline);
}

double reach_of(const Eigen::AlignedBox3d& box, const Eigen::Vector3d& normal) { return 0.5 * normal.cwiseAbs().dot(box.sizes()); }

}  // namespace

// --- faces: by the theorem of Gauss, with a field that is zero on the plane, so that the cut itself needs no face

void Displacement::add(Integrals& to, const Eigen::Vector3d& normal, double height, const Triangle& face) {
  const auto& [a, b, c] = face;
  const double through = 0.5 * normal.dot((b - a).cross(c - a));
  const double at_a = normal.dot(a) - height, at_b = normal.dot(b) - height, at_c = normal.dot(c) - height;
  const double sum = at_a + at_b + at_c;
  to.volume += through / 3 * sum;
  to.moment += through / 12 * (a * at_a + b * at_b + c * at_c + (a + b + c) * sum);
  to.square += through / 12 * (at_a * at_a + at_b * at_b + at_c * at_c + sum * sum);
}

// The part of the face that is below.
void Displacement::add_below(Integrals& to, const Eigen::Vector3d& normal, double height, const Triangle& face) {
  std::array<Eigen::Vector3d, 4> part;
  std::size_t count = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Eigen::Vector3d &p = face[i], &q = face[(i + 1) % 3];
    const double at_p = normal.dot(p) - height, at_q = normal.dot(q) - height;
    if (at_p <= 0) part[count++] = p;
    if ((at_p < 0 && at_q > 0) || (at_p > 0 && at_q < 0)) part[count++] = p + (at_p / (at_p - at_q)) * (q - p);
  }
  for (std::size_t i = 2; i < count; ++i) add(to, normal, height, {part[0], part[i - 1], part[i]});
}

void Displacement::add_block(Integrals& to, const Eigen::Vector3d& normal, double height, const Sums& sums) {
  Eigen::Matrix3d product = Eigen::Matrix3d::Zero();
  for (int j = 0; j < 3; ++j) product += normal[j] * sums.product[static_cast<std::size_t>(j)];
  const Eigen::Vector3d place = sums.place * normal;
  const double area = normal.dot(sums.area);
  to.volume += normal.dot(place) - height * area;
  to.moment += product * normal - height * place;
  to.square += normal.dot(product * normal) - 2 * height * normal.dot(place) + height * height * area;
}

// Neighbours come into one block.
void Displacement::split(std::size_t first, std::size_t end) {
  Eigen::AlignedBox3d box;
  for (std::size_t i = first; i < end; ++i) {
    for (const auto& corner : triangles_[i]) box.extend(corner);
  }
  if (end - first > faces_of_block) {
    Eigen::Index axis = 0;
    box.sizes().maxCoeff(&axis);
    const auto at = [&](std::size_t i) { return triangles_.begin() + static_cast<std::ptrdiff_t>(i); };
    const std::size_t middle = (first + end) / 2;
    std::nth_element(at(first), at(middle), at(end), [axis](const Triangle& a, const Triangle& b) {
      return a[0][axis] + a[1][axis] + a[2][axis] < b[0][axis] + b[1][axis] + b[2][axis];
    });
    split(first, middle);
    split(middle, end);
    return;
  }
  Block block{first, end, box, {}};
  for (std::size_t i = first; i < end; ++i) {
    const auto& [a, b, c] = triangles_[i];
    const Eigen::Vector3d area = 0.5 * (b - a).cross(c - a), sum = a + b + c;
    block.sums.area += area;
    block.sums.place += sum / 3 * area.transpose();
    const Eigen::Matrix3d product = (a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose()) / 12;
    for (int j = 0; j < 3; ++j) block.sums.product[static_cast<std::size_t>(j)] += area[j] * product;
  }
  blocks_.push_back(block);
}

std::optional<Displacement> Displacement::of_triangles(const TriangleMesh& mesh) {
  Displacement made;
  for (const auto& corners : mesh.triangles)
    made.triangles_.push_back({mesh.vertices[corners[0]], mesh.vertices[corners[1]], mesh.vertices[corners[2]]});
  if (made.triangles_.empty()) return std::nullopt;
  made.split(0, made.triangles_.size());
  for (const Block& block : made.blocks_) made.box_.extend(block.box);
  Integrals all;
  for (const Block& block : made.blocks_) add_block(all, Eigen::Vector3d::UnitZ(), made.box_.max().z(), block.sums);
  made.side_ = all.volume < 0 ? -1 : 1;
  made.whole_.volume = made.side_ * all.volume;
  made.whole_.moment = made.side_ * (all.moment - Eigen::Vector3d::UnitZ() * (0.5 * all.square));
  if (!(made.whole_.volume > 0) || !made.whole_.moment.allFinite()) return std::nullopt;
  // What is symmetric floats level, also where a breath would turn it over.
  const double rounding = 1e-12 * made.whole_.volume * made.box_.sizes().maxCoeff();
  made.whole_.moment = (made.whole_.moment.array().abs() < rounding).select(0, made.whole_.moment);
  return made;
}

Displacement Displacement::of_ellipsoid(const Eigen::Vector3d& radii) {
  Displacement made;
  made.radii_ = radii;
  made.box_ = Eigen::AlignedBox3d(-radii, radii);
  made.whole_.volume = 4.0 / 3 * std::numbers::pi * radii.prod();
  return made;
}

std::optional<Displacement> Displacement::of(const GeometryDef& geometry, TriangleCache& triangles) {
  if (const auto* box = std::get_if<BoxShape>(&geometry)) return of_triangles(box_triangles(box->size));
  if (const auto* sphere = std::get_if<SphereShape>(&geometry)) return of_ellipsoid(Eigen::Vector3d::Constant(sphere->radius));
  if (const auto* ellipsoid = std::get_if<EllipsoidShape>(&geometry)) return of_ellipsoid(ellipsoid->radii);
  if (const auto* capsule = std::get_if<CapsuleShape>(&geometry)) return of_triangles(capsule_triangles(*capsule));
  if (const auto* cone = std::get_if<ConeShape>(&geometry)) return of_triangles(cone_triangles(*cone));
  if (const auto* c = std::get_if<CylinderShape>(&geometry))
    return of_triangles(turned({{0, -c->length / 2}, {c->radius, -c->length / 2}, {c->radius, c->length / 2}, {0, c->length / 2}}));
  if (!std::holds_alternative<MeshShape>(geometry) && !std::holds_alternative<PolylineShape>(geometry)) return std::nullopt;
  const auto mesh = triangles.triangles(geometry);
  return mesh ? of_triangles(**mesh) : std::nullopt;
}

Displacement::Part Displacement::below(const Eigen::Vector3d& normal, double height) const {
  const double reach = radii_.x() > 0 ? radii_.cwiseProduct(normal).norm() : reach_of(box_, normal);
  const double depth = height - normal.dot(box_.center());  // of the middle
  if (depth >= reach) return whole_;
  if (depth <= -reach) return {};
  Part part;
  if (radii_.x() > 0) {
    // As a ball of radius 1, in which the plane is at t.
    const double t = depth / reach;
    part.volume = radii_.prod() * std::numbers::pi * (2.0 / 3 + t - t * t * t / 3);
    const double moment = -std::numbers::pi / 4 * (1 - t * t) * (1 - t * t);
    part.moment = radii_.prod() * moment * radii_.cwiseProduct(radii_.cwiseProduct(normal)) / reach;
    return part;
  }
  Integrals all;
  for (const Block& block : blocks_) {
    const double beside = reach_of(block.box, normal), at = normal.dot(block.box.center()) - height;
    if (at >= beside) continue;
    if (at <= -beside) {
      add_block(all, normal, height, block.sums);
      continue;
    }
    for (std::size_t i = block.first; i < block.end; ++i) add_below(all, normal, height, triangles_[i]);
  }
  part.volume = side_ * all.volume;
  part.moment = side_ * (all.moment - normal * (0.5 * all.square));
  return part.volume > 0 ? part : Part{};
}

}  // namespace sim
