#include "world/world_def.h"

#include <numbers>

namespace sim {

std::string_view kind_of(const GeometryDef& geometry) {
  static constexpr std::array<std::string_view, std::variant_size_v<GeometryDef>> words{
      "box", "sphere", "cylinder", "capsule", "ellipsoid", "plane", "mesh", "heightmap", "polyline", "cone"};
  return words[geometry.index()];
}

std::optional<SolidProperties> solid_properties(const GeometryDef& geometry) {
  constexpr double pi = std::numbers::pi;
  const auto box_like = [](double volume, const Eigen::Vector3d& squares, double divisor) {
    return SolidProperties{
        volume, volume / divisor * Eigen::Vector3d(squares.y() + squares.z(), squares.x() + squares.z(), squares.x() + squares.y())};
  };
  if (const auto* box = std::get_if<BoxShape>(&geometry)) return box_like(box->size.prod(), box->size.cwiseAbs2(), 12);
  if (const auto* ball = std::get_if<SphereShape>(&geometry)) {
    return box_like(4.0 / 3 * pi * ball->radius * ball->radius * ball->radius, Eigen::Vector3d::Constant(ball->radius * ball->radius), 5);
  }
  if (const auto* egg = std::get_if<EllipsoidShape>(&geometry))
    return box_like(4.0 / 3 * pi * egg->radii.prod(), egg->radii.cwiseAbs2(), 5);
  if (const auto* can = std::get_if<CylinderShape>(&geometry)) {
    const double r2 = can->radius * can->radius, volume = pi * r2 * can->length;
    const double side = volume * (3 * r2 + can->length * can->length) / 12;
    return SolidProperties{volume, {side, side, volume * r2 / 2}};
  }
  if (const auto* pill = std::get_if<CapsuleShape>(&geometry)) {
    const double r = pill->radius, r2 = r * r, l = pill->length;
    const double tube = pi * r2 * l, ends = 4.0 / 3 * pi * r2 * r;
    const double side = tube * (3 * r2 + l * l) / 12 + ends * (0.4 * r2 + l * l / 4 + 3.0 / 8 * l * r);
    return SolidProperties{tube + ends, {side, side, tube * r2 / 2 + ends * 0.4 * r2}};
  }
  return std::nullopt;
}

Eigen::Vector3d half_size_of(const GeometryDef& geometry) {
  const auto upright = [](double radius, double half) { return Eigen::Vector3d(radius, radius, half); };
  if (const auto* box = std::get_if<BoxShape>(&geometry)) return box->size / 2;
  if (const auto* ball = std::get_if<SphereShape>(&geometry)) return Eigen::Vector3d::Constant(ball->radius);
  if (const auto* egg = std::get_if<EllipsoidShape>(&geometry)) return egg->radii;
  if (const auto* can = std::get_if<CylinderShape>(&geometry)) return upright(can->radius, can->length / 2);
  if (const auto* cone = std::get_if<ConeShape>(&geometry)) return upright(cone->radius, cone->length / 2);
  if (const auto* pill = std::get_if<CapsuleShape>(&geometry)) return upright(pill->radius, pill->length / 2 + pill->radius);
  return Eigen::Vector3d::Zero();
}

Eigen::AlignedBox3d box_of(const ModelDef& model, const Eigen::Isometry3d& pose) {
  Eigen::AlignedBox3d box;
  const auto extend = [&](const LinkDef& link, const auto& shapes) {
    for (const auto& shape : shapes) {
      const Eigen::Isometry3d place = pose * link.pose * shape.pose;
      const Eigen::Vector3d reach = place.linear().cwiseAbs() * half_size_of(shape.geometry);
      box.extend((place.translation() - reach).eval());
      box.extend((place.translation() + reach).eval());
    }
  };
  for (const auto& link : model.links) extend(link, link.collisions);
  if (!box.isEmpty()) return box;
  for (const auto& link : model.links) extend(link, link.visuals);
  return box;
}

std::string_view to_text(JointDef::Kind kind) {
  switch (kind) {
    case JointDef::Kind::fixed:
      return "fixed";
    case JointDef::Kind::revolute:
      return "revolute";
    case JointDef::Kind::continuous:
      return "continuous";
    case JointDef::Kind::prismatic:
      return "prismatic";
    case JointDef::Kind::ball:
      return "ball";
    case JointDef::Kind::universal:
      return "universal";
    case JointDef::Kind::revolute2:
      return "revolute2";
    case JointDef::Kind::screw:
      return "screw";
    case JointDef::Kind::gearbox:
      return "gearbox";
  }
  return "unknown";
}

const LinkDef* ModelDef::link(std::string_view link_name) const {
  for (const LinkDef& link : links) {
    if (link.name == link_name) return &link;
  }
  return nullptr;
}

const JointDef* ModelDef::joint(std::string_view joint_name) const {
  for (const JointDef& joint : joints) {
    if (joint.name == joint_name) return &joint;
  }
  return nullptr;
}

const ModelDef* WorldDef::model(std::string_view model_name) const {
  for (const ModelDef& model : models) {
    if (model.name == model_name) return &model;
  }
  return nullptr;
}

std::string Finding::text() const {
  if (file.empty()) return message;
  return line > 0 ? file + ":" + std::to_string(line) + ": " + message : file + ": " + message;
}

}  // namespace sim
