#include "physics/blueprint.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>

#include "base/text.h"
#include "physics/joined_sets.h"

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

bool is_sound(const LinkDef& link) {
  return link.pose.matrix().allFinite() && (!link.start_pose || link.start_pose->matrix().allFinite()) && link.start_linear.allFinite() &&
         link.start_angular.allFinite() && std::isfinite(link.mass) && link.mass > 0 && link.center_of_mass.allFinite() &&
         link.inertia.allFinite() && (link.inertia.ldlt().vectorD().array() > 0).all();
}

bool is_sound(const GeometryDef& geometry) {
  const auto positive = [](double v) { return std::isfinite(v) && v > 0; };
  if (const auto* s = std::get_if<BoxShape>(&geometry)) return positive(s->size.minCoeff()) && s->size.allFinite();
  if (const auto* s = std::get_if<SphereShape>(&geometry)) return positive(s->radius);
  if (const auto* s = std::get_if<CylinderShape>(&geometry)) return positive(s->radius) && positive(s->length);
  if (const auto* s = std::get_if<CapsuleShape>(&geometry)) return positive(s->radius) && positive(s->length);
  if (const auto* s = std::get_if<ConeShape>(&geometry)) return positive(s->radius) && positive(s->length);
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
    for (const auto& axis : joint.axes)
      is_finite = is_finite && axis.xyz.allFinite() && axis.xyz.norm() > 0.5 && std::isfinite(axis.initial_position);
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
    if (link.enable_wind) assembly.wind_mass += link.mass;
    damped_mass += link.mass * link.linear_damping;
    assembly.angular_damping = std::max(assembly.angular_damping, link.angular_damping);
    blueprint.link_in_body[i] = assembly.in_model.inverse() * link.pose;
  }
  assembly.linear_damping = damped_mass / assembly.mass;
  assembly.inertia = (0.5 * (assembly.inertia + assembly.inertia.transpose())).eval();
}

void note_limits_of_simulation(const ModelDef& model, const JointDef& joint, std::vector<std::string>& notes) {
  const auto note = [&](const char* what) { notes.push_back(fmt::format("model {}: joint {}: {}", model.name, joint.name, what)); };
  if (joint.kind == JointDef::Kind::revolute2 && (joint.suspension_cfm || joint.suspension_erp) && std::isfinite(joint.axes[1].upper)) {
    note("limits of the second axis are not kept where the first one has a suspension");
  }
  if (joint.kind != JointDef::Kind::gearbox) return;
  const auto [first, second] = gear_anchors(model, joint);
  const Eigen::Vector3d a = joint.pose_in_model.linear() * joint.axes[0].xyz, b = joint.pose_in_model.linear() * joint.axes[1].xyz;
  const bool is_one_line = a.cross(b).norm() < 1e-3 && a.cross(second - first).norm() < 1e-6;
  if (is_one_line && std::abs(1 + (a.dot(b) < 0 ? -1 : 1) * joint.gearbox_ratio) > 1e-9) {
    note("a gearbox between wheels on one axis is not simulated; they turn freely");
  }
}

// How the child of a joint stands at its initial position, seen from where the file has it; in the model.
Eigen::Isometry3d initial_motion(const JointDef& joint) {
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  for (const auto& axis : joint.axes) {
    const double q = axis.initial_position;
    if (joint.kind == JointDef::Kind::prismatic) {
      motion.translate(q * axis.xyz);
    } else {
      motion.rotate(Eigen::AngleAxisd(q, axis.xyz));
      if (joint.kind == JointDef::Kind::screw) motion.pretranslate(q * joint.thread_pitch / (2 * std::numbers::pi) * axis.xyz);
    }
  }
  return joint.pose_in_model * motion * joint.pose_in_model.inverse();
}

void move_to_initial_positions(const ModelDef& model, Blueprint& blueprint) {
  struct Move {
    std::vector<bool> moved;  // by assembly
    std::ptrdiff_t count = 0;
    Eigen::Isometry3d motion;
  };
  std::vector<Move> moves;
  const auto assembly_of = [&](const std::string& name) -> std::optional<std::uint32_t> {
    const auto link = index_of_link(model, name);
    return link ? std::optional(blueprint.assembly_of_link[*link]) : std::nullopt;
  };
  for (const auto j : blueprint.joints) {
    const JointDef& joint = model.joints[j];
    const auto child = assembly_of(joint.child), parent = assembly_of(joint.parent);
    const bool is_moved = std::any_of(joint.axes.begin(), joint.axes.end(), [](const AxisDef& axis) { return axis.initial_position != 0; });
    if (!is_moved || !child || joint.kind == JointDef::Kind::gearbox) continue;
    Move move{std::vector<bool>(blueprint.assemblies.size()), 0, initial_motion(joint)};
    move.moved[*child] = true;
    for (bool changed = true; changed;) {
      changed = false;
      for (const auto k : blueprint.joints) {
        const auto a = assembly_of(model.joints[k].parent), b = assembly_of(model.joints[k].child);
        if (k == j || !a || !b || move.moved[*a] == move.moved[*b] || model.joints[k].kind == JointDef::Kind::gearbox) continue;
        move.moved[*a] = move.moved[*b] = changed = true;
      }
    }
    move.count = std::count(move.moved.begin(), move.moved.end(), true);
    if (parent && move.moved[*parent]) {
      blueprint.notes.push_back(
          fmt::format("model {}: joint {}: is part of a ring; its initial position is ignored", model.name, joint.name));
      continue;
    }
    moves.push_back(std::move(move));
  }
  // From the tips to the root: what hangs on a joint moves before the joint itself is moved.
  std::stable_sort(moves.begin(), moves.end(), [](const Move& a, const Move& b) { return a.count < b.count; });
  for (const Move& move : moves) {
    for (std::size_t i = 0; i < move.moved.size(); ++i) {
      Assembly& assembly = blueprint.assemblies[i];
      if (move.moved[i]) assembly.moved_at_start = move.motion * assembly.moved_at_start.value_or(Eigen::Isometry3d::Identity());
    }
  }
}

void move_to_saved_places(const ModelDef& model, Blueprint& blueprint) {
  for (Assembly& assembly : blueprint.assemblies) {
    const LinkDef& link = model.links[assembly.links.front()];
    if (link.start_pose) assembly.moved_at_start = *link.start_pose * link.pose.inverse();
    assembly.start_linear = link.start_linear;
    assembly.start_angular = link.start_angular;
  }
}

}  // namespace

std::pair<Eigen::Vector3d, Eigen::Vector3d> gear_anchors(const ModelDef& model, const JointDef& gearbox) {
  const auto anchor = [&](const std::string& name) -> Eigen::Vector3d {
    const JointDef* holder = nullptr;
    for (const JointDef& joint : model.joints) {
      if (joint.axes.size() != 1 || (joint.child != name && joint.parent != name)) continue;
      const std::string& other = joint.child == name ? joint.parent : joint.child;
      if (holder == nullptr || other == gearbox.gearbox_reference) holder = &joint;
    }
    if (holder != nullptr) return holder->pose_in_model.translation();
    const LinkDef* link = model.link(name);
    return link != nullptr ? link->pose * link->center_of_mass : gearbox.pose_in_model.translation();
  };
  return {anchor(gearbox.parent), anchor(gearbox.child)};
}

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
    note_limits_of_simulation(model, joint, blueprint->notes);
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
  move_to_initial_positions(model, *blueprint);
  move_to_saved_places(model, *blueprint);
  blueprint->canonical = index_of_link(model, model.canonical_link).value_or(0);
  blueprint->hydrodynamics = hydrodynamics_of(model, blueprint->left_out, blueprint->notes);
  blueprint->wings = wings_of(model, blueprint->left_out);
  blueprint->airframes = airframes_of(model, blueprint->left_out);
  blueprint->airships = airships_of(model, blueprint->left_out);
  blueprint->hulls = floating_hulls_of(model, blueprint->left_out, blueprint->notes);
  return std::shared_ptr<const Blueprint>(std::move(blueprint));
}

}  // namespace sim
