// Owners of ODE's handles, and the few conversions between ODE and Eigen. Only physics/ includes this.
#pragma once

#include <ode/ode.h>

#include <Eigen/Geometry>
#include <memory>
#include <utility>

namespace sim::ode {

// Must have been called by every thread before it uses ODE.
void prepare_thread();

template <class Id, void (*destroy)(Id)>
class Handle {
 public:
  Handle() = default;
  explicit Handle(Id id) : id_(id) {}
  ~Handle() { reset(); }
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, nullptr)) {}
  Handle& operator=(Handle&& other) noexcept {
    if (this != &other) {
      reset();
      id_ = std::exchange(other.id_, nullptr);
    }
    return *this;
  }
  Id id() const { return id_; }
  void reset() {
    if (id_ != nullptr) destroy(id_);
    id_ = nullptr;
  }

 private:
  Id id_ = nullptr;
};

using Body = Handle<dBodyID, dBodyDestroy>;
using Joint = Handle<dJointID, dJointDestroy>;
using JointGroup = Handle<dJointGroupID, dJointGroupDestroy>;
using Geom = Handle<dGeomID, dGeomDestroy>;
using TriMeshData = Handle<dTriMeshDataID, dGeomTriMeshDataDestroy>;
using HeightfieldData = Handle<dHeightfieldDataID, dGeomHeightfieldDataDestroy>;
using Threading = Handle<dThreadingImplementationID, dThreadingFreeImplementation>;

// A world with a threading implementation of its own: the default one is shared by all worlds, and steps of two worlds at a time crash it.
class World {
 public:
  World();
  dWorldID id() const { return world_.id(); }

 private:
  Threading threading_;
  Handle<dWorldID, dWorldDestroy> world_;
};

inline Eigen::Vector3d vector(const dReal* v) { return {v[0], v[1], v[2]}; }
inline Eigen::Quaterniond quaternion(const dReal* q) { return {q[0], q[1], q[2], q[3]}; }

inline void set_pose(dGeomID geom, const Eigen::Isometry3d& pose) {
  const Eigen::Quaterniond q(pose.linear());
  const dQuaternion ode_q = {q.w(), q.x(), q.y(), q.z()};
  dGeomSetQuaternion(geom, ode_q);
  dGeomSetPosition(geom, pose.translation().x(), pose.translation().y(), pose.translation().z());
}
inline void set_offset(dGeomID geom, const Eigen::Isometry3d& pose) {
  const Eigen::Quaterniond q(pose.linear());
  const dQuaternion ode_q = {q.w(), q.x(), q.y(), q.z()};
  dGeomSetOffsetPosition(geom, pose.translation().x(), pose.translation().y(), pose.translation().z());
  dGeomSetOffsetQuaternion(geom, ode_q);
}

}  // namespace sim::ode
