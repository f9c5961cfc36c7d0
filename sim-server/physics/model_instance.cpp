#include "physics/model_instance.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sim {
namespace {

constexpr double fastest = 5000;  // [m/s], [rad/s]: nothing that is simulated sanely gets there

Aabb box_of(dGeomID geom) {
  dReal b[6];
  dGeomGetAABB(geom, b);
  return {{b[0], b[2], b[4]}, {b[1], b[3], b[5]}};
}

bool has_position(dJointType type) {
  return type == dJointTypeHinge || type == dJointTypeSlider || type == dJointTypeUniversal || type == dJointTypeHinge2;
}

// The body's inertia about an axis in the world.
double inertia_about(dBodyID body, const Eigen::Vector3d& axis) {
  if (body == nullptr || dBodyIsKinematic(body) != 0) return infinite;
  dMass mass;
  dBodyGetMass(body, &mass);
  const Eigen::Vector3d local = ode::quaternion(dBodyGetQuaternion(body)).conjugate() * axis;
  const Eigen::Matrix<double, 3, 4, Eigen::RowMajor> inertia(mass.I);
  return local.dot(inertia.leftCols<3>() * local);
}

}  // namespace

// --- parameters of joints, whatever their type

void set_joint_parameter(dJointID joint, int axis, int base_parameter, double value) {
  const int parameter = axis == 0 ? base_parameter : base_parameter + dParamGroup;
  switch (dJointGetType(joint)) {
    case dJointTypeHinge:
      dJointSetHingeParam(joint, parameter, value);
      break;
    case dJointTypeSlider:
      dJointSetSliderParam(joint, parameter, value);
      break;
    case dJointTypeUniversal:
      dJointSetUniversalParam(joint, parameter, value);
      break;
    case dJointTypeHinge2:
      dJointSetHinge2Param(joint, parameter, value);
      break;
    default:
      break;
  }
}

double joint_rate(dJointID joint, int axis) {
  switch (dJointGetType(joint)) {
    case dJointTypeHinge:
      return dJointGetHingeAngleRate(joint);
    case dJointTypeSlider:
      return dJointGetSliderPositionRate(joint);
    case dJointTypeUniversal:
      return axis == 0 ? dJointGetUniversalAngle1Rate(joint) : dJointGetUniversalAngle2Rate(joint);
    case dJointTypeHinge2:
      return axis == 0 ? dJointGetHinge2Angle1Rate(joint) : dJointGetHinge2Angle2Rate(joint);
    default:
      return 0;
  }
}

double joint_position(dJointID joint, int axis) {
  switch (dJointGetType(joint)) {
    case dJointTypeHinge:
      return dJointGetHingeAngle(joint);
    case dJointTypeSlider:
      return dJointGetSliderPosition(joint);
    case dJointTypeUniversal:
      return axis == 0 ? dJointGetUniversalAngle1(joint) : dJointGetUniversalAngle2(joint);
    case dJointTypeHinge2:
      return axis == 0 ? dJointGetHinge2Angle1(joint) : dJointGetHinge2Angle2(joint);
    default:
      return 0;
  }
}

void add_joint_effort(dJointID joint, int axis, double effort) {
  const double first = axis == 0 ? effort : 0, second = axis == 0 ? 0 : effort;
  switch (dJointGetType(joint)) {
    case dJointTypeHinge:
      dJointAddHingeTorque(joint, effort);
      break;
    case dJointTypeSlider:
      dJointAddSliderForce(joint, effort);
      break;
    case dJointTypeUniversal:
      dJointAddUniversalTorques(joint, first, second);
      break;
    case dJointTypeHinge2:
      dJointAddHinge2Torques(joint, first, second);
      break;
    default:
      break;
  }
}

// --- shapes

base::Result<std::shared_ptr<ShapeStore::Mesh>> ShapeStore::mesh(const GeometryDef& geometry) {
  const auto triangles = triangles_.triangles(geometry);
  if (!triangles) return triangles.error();
  const bool is_cached = std::holds_alternative<MeshShape>(geometry);
  if (const auto found = meshes_.find(triangles->get()); is_cached && found != meshes_.end()) return found->second;
  auto mesh = std::make_shared<Mesh>();
  mesh->vertices.reserve((*triangles)->vertices.size() * 3);
  for (const auto& v : (*triangles)->vertices) mesh->vertices.insert(mesh->vertices.end(), {v.x(), v.y(), v.z()});
  for (const auto& t : (*triangles)->triangles) mesh->indexes.insert(mesh->indexes.end(), {t[0], t[1], t[2]});
  mesh->data = ode::TriMeshData(dGeomTriMeshDataCreate());
  dGeomTriMeshDataBuildDouble(mesh->data.id(), mesh->vertices.data(), 3 * sizeof(double), static_cast<int>(mesh->vertices.size() / 3),
                              mesh->indexes.data(), static_cast<int>(mesh->indexes.size()), 3 * sizeof(dTriIndex));
  dGeomTriMeshDataPreprocess2(mesh->data.id(), 1U << dTRIDATAPREPROCESS_BUILD_FACE_ANGLES, nullptr);
  if (is_cached) meshes_[triangles->get()] = mesh;
  return mesh;
}

base::Result<std::shared_ptr<ShapeStore::Field>> ShapeStore::field(const HeightmapShape& shape) {
  const auto grid = triangles_.heights(shape);
  if (!grid) return grid.error();
  if (const auto found = fields_.find(grid->get()); found != fields_.end()) return found->second;
  auto field = std::make_shared<Field>();
  field->grid = *grid;
  field->data = ode::HeightfieldData(dGeomHeightfieldDataCreate());
  const HeightGrid& g = **grid;
  dGeomHeightfieldDataBuildSingle(field->data.id(), g.heights.data(), 0, g.width, g.depth, g.columns, g.rows, 1, 0, 10, 0);
  const auto [low, high] = std::minmax_element(g.heights.begin(), g.heights.end());
  dGeomHeightfieldDataSetBounds(field->data.id(), *low - 10, *high);
  fields_[grid->get()] = field;
  return field;
}

base::Result<ShapeInstance> ModelInstance::make_shape(const CollisionDef& collision, ShapeStore& shapes) {
  ShapeInstance shape;
  shape.surface = &collision.surface;
  const GeometryDef& geometry = collision.geometry;
  if (const auto* box = std::get_if<BoxShape>(&geometry)) {
    shape.geom = ode::Geom(dCreateBox(nullptr, box->size.x(), box->size.y(), box->size.z()));
  } else if (const auto* sphere = std::get_if<SphereShape>(&geometry)) {
    shape.geom = ode::Geom(dCreateSphere(nullptr, sphere->radius));
  } else if (const auto* cylinder = std::get_if<CylinderShape>(&geometry)) {
    shape.geom = ode::Geom(dCreateCylinder(nullptr, cylinder->radius, cylinder->length));
  } else if (const auto* capsule = std::get_if<CapsuleShape>(&geometry)) {
    shape.geom = ode::Geom(dCreateCapsule(nullptr, capsule->radius, capsule->length));
  } else if (const auto* plane = std::get_if<PlaneShape>(&geometry)) {
    shape.geom = ode::Geom(dCreatePlane(nullptr, plane->normal.x(), plane->normal.y(), plane->normal.z(), 0));
  } else if (const auto* map = std::get_if<HeightmapShape>(&geometry)) {
    auto field = shapes.field(*map);
    if (!field) return field.error();
    shape.geom = ode::Geom(dCreateHeightfield(nullptr, (*field)->data.id(), 1));
    shape.data = *field;
    shape.needs_lock = true;
  } else {
    auto mesh = shapes.mesh(geometry);
    if (!mesh) return mesh.error();
    shape.geom = ode::Geom(dCreateTriMesh(nullptr, (*mesh)->data.id(), nullptr, nullptr, nullptr));
    shape.data = *mesh;
    shape.needs_lock = true;
  }
  return shape;
}

// Pose of the ODE geom in the frame of the collision: ODE's height fields point along y.
static Eigen::Isometry3d geom_in_collision(const GeometryDef& geometry) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  if (const auto* map = std::get_if<HeightmapShape>(&geometry)) {
    pose.translation() = map->position;
    pose.rotate(Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitX()));
  }
  return pose;
}

void ModelInstance::make_shapes(ShapeStore& store, std::vector<std::string>& notes) {
  const ModelDef& model = *blueprint_->model;
  for (std::uint32_t l = 0; l < model.links.size(); ++l) {
    const auto assembly = blueprint_->assembly_of_link[l];
    const bool is_anchored = blueprint_->assemblies[assembly].is_anchored;
    for (std::uint32_t c = 0; c < model.links[l].collisions.size(); ++c) {
      const CollisionDef& collision = model.links[l].collisions[c];
      if (!is_anchored &&
          (std::holds_alternative<PlaneShape>(collision.geometry) || std::holds_alternative<HeightmapShape>(collision.geometry))) {
        notes.push_back(fmt::format("model {}: collision {}::{}: a {} cannot move, it does not collide", model.name, model.links[l].name,
                                    collision.name, kind_of(collision.geometry)));
        continue;
      }
      auto shape = make_shape(collision, store);
      if (!shape) {
        notes.push_back(fmt::format("model {}: collision {}::{}: {}; it does not collide", model.name, model.links[l].name, collision.name,
                                    shape.error().message));
        continue;
      }
      shape->link = {id_, l};
      shape->collision = c;
      shape->assembly = assembly;
      shape_in_body_.push_back(blueprint_->link_in_body[l] * collision.pose * geom_in_collision(collision.geometry));
      shapes_.push_back(std::move(*shape));
    }
  }
}

void ModelInstance::place_anchored() {
  for (std::size_t i = 0; i < shapes_.size(); ++i) {
    ShapeInstance& shape = shapes_[i];
    if (!blueprint_->assemblies[shape.assembly].is_anchored) continue;
    const Eigen::Isometry3d pose = base_ * blueprint_->assemblies[shape.assembly].in_model * shape_in_body_[i];
    if (dGeomGetClass(shape.geom.id()) == dPlaneClass) {
      const auto& plane = std::get<PlaneShape>(blueprint_->model->links[shape.link.link].collisions[shape.collision].geometry);
      const Eigen::Vector3d normal = (pose.linear() * plane.normal).normalized();
      dGeomPlaneSetParams(shape.geom.id(), normal.x(), normal.y(), normal.z(), normal.dot(pose.translation()));
      shape.box = {{-infinite, -infinite, -infinite}, {infinite, infinite, infinite}};
      // Level ground: nothing above it can touch it.
      for (int k = 0; k < 3; ++k) {
        if (normal[k] == 1) shape.box.high[k] = pose.translation()[k];
        if (normal[k] == -1) shape.box.low[k] = pose.translation()[k];
      }
    } else {
      ode::set_pose(shape.geom.id(), pose);
      shape.box = box_of(shape.geom.id());
    }
  }
}

// --- the model

ModelInstance::ModelInstance(ModelId id, std::shared_ptr<const Blueprint> blueprint, const Eigen::Isometry3d& base, ShapeStore& shapes,
                             std::vector<std::string>& notes)
    : id_(id), blueprint_(std::move(blueprint)), base_(base) {
  ode::prepare_thread();
  make_shapes(shapes, notes);
  place_anchored();
}

void ModelInstance::set_base(const Eigen::Isometry3d& base) {
  base_ = base;
  place_anchored();
}

int ModelInstance::assembly_of(const std::string& link) const {
  const auto& links = blueprint_->model->links;
  for (std::size_t i = 0; i < links.size(); ++i) {
    if (links[i].name == link) return static_cast<int>(blueprint_->assembly_of_link[i]);
  }
  return -1;
}

void ModelInstance::enter(dWorldID world, const PhysicsDef& physics) {
  struct Order {
    std::uint32_t joint;
    int axis;
    double velocity, effort;
  };
  std::vector<Order> orders;  // what the motors do now, they go on with
  for (const auto& joint : joints_) {
    for (int i = 0; i < 2; ++i) {
      if (joint.drives[i].is_set) orders.push_back({joint.index, i, joint.drives[i].velocity, joint.drives[i].effort});
    }
  }
  joints_.clear();
  for (auto& shape : shapes_) {
    if (!blueprint_->assemblies[shape.assembly].is_anchored) dGeomSetBody(shape.geom.id(), nullptr);
  }
  bodies_.clear();
  const ModelDef& model = *blueprint_->model;
  for (const Assembly& assembly : blueprint_->assemblies) {
    bodies_.emplace_back();
    if (assembly.is_anchored) continue;
    bodies_.back() = ode::Body(dBodyCreate(world));
    const dBodyID body = bodies_.back().id();
    const Eigen::Isometry3d pose = base_ * assembly.in_model;
    const Eigen::Quaterniond q(pose.linear());
    const dQuaternion ode_q = {q.w(), q.x(), q.y(), q.z()};
    dBodySetQuaternion(body, ode_q);
    dBodySetPosition(body, pose.translation().x(), pose.translation().y(), pose.translation().z());
    dMass mass;
    const Eigen::Matrix3d& i = assembly.inertia;
    dMassSetZero(&mass);
    dMassSetParameters(&mass, assembly.mass, 0, 0, 0, i(0, 0), i(1, 1), i(2, 2), i(0, 1), i(0, 2), i(1, 2));
    dBodySetMass(body, &mass);
    dBodySetGravityMode(body, assembly.has_gravity && gravity_ ? 1 : 0);
    if (assembly.is_kinematic || is_kinematic_) dBodySetKinematic(body);
    dBodySetLinearDamping(body, std::clamp(assembly.linear_damping, 0.0, 1.0));
    dBodySetAngularDamping(body, std::clamp(assembly.angular_damping, 0.0, 1.0));
    dBodySetLinearDampingThreshold(body, 0);
    dBodySetAngularDampingThreshold(body, 0);
    dBodySetAutoDisableFlag(body, model.allow_auto_disable ? 1 : 0);
    dBodySetAutoDisableLinearThreshold(body, 0.004);
    dBodySetAutoDisableAngularThreshold(body, 0.01);
    dBodySetAutoDisableSteps(body, 10);
    dBodySetAutoDisableTime(body, 0.5);
    dBodyEnable(body);  // starts those counters
  }
  for (std::size_t i = 0; i < shapes_.size(); ++i) {
    const dBodyID body = bodies_[shapes_[i].assembly].id();
    if (body == nullptr) continue;
    dGeomSetBody(shapes_[i].geom.id(), body);
    ode::set_offset(shapes_[i].geom.id(), shape_in_body_[i]);
  }
  for (const auto j : blueprint_->joints) {
    JointInstance joint;
    joint.index = j;
    joint.def = &model.joints[j];
    make_joint(world, physics, joint);
    if (joint.joint.id() != nullptr) joints_.push_back(std::move(joint));
  }
  for (const auto& order : orders) {
    if (auto* restored = this->joint(order.joint)) set_drive(*restored, order.axis, order.velocity, order.effort);
  }
  left_neighbourhood = true;
}

void ModelInstance::make_joint(dWorldID world, const PhysicsDef& physics, JointInstance& instance) {
  using Kind = JointDef::Kind;
  const JointDef& def = *instance.def;
  instance.parent = assembly_of(def.parent);
  instance.child = assembly_of(def.child);
  const auto body_of = [&](int assembly) { return assembly < 0 ? nullptr : bodies_[static_cast<std::size_t>(assembly)].id(); };
  const dBodyID parent = body_of(instance.parent), child = body_of(instance.child);
  if (parent == child) return;  // both in the world, or one rigid piece
  const Eigen::Isometry3d frame = base_ * def.pose_in_model;
  const Eigen::Vector3d p = frame.translation();
  const auto axis = [&](std::size_t i) -> Eigen::Vector3d {
    return frame.linear() * (i < def.axes.size() ? def.axes[i].xyz : Eigen::Vector3d(0, 0, 1));
  };
  const Eigen::Vector3d a = axis(0), b = axis(1);
  dJointID joint = nullptr;
  switch (def.kind) {
    case Kind::revolute:
    case Kind::continuous:
      joint = dJointCreateHinge(world, nullptr);
      instance.joint = ode::Joint(joint);
      dJointAttach(joint, child, parent);
      dJointSetHingeAnchor(joint, p.x(), p.y(), p.z());
      dJointSetHingeAxis(joint, a.x(), a.y(), a.z());
      break;
    case Kind::screw:
    case Kind::prismatic:
      joint = dJointCreateSlider(world, nullptr);
      instance.joint = ode::Joint(joint);
      dJointAttach(joint, child, parent);
      dJointSetSliderAxis(joint, a.x(), a.y(), a.z());
      break;
    case Kind::fixed:
      joint = dJointCreateFixed(world, nullptr);
      instance.joint = ode::Joint(joint);
      dJointAttach(joint, child, parent);
      dJointSetFixed(joint);
      break;
    case Kind::ball:
      joint = dJointCreateBall(world, nullptr);
      instance.joint = ode::Joint(joint);
      dJointAttach(joint, child, parent);
      dJointSetBallAnchor(joint, p.x(), p.y(), p.z());
      break;
    case Kind::universal:
      joint = dJointCreateUniversal(world, nullptr);
      instance.joint = ode::Joint(joint);
      instance.sign = -1;
      dJointAttach(joint, parent, child);
      dJointSetUniversalAnchor(joint, p.x(), p.y(), p.z());
      dJointSetUniversalAxis1(joint, a.x(), a.y(), a.z());
      dJointSetUniversalAxis2(joint, b.x(), b.y(), b.z());
      break;
    case Kind::revolute2: {
      joint = dJointCreateHinge2(world, nullptr);
      instance.joint = ode::Joint(joint);
      instance.sign = -1;
      dJointAttach(joint, parent, child);
      dJointSetHinge2Anchor(joint, p.x(), p.y(), p.z());
      const dVector3 first = {a.x(), a.y(), a.z()}, second = {b.x(), b.y(), b.z()};
      dJointSetHinge2Axes(joint, first, second);
      if (def.suspension_erp) dJointSetHinge2Param(joint, dParamSuspensionERP, *def.suspension_erp);
      if (def.suspension_cfm) dJointSetHinge2Param(joint, dParamSuspensionCFM, *def.suspension_cfm);
      break;
    }
    case Kind::gearbox:
      joint = dJointCreateTransmission(world, nullptr);
      instance.joint = ode::Joint(joint);
      dJointAttach(joint, parent, child);
      dJointSetTransmissionMode(joint, dTransmissionIntersectingAxes);
      if (parent != nullptr)
        dJointSetTransmissionAnchor1(joint, dBodyGetPosition(parent)[0], dBodyGetPosition(parent)[1], dBodyGetPosition(parent)[2]);
      if (child != nullptr)
        dJointSetTransmissionAnchor2(joint, dBodyGetPosition(child)[0], dBodyGetPosition(child)[1], dBodyGetPosition(child)[2]);
      dJointSetTransmissionAxis1(joint, a.x(), a.y(), a.z());
      dJointSetTransmissionAxis2(joint, b.x(), b.y(), b.z());
      dJointSetTransmissionRatio(joint, def.gearbox_ratio);
      break;
  }
  dJointSetFeedback(joint, nullptr);
  for (int i = 0; i < static_cast<int>(std::min<std::size_t>(def.axes.size(), 2)); ++i) set_axis(joint, instance, i, physics.step);
}

void ModelInstance::set_axis(dJointID joint, JointInstance& instance, int i, double) {
  const JointDef& def = *instance.def;
  const AxisDef& axis = def.axes[static_cast<std::size_t>(i)];
  if (!has_position(dJointGetType(joint))) return;
  const bool turns = dJointGetType(joint) != dJointTypeSlider;
  const auto stop = [&](double v, double sense) {
    const bool none = !std::isfinite(v) || std::abs(v) > 1e10 || def.kind == JointDef::Kind::continuous;
    // ODE knows the angle of a hinge within half a turn only.
    return none || (turns && std::abs(v) > std::numbers::pi) ? sense * dInfinity : v;
  };
  double low = stop(axis.lower, -1), high = stop(axis.upper, 1);
  if (instance.sign < 0) std::swap(low, high), low = -low, high = -high;
  const bool has_stops = std::isfinite(low) || std::isfinite(high);
  if (low <= high) {
    set_joint_parameter(joint, i, dParamLoStop, low);
    set_joint_parameter(joint, i, dParamHiStop, high);
    set_joint_parameter(joint, i, dParamLoStop, low);
  }
  if (def.stop_cfm) set_joint_parameter(joint, i, dParamStopCFM, *def.stop_cfm);
  if (def.stop_erp) set_joint_parameter(joint, i, dParamStopERP, *def.stop_erp);
  if (axis.friction > 0) {
    set_joint_parameter(joint, i, dParamVel, 0);
    set_joint_parameter(joint, i, dParamFMax, axis.friction);
    instance.drives[i].explicit_damping = axis.damping;
  } else if (axis.damping > 0 && !has_stops) {
    // A motor that stands still and gives way: an exact, implicit damper. (With stops ODE would add the endless force explicitly.)
    set_joint_parameter(joint, i, dParamVel, 0);
    set_joint_parameter(joint, i, dParamFMax, dInfinity);
    set_joint_parameter(joint, i, dParamCFM, 1 / axis.damping);
  } else {
    instance.drives[i].explicit_damping = axis.damping;
  }
  if (instance.drives[i].explicit_damping > 0 || axis.spring_stiffness > 0) has_springs_ = true;
}

void ModelInstance::set_drive(JointInstance& joint, int axis, double velocity, double effort) {
  auto& drive = joint.drives[axis];
  if (drive.is_set && drive.velocity == velocity && drive.effort == effort) return;
  const AxisDef& def = joint.def->axes[static_cast<std::size_t>(axis)];
  if (!drive.is_set) {
    set_joint_parameter(joint.joint.id(), axis, dParamCFM, 1e-10);
    drive.explicit_damping = def.damping;
    if (def.damping > 0) has_springs_ = true;
  }
  drive = {velocity, effort, true, drive.explicit_damping};
  set_joint_parameter(joint.joint.id(), axis, dParamVel, effort > 0 ? joint.sign * velocity : 0);
  set_joint_parameter(joint.joint.id(), axis, dParamFMax, effort > 0 ? effort : def.friction);
  if (velocity != 0 && effort > 0) wake();
}

void ModelInstance::apply_springs(double dt) {
  if (!has_springs_) return;
  for (auto& joint : joints_) {
    for (int i = 0; i < static_cast<int>(std::min<std::size_t>(joint.def->axes.size(), 2)); ++i) {
      const AxisDef& axis = joint.def->axes[static_cast<std::size_t>(i)];
      const double damping = joint.drives[i].explicit_damping;
      if (damping <= 0 && axis.spring_stiffness <= 0) continue;
      const dJointID id = joint.joint.id();
      // The damping torque of one step must not turn the motion round.
      double inertia = infinite;
      const bool turns = dJointGetType(id) != dJointTypeSlider;
      const Eigen::Vector3d direction = base_.linear() * (joint.def->pose_in_model.linear() * axis.xyz);
      double inverse = 0;
      for (const int assembly : {joint.parent, joint.child}) {
        const dBodyID body = assembly < 0 ? nullptr : bodies_[static_cast<std::size_t>(assembly)].id();
        if (body == nullptr) continue;
        dMass mass;
        dBodyGetMass(body, &mass);
        inverse += 1 / (turns ? inertia_about(body, direction) : mass.mass);
      }
      if (inverse > 0) inertia = 1 / inverse;
      const double rate = joint.sign * joint_rate(id, i);
      double effort = -std::min(damping, 0.5 * inertia / dt) * rate;
      if (axis.spring_stiffness > 0) effort -= axis.spring_stiffness * (joint.sign * joint_position(id, i) - axis.spring_reference);
      if (effort != 0) add_joint_effort(id, i, joint.sign * effort);
    }
  }
}

JointInstance* ModelInstance::joint(std::uint32_t index) {
  for (auto& joint : joints_) {
    if (joint.index == index) return &joint;
  }
  return nullptr;
}

std::vector<BodyState> ModelInstance::save() const {
  std::vector<BodyState> states;
  for (const auto& body : bodies_) {
    if (body.id() == nullptr) continue;
    states.push_back({ode::vector(dBodyGetPosition(body.id())), ode::vector(dBodyGetLinearVel(body.id())),
                      ode::vector(dBodyGetAngularVel(body.id())), ode::quaternion(dBodyGetQuaternion(body.id())),
                      dBodyIsEnabled(body.id()) != 0});
  }
  return states;
}

void ModelInstance::restore(const std::vector<BodyState>& states) {
  std::size_t i = 0;
  for (const auto& handle : bodies_) {
    const dBodyID body = handle.id();
    if (body == nullptr) continue;
    const BodyState& s = states[i++];
    const dQuaternion q = {s.orientation.w(), s.orientation.x(), s.orientation.y(), s.orientation.z()};
    dBodySetQuaternion(body, q);
    dBodySetPosition(body, s.position.x(), s.position.y(), s.position.z());
    dBodySetLinearVel(body, s.linear.x(), s.linear.y(), s.linear.z());
    dBodySetAngularVel(body, s.angular.x(), s.angular.y(), s.angular.z());
    s.is_awake ? dBodyEnable(body) : dBodyDisable(body);
  }
  left_neighbourhood = true;
}

bool ModelInstance::is_awake() const {
  for (const auto& body : bodies_) {
    if (body.id() != nullptr && dBodyIsEnabled(body.id()) != 0) return true;
  }
  return false;
}

void ModelInstance::wake() {
  for (const auto& body : bodies_) {
    if (body.id() != nullptr) dBodyEnable(body.id());
  }
}

Eigen::Isometry3d ModelInstance::assembly_pose(std::uint32_t assembly) const {
  const dBodyID body = bodies_.empty() ? nullptr : bodies_[assembly].id();
  if (body == nullptr) return base_ * blueprint_->assemblies[assembly].in_model;
  Eigen::Isometry3d pose;
  pose.linear() = ode::quaternion(dBodyGetQuaternion(body)).toRotationMatrix();
  pose.translation() = ode::vector(dBodyGetPosition(body));
  pose.makeAffine();
  return pose;
}

const Aabb& ModelInstance::update_boxes() {
  moving_box_ = Aabb();
  for (auto& shape : shapes_) {
    if (bodies_[shape.assembly].id() == nullptr) continue;
    shape.box = box_of(shape.geom.id());
    moving_box_.extend(shape.box);
  }
  return moving_box_;
}

void ModelInstance::set_gravity(bool on) {
  gravity_ = on;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (bodies_[i].id() != nullptr) dBodySetGravityMode(bodies_[i].id(), on && blueprint_->assemblies[i].has_gravity ? 1 : 0);
  }
}

bool ModelInstance::make_kinematic() {
  if (!joints_.empty()) return false;
  is_kinematic_ = true;
  for (const auto& body : bodies_) {
    if (body.id() != nullptr) dBodySetKinematic(body.id());
  }
  return true;
}

bool ModelInstance::is_sane() const {
  for (const auto& body : bodies_) {
    if (body.id() == nullptr) continue;
    const dReal *p = dBodyGetPosition(body.id()), *v = dBodyGetLinearVel(body.id()), *w = dBodyGetAngularVel(body.id());
    double worst = 0;
    for (int k = 0; k < 3; ++k) {
      // Comparisons are written so that NaN fails them.
      if (!(std::abs(p[k]) < 1e9)) return false;
      worst = std::max({worst, std::abs(v[k]), std::abs(w[k])});
      if (!(std::abs(v[k]) < fastest) || !(std::abs(w[k]) < fastest)) return false;
    }
    if (!std::isfinite(dBodyGetQuaternion(body.id())[0])) return false;
  }
  return true;
}

}  // namespace sim
