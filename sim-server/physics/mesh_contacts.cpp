#include "physics/mesh_contacts.h"

#include <algorithm>
#include <cmath>

#include "physics/contact_surface.h"

namespace sim {
namespace {

constexpr std::size_t max_faces = 20000;  // that one mesh may have in the box of the other; of more, some are passed over
constexpr double along_face = 0.3;        // cosine up to which an edge lies along a face

// A place of one mesh inside the other, in the other's frame; the normal is the way out.
struct Touch {
  Eigen::Vector3d place, normal;
  double depth = 0;
};

Eigen::Isometry3d pose_of(dGeomID geom) {
  dQuaternion q;
  dGeomGetQuaternion(geom, q);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = ode::quaternion(q).toRotationMatrix();
  pose.translation() = ode::vector(dGeomGetPosition(geom));
  return pose;
}

Aabb moved(const Aabb& box, const Eigen::Isometry3d& by) {
  Aabb result;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d p =
        by * Eigen::Vector3d((corner & 1) != 0 ? box.high.x() : box.low.x(), (corner & 2) != 0 ? box.high.y() : box.low.y(),
                             (corner & 4) != 0 ? box.high.z() : box.low.z());
    result.extend({p, p});
  }
  return result;
}

void sort_out(std::vector<std::uint32_t>& numbers) {
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
}

// Feels with the corners and edges of one mesh in the other, all in the other's frame.
class Feeler {
 public:
  Feeler(const Solid& mine, const Solid& other, const Eigen::Isometry3d& to_other, double reach, std::vector<Touch>& touches)
      : mine_(mine),
        other_(other),
        to_other_(to_other),
        reach_(other.is_closed() ? reach : std::min(reach, Solid::open_depth)),
        touches_(touches) {}

  // `common` is where both are, in my frame.
  void feel(const Aabb& common) {
    std::vector<std::uint32_t> faces, corners, edges;
    mine_.faces_in(common, faces);
    std::sort(faces.begin(), faces.end());
    const std::size_t stride = faces.size() / max_faces + 1;
    for (std::size_t i = 0; i < faces.size(); i += stride) {
      const Solid::Face& face = mine_.faces()[faces[i]];
      corners.insert(corners.end(), face.corners.begin(), face.corners.end());
      edges.insert(edges.end(), face.edges.begin(), face.edges.end());
    }
    sort_out(corners);
    sort_out(edges);
    for (const auto corner : corners) feel_corner(mine_.corners()[corner]);
    for (const auto edge : edges) {
      if (mine_.edges()[edge].is_sharp) feel_edge(mine_.edges()[edge]);
    }
  }

 private:
  // Out of the other, if it is inside: at the nearest face that looks against `outward`, so that what is thin is not pulled through.
  std::optional<Solid::Nearest> way_out(const Eigen::Vector3d& place, const Eigen::Vector3d& outward) const {
    constexpr double facing = -0.1;
    if (!other_.may_contain(place)) return std::nullopt;
    auto nearest = other_.nearest(place, reach_);
    if (!nearest || !nearest->is_inside) return std::nullopt;
    if (nearest->normal.dot(outward) > facing) {
      const auto against = other_.nearest(place, reach_, &outward);
      if (against && against->is_inside) nearest = against;
    }
    if (nearest->distance > 1e-6) nearest->normal = (nearest->place - place) / nearest->distance;
    return nearest;
  }

  void add(const Eigen::Vector3d& place, const Eigen::Vector3d& normal, double depth) {
    if (depth > 0 && depth < reach_) touches_.push_back({place, normal, depth});
  }

  void feel_corner(const Solid::Corner& corner) {
    const Eigen::Vector3d place = to_other_ * corner.place;
    if (const auto out = way_out(place, to_other_.linear() * corner.outward)) add(place, out->normal, out->distance);
  }

  void feel_edge(const Solid::Edge& edge) {
    const Eigen::Vector3d from = to_other_ * mine_.corners()[edge.a].place, to = to_other_ * mine_.corners()[edge.b].place;
    other_.crossings(from, to, crossings_);
    for (std::size_t i = 0; i <= crossings_.size() && !crossings_.empty(); ++i) {
      const Solid::Crossing* enter = i > 0 ? &crossings_[i - 1] : nullptr;
      const Solid::Crossing* leave = i < crossings_.size() ? &crossings_[i] : nullptr;
      const double start = enter != nullptr ? enter->at : 0, end = leave != nullptr ? leave->at : 1;
      if (!(end - start > 1e-9)) continue;
      const Eigen::Vector3d middle = from + (start + end) / 2 * (to - from);
      const auto out = way_out(middle, to_other_.linear() * edge.outward);
      if (!out) continue;
      if (std::abs(out->normal.dot((to - from).normalized())) < along_face) {
        for (const auto* crossing : {enter, leave}) {
          if (crossing == nullptr) continue;
          const Eigen::Vector3d place = from + crossing->at * (to - from);
          add(place, out->normal, out->normal.dot(out->place - place));
        }
      } else if (enter != nullptr && leave != nullptr) {
        cross_edge(from, to, *enter, *leave);
      }
    }
  }

  // The edge cuts off a corner between two faces: out across it and across the edge of the other.
  void cross_edge(const Eigen::Vector3d& from, const Eigen::Vector3d& to, const Solid::Crossing& enter, const Solid::Crossing& leave) {
    const Eigen::Vector3d &first = other_.faces()[enter.face].normal, &second = other_.faces()[leave.face].normal;
    const Eigen::Vector3d line = first.cross(second);
    const Eigen::Vector3d p = from + enter.at * (to - from), q = from + leave.at * (to - from), middle = (p + q) / 2;
    if (line.norm() < 0.1) return;
    Eigen::Vector3d normal = (to - from).cross(line);
    if (!(normal.norm() > 1e-9)) return;
    normal.normalize();
    if (normal.dot(first + second) < 0) normal = -normal;
    Eigen::Matrix3d planes;
    planes << first.transpose(), second.transpose(), line.transpose();
    const Eigen::Vector3d edge = planes.inverse() * Eigen::Vector3d(first.dot(p), second.dot(q), line.dot(middle));
    add(middle, normal, normal.dot(edge - p));
  }

  const Solid &mine_, &other_;
  const Eigen::Isometry3d to_other_;
  const double reach_;
  std::vector<Touch>& touches_;
  std::vector<Solid::Crossing> crossings_;
};

// Of those with about the same normal the four that span the patch; the deepest patches first.
int choose(const std::vector<Touch>& touches, int most, dContactGeom* contacts) {
  constexpr double same = 0.98;
  std::vector<std::vector<dContactGeom>> patches;
  for (const Touch& touch : touches) {
    dContactGeom contact{};
    for (int k = 0; k < 3; ++k) contact.pos[k] = touch.place[k], contact.normal[k] = touch.normal[k];
    contact.depth = touch.depth;
    const auto patch =
        std::find_if(patches.begin(), patches.end(), [&](const auto& p) { return ode::vector(p.front().normal).dot(touch.normal) > same; });
    patch == patches.end() ? patches.push_back({contact}) : patch->push_back(contact);
  }
  const auto depth = [](const auto& patch) {
    return std::max_element(patch.begin(), patch.end(), [](const auto& a, const auto& b) { return a.depth < b.depth; })->depth;
  };
  std::stable_sort(patches.begin(), patches.end(), [&](const auto& a, const auto& b) { return depth(a) > depth(b); });
  int count = 0;
  for (auto& patch : patches) {
    const int kept = reduce(patch.data(), static_cast<int>(patch.size()));
    for (int i = 0; i < kept && count < most; ++i) contacts[count++] = patch[static_cast<std::size_t>(i)];
  }
  return count;
}

}  // namespace

int collide_meshes(const ShapeInstance& a, const Solid& solid_a, const ShapeInstance& b, const Solid& solid_b, int most,
                   dContactGeom* contacts) {
  const Aabb common{a.box.low.cwiseMax(b.box.low), a.box.high.cwiseMin(b.box.high)};
  if (common.is_empty()) return 0;
  const Eigen::Isometry3d pose_a = pose_of(a.geom.id()), pose_b = pose_of(b.geom.id());
  const Eigen::Isometry3d a_to_b = pose_b.inverse() * pose_a;
  const double reach = 0.5 * std::min((a.box.high - a.box.low).norm(), (b.box.high - b.box.low).norm());
  std::vector<Touch> in_b, in_a;
  Feeler(solid_a, solid_b, a_to_b, reach, in_b).feel(moved(common, pose_a.inverse()));
  Feeler(solid_b, solid_a, a_to_b.inverse(), reach, in_a).feel(moved(common, pose_b.inverse()));
  std::vector<Touch> touches;
  for (const Touch& t : in_b) touches.push_back({pose_b * t.place, pose_b.linear() * t.normal, t.depth});
  for (const Touch& t : in_a) touches.push_back({pose_a * t.place, -(pose_a.linear() * t.normal), t.depth});
  const int count = choose(touches, most, contacts);
  for (int i = 0; i < count; ++i) contacts[i].g1 = a.geom.id(), contacts[i].g2 = b.geom.id();
  return count;
}

}  // namespace sim
