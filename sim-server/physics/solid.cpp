#include "physics/solid.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace sim {
namespace {

constexpr std::uint32_t leaf_faces = 4;
constexpr double flat = 0.995;  // cosine between two faces whose edge is none

double distance_squared(const Aabb& box, const Eigen::Vector3d& p) {
  return (box.low - p).cwiseMax(p - box.high).cwiseMax(0).squaredNorm();
}

bool meets(const Aabb& box, const Eigen::Vector3d& from, const Eigen::Vector3d& along) {
  double enter = 0, leave = 1;
  for (int k = 0; k < 3; ++k) {
    if (std::abs(along[k]) < 1e-300) {
      if (from[k] < box.low[k] || from[k] > box.high[k]) return false;
      continue;
    }
    const double a = (box.low[k] - from[k]) / along[k], b = (box.high[k] - from[k]) / along[k];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter <= leave + 1e-12;
}

}  // namespace

Solid::Solid(const TriangleMesh& mesh) {
  weld(mesh);
  find_edges();
  find_normals();
  order_.resize(faces_.size());
  std::iota(order_.begin(), order_.end(), 0U);
  nodes_.emplace_back();
  split(0, 0, static_cast<std::uint32_t>(faces_.size()));
}

// Corners are doubled where faces have normals or colours of their own.
void Solid::weld(const TriangleMesh& mesh) {
  const auto less = [&](std::uint32_t a, std::uint32_t b) {
    const Eigen::Vector3d &p = mesh.vertices[a], &q = mesh.vertices[b];
    return std::lexicographical_compare(p.data(), p.data() + 3, q.data(), q.data() + 3);
  };
  std::vector<std::uint32_t> sorted(mesh.vertices.size()), corner_of(mesh.vertices.size());
  std::iota(sorted.begin(), sorted.end(), 0U);
  std::sort(sorted.begin(), sorted.end(), less);
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    if (i == 0 || mesh.vertices[sorted[i]] != mesh.vertices[sorted[i - 1]])
      corners_.push_back({mesh.vertices[sorted[i]], Eigen::Vector3d::Zero()});
    corner_of[sorted[i]] = static_cast<std::uint32_t>(corners_.size() - 1);
  }
  double volume = 0;
  for (const auto& triangle : mesh.triangles) {
    Face face;
    for (std::size_t k = 0; k < 3; ++k) face.corners[k] = corner_of[triangle[k]];
    const Eigen::Vector3d &a = corners_[face.corners[0]].place, &b = corners_[face.corners[1]].place, &c = corners_[face.corners[2]].place;
    const Eigen::Vector3d cross = (b - a).cross(c - a);
    if (!(cross.norm() > 1e-14)) continue;
    face.normal = cross.normalized();
    volume += a.dot(b.cross(c));
    faces_.push_back(face);
  }
  if (volume >= 0) return;
  for (Face& face : faces_) {
    std::swap(face.corners[1], face.corners[2]);
    face.normal = -face.normal;
  }
}

void Solid::find_edges() {
  struct Side {
    std::uint32_t a, b, face, k;
  };
  std::vector<Side> sides;
  for (std::uint32_t f = 0; f < faces_.size(); ++f) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      const auto a = faces_[f].corners[k], b = faces_[f].corners[(k + 1) % 3];
      sides.push_back({std::min(a, b), std::max(a, b), f, k});
    }
  }
  std::sort(sides.begin(), sides.end(),
            [](const Side& x, const Side& y) { return std::tie(x.a, x.b, x.face, x.k) < std::tie(y.a, y.b, y.face, y.k); });
  is_closed_ = true;
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t end = i + 1;
    while (end < sides.size() && sides[end].a == sides[i].a && sides[end].b == sides[i].b) ++end;
    Edge edge{sides[i].a, sides[i].b, Eigen::Vector3d::Zero(), true};
    for (std::size_t s = i; s < end; ++s) {
      edge.outward += faces_[sides[s].face].normal;
      faces_[sides[s].face].edges[sides[s].k] = static_cast<std::uint32_t>(edges_.size());
    }
    if (end - i == 2) {
      const Face &one = faces_[sides[i].face], &other = faces_[sides[i + 1].face];
      const Eigen::Vector3d opposite = corners_[other.corners[(sides[i + 1].k + 2) % 3]].place - corners_[edge.a].place;
      edge.is_sharp = one.normal.dot(other.normal) < flat && one.normal.dot(opposite) < 0;
    } else {
      is_closed_ = false;
    }
    edge.outward.normalize();
    edges_.push_back(edge);
    i = end;
  }
}

void Solid::find_normals() {
  for (const Face& face : faces_) {
    for (std::size_t k = 0; k < 3; ++k) {
      Corner& corner = corners_[face.corners[k]];
      const Eigen::Vector3d a = (corners_[face.corners[(k + 1) % 3]].place - corner.place).normalized();
      const Eigen::Vector3d b = (corners_[face.corners[(k + 2) % 3]].place - corner.place).normalized();
      corner.outward += std::acos(std::clamp(a.dot(b), -1.0, 1.0)) * face.normal;
    }
  }
  for (Corner& corner : corners_) corner.outward.normalize();
}

Aabb Solid::box_of_face(std::uint32_t face) const {
  Aabb box;
  for (const auto corner : faces_[face].corners) box.extend({corners_[corner].place, corners_[corner].place});
  return box;
}

void Solid::split(std::uint32_t node, std::uint32_t first, std::uint32_t count) {
  Aabb box, middles;
  const auto middle = [&](std::uint32_t face) -> Eigen::Vector3d {
    const Aabb b = box_of_face(face);
    return (b.low + b.high) / 2;
  };
  for (std::uint32_t i = first; i < first + count; ++i) {
    box.extend(box_of_face(order_[i]));
    const Eigen::Vector3d m = middle(order_[i]);
    middles.extend({m, m});
  }
  nodes_[node] = {box, first, count};
  if (count <= leaf_faces) return;
  int axis = 0;
  (middles.high - middles.low).maxCoeff(&axis);
  const auto half = count / 2;
  const auto begin = order_.begin() + first;
  std::nth_element(begin, begin + half, begin + count, [&](std::uint32_t a, std::uint32_t b) {
    const double x = middle(a)[axis], y = middle(b)[axis];
    return x != y ? x < y : a < b;
  });
  const auto children = static_cast<std::uint32_t>(nodes_.size());
  nodes_.resize(nodes_.size() + 2);
  nodes_[node].first = children;
  nodes_[node].count = 0;
  split(children, first, half);
  split(children + 1, first + half, count - half);
}

// The nearest place of one triangle, and the normal of what lies there: its face, an edge or a corner.
Solid::Nearest Solid::nearest_on(std::uint32_t index, const Eigen::Vector3d& p) const {
  const Face& face = faces_[index];
  const Eigen::Vector3d &a = corners_[face.corners[0]].place, &b = corners_[face.corners[1]].place, &c = corners_[face.corners[2]].place;
  Nearest best;
  const auto take = [&](const Eigen::Vector3d& place, const Eigen::Vector3d& outward) {
    best.place = place;
    best.normal = outward;
    best.distance = (p - place).norm();
    best.is_inside = (p - place).dot(outward) < 0;
    return best;
  };
  const Eigen::Vector3d ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return take(a, corners_[face.corners[0]].outward);
  const Eigen::Vector3d bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return take(b, corners_[face.corners[1]].outward);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return take(a + ab * (d1 / (d1 - d3)), edges_[face.edges[0]].outward);
  const Eigen::Vector3d cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return take(c, corners_[face.corners[2]].outward);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return take(a + ac * (d2 / (d2 - d6)), edges_[face.edges[2]].outward);
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
    return take(b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6))), edges_[face.edges[1]].outward);
  return take(p - face.normal * face.normal.dot(ap), face.normal);
}

std::optional<Solid::Nearest> Solid::nearest(const Eigen::Vector3d& point, double reach, const Eigen::Vector3d* against) const {
  constexpr double facing = -0.1;
  std::optional<Nearest> best;
  double most = reach;
  std::array<std::uint32_t, 64> open{};
  std::size_t count = 1;
  while (count > 0) {
    const Node& node = nodes_[open[--count]];
    if (distance_squared(node.box, point) > most * most) continue;
    if (node.count == 0 && !faces_.empty()) {
      const bool is_first_nearer = distance_squared(nodes_[node.first].box, point) < distance_squared(nodes_[node.first + 1].box, point);
      open[count++] = node.first + (is_first_nearer ? 1 : 0);
      open[count++] = node.first + (is_first_nearer ? 0 : 1);
      continue;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      if (against != nullptr && faces_[order_[i]].normal.dot(*against) > facing) continue;
      const Nearest found = nearest_on(order_[i], point);
      if (found.distance > most || (best && found.distance >= best->distance)) continue;
      most = found.distance;
      best = found;
    }
  }
  return best;
}

void Solid::crossings(const Eigen::Vector3d& from, const Eigen::Vector3d& to, std::vector<Crossing>& found) const {
  found.clear();
  const Eigen::Vector3d along = to - from;
  std::array<std::uint32_t, 64> open{};
  std::size_t count = 1;
  while (count > 0) {
    const Node& node = nodes_[open[--count]];
    if (!meets(node.box, from, along)) continue;
    if (node.count == 0 && !faces_.empty()) {
      open[count++] = node.first;
      open[count++] = node.first + 1;
      continue;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      const Face& face = faces_[order_[i]];
      const double slope = face.normal.dot(along);
      if (std::abs(slope) < 1e-12) continue;
      const double at = face.normal.dot(corners_[face.corners[0]].place - from) / slope;
      if (!(at >= 0 && at <= 1)) continue;
      const Eigen::Vector3d place = from + at * along;
      bool is_within = true;
      for (std::size_t k = 0; k < 3 && is_within; ++k) {
        const Eigen::Vector3d &a = corners_[face.corners[k]].place, &b = corners_[face.corners[(k + 1) % 3]].place;
        is_within = face.normal.dot((b - a).cross(place - a)) >= -1e-12;
      }
      if (is_within) found.push_back({at, order_[i]});
    }
  }
  std::sort(found.begin(), found.end(),
            [](const Crossing& a, const Crossing& b) { return std::tie(a.at, a.face) < std::tie(b.at, b.face); });
  const auto is_same = [](const Crossing& a, const Crossing& b) { return b.at - a.at < 1e-9; };
  found.erase(std::unique(found.begin(), found.end(), is_same), found.end());
}

void Solid::faces_in(const Aabb& box, std::vector<std::uint32_t>& faces) const {
  std::array<std::uint32_t, 64> open{};
  std::size_t count = 1;
  while (count > 0) {
    const Node& node = nodes_[open[--count]];
    if (!node.box.overlaps(box)) continue;
    if (node.count == 0 && !faces_.empty()) {
      open[count++] = node.first;
      open[count++] = node.first + 1;
      continue;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      if (box_of_face(order_[i]).overlaps(box)) faces.push_back(order_[i]);
    }
  }
}

}  // namespace sim
