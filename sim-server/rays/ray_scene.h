// The world for rays, in Embree: the shapes that lidars, sonars and other range finders measure. Exact shapes: boxes and meshes as
// triangles, spheres, cylinders and capsules as what they are, planes endless. Static shapes lie in one scene; moving bodies made of the
// same shapes share theirs.
//
// Building and moving (add, remove, set_pose, commit) are for one thread at a time; after commit() any number of threads may trace until
// the next change. Lengths in m. Ranges are exact to a few 1e-5 m within 30 m of the sensor.
//
// The static scene is of the best quality. Up to 32 moving bodies in reach of a sensor are met one by one, each in its own frame, and those
// out of the way of a packet of beams are left out. Where more are, they are instances in a scene that is built again, fast, for the first
// such sensor of a moment, since Embree refuses to refit such a scene. Faces of boxes overlap by some 10 um at their edges, so that plain
// tracing loses no beam between them; scenes with meshes are traced with Embree's robust flag, which costs a third of the speed.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "world/triangles.h"
#include "world/world_def.h"

namespace sim {

struct RayShape {
  const GeometryDef* geometry = nullptr;                   // needed only while it is added
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  // in the body
  float retro = 0;
  std::uint32_t color = 0xb0b0b0;  // 0xrrggbb, for pictures made with rays
};

using RayBodyId = std::uint32_t;

// A fan of rays from one point: unit directions in the sensor's frame, each with its own start. Padded to packets of 16.
class Beams {
 public:
  Beams() = default;
  // `directions` in the order of the results; neighbours should look almost the same way.
  Beams(std::span<const Eigen::Vector3f> directions, float near, float far);
  // Layers of beams from the lowest up, each counter-clockwise.
  static Beams fan(int beams, double from, double to, int layers, double lowest, double highest, float near, float far);

  std::size_t size() const { return size_; }
  float far() const { return far_; }
  Eigen::Vector3f direction(std::size_t beam) const { return {x_[beam], y_[beam], z_[beam]}; }
  // Rays begin there and see nothing nearer.
  void set_near(std::size_t beam, float near) { near_[beam] = near; }
  float near(std::size_t beam) const { return near_[beam]; }

 private:
  friend class RayScene;
  // Around the directions of a packet.
  struct Cone {
    Eigen::Vector3f axis{0, 0, 0};
    float cosine = 1, sine = 0;  // of half the opening
  };
  std::size_t size_ = 0;
  float far_ = 0;
  std::vector<float> x_, y_, z_, near_;
  Eigen::Vector3f low_{0, 0, 0}, high_{0, 0, 0};  // of all directions and the origin
  std::vector<Cone> cones_;                       // by packet
};

struct RayHit {
  float range = 0;  // +infinity: nothing
  Eigen::Vector3f normal{0, 0, 0};
  float retro = 0;
  std::uint32_t color = 0;
};

class RayScene {
 public:
  explicit RayScene(TriangleCache& triangles);
  ~RayScene();
  RayScene(const RayScene&) = delete;
  RayScene& operator=(const RayScene&) = delete;

  // Shapes that never move, in the world. What cannot be built adds a line to `notes`.
  RayBodyId add_static(std::span<const RayShape> shapes, const Eigen::Isometry3d& pose, std::vector<std::string>& notes);
  RayBodyId add_moving(std::span<const RayShape> shapes, const Eigen::Isometry3d& pose, std::vector<std::string>& notes);
  void remove(RayBodyId body);
  void set_pose(RayBodyId body, const Eigen::Isometry3d& pose);  // moving bodies only
  // Must be called after changes, before rays are traced. Cheap when nothing changed.
  void commit();

  // ranges (and retros, when not empty) have beams.size() elements: the distance to what is hit between near and far of the beam,
  // +infinity when nothing is.
  void trace(const Beams& beams, const Eigen::Isometry3d& sensor, std::span<float> ranges, std::span<float> retros) const;
  // One ray with everything known about the hit.
  RayHit trace_one(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, float near, float far) const;

  // Where beams that start at `sensor` (in the body's frame) leave the body's own shapes that enclose their origin: the casing. Sets near
  // of those beams accordingly, so that a sensor looks out of its casing, but sees the rest of its robot.
  void look_out_of(std::span<const RayShape> shapes, const Eigen::Isometry3d& sensor, Beams& beams);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sim
