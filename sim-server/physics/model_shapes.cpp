// The shapes of a model: made from its collisions, with the friction of their surfaces.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "physics/model_instance.h"

namespace sim {
namespace {

// Wider than high is no wheel but a drum, which stands on its whole width.
bool is_wheel(const ModelDef& model, const LinkDef& link, const CollisionDef& collision) {
  const auto* cylinder = std::get_if<CylinderShape>(&collision.geometry);
  if (cylinder == nullptr || cylinder->length > 2 * cylinder->radius) return false;
  const Eigen::Isometry3d pose = link.pose * collision.pose;
  return std::any_of(model.joints.begin(), model.joints.end(), [&](const JointDef& joint) {
    if (joint.kind != JointDef::Kind::revolute && joint.kind != JointDef::Kind::continuous && joint.kind != JointDef::Kind::revolute2)
      return false;
    if (joint.child != link.name && joint.parent != link.name) return false;
    const Eigen::Vector3d axis = joint.pose_in_model.linear() * joint.axes.back().xyz;
    const Eigen::Vector3d away = pose.translation() - joint.pose_in_model.translation();
    return axis.cross(pose.linear().col(2)).norm() < 0.02 && axis.cross(away).norm() < 0.05 * cylinder->radius;
  });
}

base::Result<ShapeInstance> make_or_refuse(const CollisionDef& collision, ShapeStore& store) {
  try {
    return make_shape(collision, store);
  } catch (const std::bad_alloc&) {
    return base::Error{fmt::format("a {} is too large for the memory", kind_of(collision.geometry))};
  }
}

}  // namespace

void ModelInstance::make_shapes(ShapeStore& store, std::vector<std::string>& lost) {
  const ModelDef& model = *blueprint_->model;
  for (std::uint32_t l = 0; l < model.links.size(); ++l) {
    const auto assembly = blueprint_->assembly_of_link[l];
    const bool is_anchored = blueprint_->assemblies[assembly].is_anchored;
    for (std::uint32_t c = 0; c < model.links[l].collisions.size(); ++c) {
      const CollisionDef& collision = model.links[l].collisions[c];
      if (!is_anchored &&
          (std::holds_alternative<PlaneShape>(collision.geometry) || std::holds_alternative<HeightmapShape>(collision.geometry))) {
        lost.push_back(fmt::format("model {}: collision {}::{}: a {} cannot move, it does not collide", model.name, model.links[l].name,
                                   collision.name, kind_of(collision.geometry)));
        continue;
      }
      auto shape = make_or_refuse(collision, store);
      if (!shape) {
        lost.push_back(fmt::format("model {}: collision {}::{}: {}; it does not collide", model.name, model.links[l].name, collision.name,
                                   shape.error().message));
        continue;
      }
      shape->link = {id_, l};
      shape->collision = c;
      shape->assembly = assembly;
      shape->is_wheel = !is_anchored && is_wheel(model, model.links[l], collision);
      if (!collision.surface.friction_link.empty()) add_direction(*shape, collision.surface);
      if (!model.slips.empty()) add_slip(*shape);
      shape_in_body_.push_back(blueprint_->link_in_body[l] * collision.pose * geom_in_collision(collision.geometry));
      shapes_.push_back(std::move(*shape));
    }
  }
}

// A direction in the frame of another link, which it turns with.
void ModelInstance::add_direction(ShapeInstance& shape, const SurfaceDef& surface) {
  const ModelDef& model = *blueprint_->model;
  for (std::size_t l = 0; l < model.links.size(); ++l) {
    if (model.links[l].name != surface.friction_link) continue;
    shape.friction_frame = std::make_unique<FrictionFrame>();
    shape.friction_frame->assembly = blueprint_->assembly_of_link[l];
    shape.friction_frame->direction = blueprint_->link_in_body[l].linear() * *surface.friction_direction;
    return;
  }
}

void ModelInstance::add_slip(ShapeInstance& shape) {
  const ModelDef& model = *blueprint_->model;
  const LinkDef& link = model.links[shape.link.link];
  const auto def = std::find_if(model.slips.begin(), model.slips.end(), [&](const WheelSlipDef& one) { return one.link == link.name; });
  const auto joint = std::find_if(model.joints.begin(), model.joints.end(),
                                  [&](const JointDef& one) { return one.child == link.name && !one.axes.empty(); });
  if (def == model.slips.end() || joint == model.joints.end()) return;
  shape.slip = std::make_unique<WheelSlip>();
  WheelSlip& slip = *shape.slip;
  slip.carrier = assembly_of(joint->parent);
  const Eigen::Vector3d axle = joint->pose_in_model.linear() * joint->axes.back().xyz;
  slip.axle = blueprint_->link_in_body[shape.link.link].linear() * link.pose.linear().transpose() * axle;
  slip.lateral = def->lateral * def->radius / def->normal_force;
  slip.longitudinal = def->longitudinal * def->radius / def->normal_force;
  const auto& first = link.collisions[shape.collision].surface.friction_direction;
  slip.is_rolling_first = first && shape.is_wheel && std::abs(first->z()) <= 0.7;
}

// After the bodies were made.
void ModelInstance::find_bodies_of(ShapeInstance& shape) const {
  if (FrictionFrame* frame = shape.friction_frame.get()) frame->body = bodies_[frame->assembly].id();
  if (WheelSlip* slip = shape.slip.get()) {
    slip->wheel = bodies_[shape.assembly].id();
    slip->carrier_body = slip->carrier < 0 ? nullptr : bodies_[static_cast<std::size_t>(slip->carrier)].id();
  }
}

}  // namespace sim
