// Cameras of all kinds: camera, depth, rgbd, multicamera, segmentation, bounding box, thermal. Each camera draws in a thread of its own,
// with a context of its own, and only while a client subscribes. Ten simulated seconds after the last image it releases its context. The
// frame of time t shows the world at t, and its pose is the camera's at t. See device.h for the thread rule.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "devices/device.h"
#include "render/camera.h"

namespace sim {

// What a device of a camera answers about its place: for pictures through its eyes.
class CameraPlaceSource {
 public:
  virtual ~CameraPlaceSource() = default;
  virtual Eigen::Isometry3d camera_pose() const = 0;  // in the world, now
  virtual const CameraDef& camera_def() const = 0;
  virtual std::uint64_t pictures_drawn() const = 0;  // so far; none while nobody subscribes
  virtual bool holds_context() const = 0;            // GL's, with what it holds of the scene: tens of MiB
};

// The devices of one sensor: one for each iface. A camera has a `camera` iface, a depth camera `depth` and `points`, an rgbd camera all
// three under the same name; the cameras of a set are named sensor::camera. A bounding box camera has a `camera` iface and a `boxes` iface,
// a segmentation camera the `camera` ifaces sensor::labels_map and sensor::colored_map.
base::Result<std::vector<std::unique_ptr<Device>>> make_cameras(DeviceWorld& world, Mount mount, const SensorDef& sensor);

}  // namespace sim
