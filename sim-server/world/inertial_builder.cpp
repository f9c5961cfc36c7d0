#include "world/inertial_builder.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "base/text.h"
#include "world/repairs.h"
#include "world/shape_inertia.h"
#include "world/xml_file.h"
#include "world/xml_values.h"

namespace sim {
namespace {

constexpr double smallest_mass = 1e-9;
constexpr double largest_mass = 1e12;

}  // namespace

Eigen::Matrix3d repaired_inertia(const Eigen::Matrix3d& inertia, double mass, std::string& why) {
  const Eigen::Matrix3d small_ball = Eigen::Matrix3d::Identity() * (0.4 * mass * 0.01);
  if (!inertia.allFinite() || inertia.cwiseAbs().maxCoeff() > 1e15) {
    why = "is not finite";
    return small_ball;
  }
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(inertia);
  Eigen::Vector3d moments = solver.eigenvalues();  // ascending
  if (!(moments(2) > 0)) {
    why = "is not positive definite";
    return small_ball;
  }
  // A body with a smaller radius of gyration than 0.03 mm is turned too fast by any force beside its middle.
  const double smallest = std::max(1e-9 * mass, 1e-12), floor = std::max(1e-6 * moments(2), smallest);
  if (moments(0) < floor) {
    why = moments(0) > 1e-6 * moments(2) ? "is too small for its mass" : "is not positive definite";
    moments = moments.cwiseMax(floor);
  }
  const double excess = moments(2) - moments(0) - moments(1);
  if (excess > 0.01 * moments(2)) {
    if (why.empty()) why = "violates the triangle inequality of principal moments";
    moments(0) += excess / 2;
    moments(1) += excess / 2;
  } else if (why.empty()) {
    return inertia;
  }
  return solver.eigenvectors() * moments.asDiagonal() * solver.eigenvectors().transpose();
}

void take_automatic_inertia(LinkDef& link, pugi::xml_node inertial, BuildContext& context) {
  constexpr double water = 1000;  // [kg/m^3]
  const double usual = inertial.attribute(density_mark).as_double(water);
  double mass = 0;
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  std::vector<std::pair<Eigen::Isometry3d, SolidProperties>> parts;
  std::map<std::string, pugi::xml_node, std::less<>> nodes;
  for (pugi::xml_node child : inertial.parent().children("collision")) nodes.emplace(child.attribute("name").value(), child);
  for (const CollisionDef& collision : link.collisions) {
    const pugi::xml_node node = nodes[collision.name];
    const double density = node.attribute(density_mark).as_double(usual);
    const std::optional<SolidProperties> solid = solid_properties(collision.geometry);
    if (!solid || !(density > 0 && density < 1e9)) {
      context.complaints.warn(node, "automatic inertia cannot weigh " + describe_in_context(node) + "; it is left out of account");
      continue;
    }
    parts.emplace_back(collision.pose, SolidProperties{solid->volume * density, solid->moments * density});
    mass += parts.back().second.volume;
    moment += parts.back().second.volume * collision.pose.translation();
  }
  if (!(mass >= smallest_mass && mass <= largest_mass)) {
    context.complaints.warn(inertial,
                            "automatic inertia of " + describe_in_context(inertial.parent()) + " has nothing to weigh; 1 kg is taken");
    return;
  }
  link.mass = mass;
  link.center_of_mass = moment / mass;
  link.inertia.setZero();
  for (const auto& [pose, solid] : parts) {
    const Eigen::Vector3d arm = pose.translation() - link.center_of_mass;
    link.inertia += pose.linear() * solid.moments.asDiagonal() * pose.linear().transpose();
    link.inertia += solid.volume * (arm.squaredNorm() * Eigen::Matrix3d::Identity() - arm * arm.transpose());
  }
}

void build_inertial(LinkDef& link, pugi::xml_node node, bool is_static, BuildContext& context) {
  if (!node) return;
  const pugi::xml_node mass = node.child("mass");
  const std::optional<double> written = number_at(node, "mass");
  if (mass && mass.first_child() && !(written && *written >= smallest_mass && *written <= largest_mass)) {
    if (!is_static) {
      context.complaints.warn(mass, "mass of " + describe_in_context(node.parent()) + " must be a positive number, got " +
                                        base::in_quotes(text_of(mass)) + "; 1 kg is taken");
    }
  } else {
    link.mass = written.value_or(1);
  }
  const Eigen::Isometry3d pose = pose_at(node, "pose");
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Identity();
  if (const pugi::xml_node values = node.child("inertia")) {
    const auto entry = [&](const char* key, double fallback) {
      const std::optional<std::vector<double>> n = parse_numbers(text_at(values, key));
      return n && n->size() == 1 ? n->front() : fallback;
    };
    const double xy = entry("ixy", 0), xz = entry("ixz", 0), yz = entry("iyz", 0);
    inertia << entry("ixx", 1), xy, xz, xy, entry("iyy", 1), yz, xz, yz, entry("izz", 1);
  }
  std::string why;
  inertia = repaired_inertia(inertia, link.mass, why);
  if (!why.empty() && !is_static)
    context.complaints.warn(node, "inertia of " + describe_in_context(node.parent()) + " " + why + "; it is corrected");
  link.center_of_mass = pose.translation();
  link.inertia = pose.linear() * inertia * pose.linear().transpose();
  if (const pugi::xml_attribute added = node.attribute(added_mass_mark)) {
    Eigen::Matrix<double, 6, 6> turn = Eigen::Matrix<double, 6, 6>::Zero();
    turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = pose.linear();
    link.added_mass = turn * symmetric_matrix(added.value()) * turn.transpose();
  }
}

}  // namespace sim
