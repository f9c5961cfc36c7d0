#include "physics/blueprint.h"

#include <spdlog/fmt/fmt.h>

#include <numeric>
#include <optional>

#include "base/text.h"

namespace sim {
namespace {

std::optional<std::uint32_t> index_of_link(const ModelDef& model, const std::string& name) {
  for (std::uint32_t i = 0; i < model.links.size(); ++i) {
    if (model.links[i].name == name) return i;
  }
  return std::nullopt;
}

// A fixed joint that measures its load stays a joint.
bool is_weld(const JointDef& joint) { return joint.kind == JointDef::Kind::fixed && !joint.provide_feedback && joint.sensors.empty(); }

std::uint32_t root(std::vector<std::uint32_t>& parents, std::uint32_t i) {
  while (parents[i] != i) i = parents[i] = parents[parents[i]];
  return i;
}

bool is_sound(const LinkDef& link) {
  return link.pose.matrix().allFinite() && std::isfinite(link.mass) && link.mass > 0 && link.center_of_mass.allFinite() &&
         link.inertia.allFinite() && (link.inertia.ldlt().vectorD().array() > 0).all();
}

bool is_sound(const GeometryDef& geometry) {
  const auto positive = [](double v) { return std::isfinite(v) && v > 0; };
  if (const auto* s = std::get_if<BoxShape>(&geometry)) return positive(s->size.minCoeff()) && s->size.allFinite();
  if (const auto* s = std::get_if<SphereShape>(&geometry)) return positive(s->radius);
  if (const auto* s = std::get_if<CylinderShape>(&geometry)) return positive(s->radius) && positive(s->length);
  if (const auto* s = std::get_if<CapsuleShape>(&geometry)) return positive(s->radius) && positive(s->length);
  if (const auto* s = std::get_if<EllipsoidShape>(&geometry)) return positive(s->radii.minCoeff()) && s->radii.allFinite();
  if (const auto* s = std::get_if<PlaneShape>(&geometry)) return s->normal.allFinite() && s->normal.norm() > 0.5;
  if (const auto* s = std::get_if<MeshShape>(&geometry)) return s->scale.allFinite() && s->scale.cwiseAbs().minCoeff() > 0;
  if (const auto* s = std::get_if<HeightmapShape>(&geometry)) return s->size.allFinite() && positive(s->size.head<2>().minCoeff());
  if (const auto* s = std::get_if<PolylineShape>(&geometry)) return positive(s->height);
  return false;
}

base::Result<void> check(const ModelDef& model) {
  if (!model.pose.matrix().allFinite()) return base::Error{fmt::format("model {}: pose is not finite", model.name)};
  for (const auto& link : model.links) {
    if (!is_sound(link))
      return base::Error{fmt::format("model {}: link {}: pose, mass or inertia cannot be simulated", model.name, link.name)};
    for (const auto& collision : link.collisions) {
      if (!collision.pose.matrix().allFinite() || !is_sound(collision.geometry)) {
        return base::Error{
            fmt::format("model {}: collision {}::{}: pose or size cannot be simulated", model.name, link.name, collision.name)};
      }
    }
  }
  for (const auto& joint : model.joints) {
    bool is_finite = joint.pose_in_model.matrix().allFinite();
    for (const auto& axis : joint.axes) is_finite = is_finite && axis.xyz.allFinite() && axis.xyz.norm() > 0.5;
    if (!is_finite) return base::Error{fmt::format("model {}: joint {}: pose or axis is not finite", model.name, joint.name)};
  }
  return {};
}

void add_masses(const ModelDef& model, Blueprint& blueprint, Assembly& assembly) {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (const auto i : assembly.links) {
    const LinkDef& link = model.links[i];
    assembly.mass += link.mass;
    center += link.mass * (link.pose * link.center_of_mass);
  }
  center /= assembly.mass;
  assembly.in_model = model.links[assembly.links.front()].pose;
  assembly.in_model.translation() = center;
  const Eigen::Matrix3d to_body = assembly.in_model.linear().transpose();
  assembly.inertia.setZero();
  assembly.has_gravity = false;
  double damped_mass = 0;
  for (const auto i : assembly.links) {
    const LinkDef& link = model.links[i];
    const Eigen::Matrix3d rotation = to_body * link.pose.linear();
    const Eigen::Vector3d arm = to_body * (link.pose * link.center_of_mass - center);
    assembly.inertia += rotation * link.inertia * rotation.transpose() +
                        link.mass * (arm.squaredNorm() * Eigen::Matrix3d::Identity() - arm * arm.transpose());
    assembly.has_gravity = assembly.has_gravity || link.gravity;
    assembly.is_kinematic = assembly.is_kinematic || link.kinematic;
    damped_mass += link.mass * link.linear_damping;
    assembly.angular_damping = std::max(assembly.angular_damping, link.angular_damping);
    blueprint.link_in_body[i] = assembly.in_model.inverse() * link.pose;
  }
  assembly.linear_damping = damped_mass / assembly.mass;
  assembly.inertia = (0.5 * (assembly.inertia + assembly.inertia.transpose())).eval();
}

}  // namespace

base::Result<std::shared_ptr<const Blueprint>> Blueprint::of(std::shared_ptr<const ModelDef> model_pointer) {
  const ModelDef& model = *model_pointer;
  if (const auto checked = check(model); !checked) return checked.error();
  auto blueprint = std::make_shared<Blueprint>();
  blueprint->model = std::move(model_pointer);
  const auto count = static_cast<std::uint32_t>(model.links.size());
  std::vector<std::uint32_t> parents(count);
  std::iota(parents.begin(), parents.end(), 0U);
  std::vector<bool> anchored(count, model.is_static);
  for (std::uint32_t j = 0; j < model.joints.size(); ++j) {
    const JointDef& joint = model.joints[j];
    const auto parent = index_of_link(model, joint.parent), child = index_of_link(model, joint.child);
    if (!is_weld(joint)) {
      blueprint->joints.push_back(j);
      if (!parent || !child) blueprint->is_joined_to_world = true;
    } else if (parent && child) {
      const auto a = root(parents, *parent), b = root(parents, *child);
      parents[std::max(a, b)] = std::min(a, b);
    } else if (parent || child) {
      anchored[parent ? *parent : *child] = true;
    }
    if (joint.kind == JointDef::Kind::screw) {
      blueprint->notes.push_back(
          fmt::format("model {}: joint {}: a screw is simulated as a prismatic joint, it does not turn", model.name, joint.name));
    }
  }
  blueprint->assembly_of_link.resize(count);
  blueprint->link_in_body.resize(count, Eigen::Isometry3d::Identity());
  std::vector<std::optional<std::uint32_t>> assembly_of_root(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    auto& slot = assembly_of_root[root(parents, i)];
    if (!slot) {
      slot = static_cast<std::uint32_t>(blueprint->assemblies.size());
      blueprint->assemblies.emplace_back();
    }
    blueprint->assembly_of_link[i] = *slot;
    blueprint->assemblies[*slot].links.push_back(i);
    if (anchored[i]) blueprint->assemblies[*slot].is_anchored = true;
  }
  blueprint->is_static = true;
  for (auto& assembly : blueprint->assemblies) {
    add_masses(model, *blueprint, assembly);
    if (!assembly.is_anchored) blueprint->is_static = false;
  }
  blueprint->canonical = index_of_link(model, model.canonical_link).value_or(0);
  return std::shared_ptr<const Blueprint>(std::move(blueprint));
}

}  // namespace sim
