#include <ode/ode.h>

#include <vector>

#include "bare_loops.h"
#include "physics/blueprint.h"

namespace sim::bench {
namespace {

struct Robot {
  dSpaceID space = nullptr;
  std::vector<dBodyID> bodies;
  std::vector<dJointID> left, right;
};

void place(dGeomID geom, const Eigen::Isometry3d& pose) {
  const Eigen::Quaterniond q(pose.linear());
  const dQuaternion turn = {q.w(), q.x(), q.y(), q.z()};
  dGeomSetQuaternion(geom, turn);
  dGeomSetPosition(geom, pose.translation().x(), pose.translation().y(), pose.translation().z());
}

dGeomID geom_of(const GeometryDef& shape, dSpaceID space) {
  if (const auto* box = std::get_if<BoxShape>(&shape)) return dCreateBox(space, box->size.x(), box->size.y(), box->size.z());
  if (const auto* sphere = std::get_if<SphereShape>(&shape)) return dCreateSphere(space, sphere->radius);
  if (const auto* rod = std::get_if<CylinderShape>(&shape)) return dCreateCylinder(space, rod->radius, rod->length);
  return nullptr;
}

}  // namespace

struct BareSteps::State {
  double dt = 0;
  dWorldID world = nullptr;
  dSpaceID statics = nullptr;
  dThreadingImplementationID threading = nullptr;
  dGeomID plane = nullptr;
  dJointGroupID contacts = nullptr;
  std::vector<Robot> robots;

  static void near(void* data, dGeomID a, dGeomID b) {
    if (dGeomIsSpace(a) != 0 || dGeomIsSpace(b) != 0) return dSpaceCollide2(a, b, data, &near);
    const dBodyID body_a = dGeomGetBody(a), body_b = dGeomGetBody(b);
    if (body_a != nullptr && body_b != nullptr && dAreConnected(body_a, body_b) != 0) return;
    dContact found[20];
    const int count = dCollide(a, b, 20, &found[0].geom, sizeof(dContact));
    auto& state = *static_cast<State*>(data);
    for (int i = 0; i < count; ++i) {
      found[i].surface = {};
      found[i].surface.mode = dContactApprox1;
      // A sphere that is the caster has no friction: marked by its data.
      found[i].surface.mu = dGeomGetData(a) != nullptr || dGeomGetData(b) != nullptr ? 0 : 1;
      dJointAttach(dJointCreateContact(state.world, state.contacts, &found[i]), body_a, body_b);
    }
  }

  void add_static(const ModelDef& model) {
    for (const auto& link : model.links) {
      for (const auto& collision : link.collisions) {
        if (std::holds_alternative<PlaneShape>(collision.geometry)) {
          plane = dCreatePlane(nullptr, 0, 0, 1, 0);
        } else if (const dGeomID geom = geom_of(collision.geometry, statics)) {
          place(geom, model.pose * link.pose * collision.pose);
        }
      }
    }
  }

  void add_robot(const ModelDef& model) {
    const auto blueprint = Blueprint::of(std::make_shared<const ModelDef>(model)).value();
    Robot robot;
    robot.space = dSimpleSpaceCreate(nullptr);
    for (const auto& assembly : blueprint->assemblies) {
      const dBodyID body = dBodyCreate(world);
      const Eigen::Isometry3d pose = model.pose * assembly.in_model;
      const Eigen::Quaterniond q(pose.linear());
      const dQuaternion turn = {q.w(), q.x(), q.y(), q.z()};
      dBodySetQuaternion(body, turn);
      dBodySetPosition(body, pose.translation().x(), pose.translation().y(), pose.translation().z());
      const Eigen::Matrix3d& i = assembly.inertia;
      dMass mass;
      dMassSetZero(&mass);
      dMassSetParameters(&mass, assembly.mass, 0, 0, 0, i(0, 0), i(1, 1), i(2, 2), i(0, 1), i(0, 2), i(1, 2));
      dBodySetMass(body, &mass);
      robot.bodies.push_back(body);
    }
    for (std::uint32_t l = 0; l < model.links.size(); ++l) {
      for (const auto& collision : model.links[l].collisions) {
        const dGeomID geom = geom_of(collision.geometry, robot.space);
        const Eigen::Isometry3d offset = blueprint->link_in_body[l] * collision.pose;
        const Eigen::Quaterniond q(offset.linear());
        const dQuaternion turn = {q.w(), q.x(), q.y(), q.z()};
        dGeomSetBody(geom, robot.bodies[blueprint->assembly_of_link[l]]);
        dGeomSetOffsetPosition(geom, offset.translation().x(), offset.translation().y(), offset.translation().z());
        dGeomSetOffsetQuaternion(geom, turn);
        if (collision.surface.mu == 0) dGeomSetData(geom, this);
      }
    }
    for (const auto j : blueprint->joints) add_hinge(robot, *blueprint, model.joints[j]);
    robots.push_back(robot);
  }

  void add_hinge(Robot& robot, const Blueprint& blueprint, const JointDef& def) {
    const auto body_of = [&](const std::string& link) {
      for (std::size_t i = 0; i < blueprint.model->links.size(); ++i) {
        if (blueprint.model->links[i].name == link) return robot.bodies[blueprint.assembly_of_link[i]];
      }
      return static_cast<dBodyID>(nullptr);
    };
    const dJointID joint = dJointCreateHinge(world, nullptr);
    const Eigen::Isometry3d frame = blueprint.model->pose * def.pose_in_model;
    const Eigen::Vector3d at = frame.translation(), axis = frame.linear() * def.axes.at(0).xyz;
    dJointAttach(joint, body_of(def.child), body_of(def.parent));
    dJointSetHingeAnchor(joint, at.x(), at.y(), at.z());
    dJointSetHingeAxis(joint, axis.x(), axis.y(), axis.z());
    dJointSetHingeParam(joint, dParamFMax, 5);
    (def.name.find("left") != std::string::npos ? robot.left : robot.right).push_back(joint);
  }
};

BareSteps::BareSteps(const WorldDef& world) : state_(std::make_unique<State>()) {
  dInitODE2(dInitFlagManualThreadCleanup);
  dAllocateODEDataForThread(dAllocateMaskAll);
  State& s = *state_;
  s.dt = world.physics.step;
  s.world = dWorldCreate();
  s.threading = dThreadingAllocateSelfThreadedImplementation();
  dWorldSetStepThreadingImplementation(s.world, dThreadingImplementationGetFunctions(s.threading), s.threading);
  dWorldSetGravity(s.world, 0, 0, -9.8);
  dWorldSetContactSurfaceLayer(s.world, world.physics.contact_surface_layer);
  const dVector3 center = {0, 0, 0, 0}, extents = {50, 50, 5, 0};
  s.statics = dQuadTreeSpaceCreate(nullptr, center, extents, 6);
  s.contacts = dJointGroupCreate(0);
  for (const auto& model : world.models) model.is_static ? s.add_static(model) : s.add_robot(model);
}

BareSteps::~BareSteps() {
  for (auto& robot : state_->robots) dSpaceDestroy(robot.space);
  dJointGroupDestroy(state_->contacts);
  dSpaceDestroy(state_->statics);
  dGeomDestroy(state_->plane);
  dWorldDestroy(state_->world);
  dThreadingFreeImplementation(state_->threading);
}

void BareSteps::drive(double left, double right) {
  for (const auto& robot : state_->robots) {
    for (const auto joint : robot.left) dJointSetHingeParam(joint, dParamVel, left);
    for (const auto joint : robot.right) dJointSetHingeParam(joint, dParamVel, right);
  }
}

void BareSteps::step() {
  State& s = *state_;
  for (const auto& robot : s.robots) {
    dSpaceCollide2(reinterpret_cast<dGeomID>(robot.space), s.plane, &s, &State::near);
    dSpaceCollide2(reinterpret_cast<dGeomID>(robot.space), reinterpret_cast<dGeomID>(s.statics), &s, &State::near);
  }
  dWorldStep(s.world, s.dt);
  dJointGroupEmpty(s.contacts);
}

Eigen::Isometry3d BareSteps::pose(std::size_t robot) const {
  const dBodyID body = state_->robots.at(robot).bodies.at(0);
  const dReal *p = dBodyGetPosition(body), *q = dBodyGetQuaternion(body);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).toRotationMatrix();
  pose.translation() = Eigen::Vector3d(p[0], p[1], p[2]);
  return pose;
}

std::size_t BareSteps::robots() const { return state_->robots.size(); }

}  // namespace sim::bench
