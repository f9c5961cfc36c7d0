// The channels of a camera: one for each of its ifaces, all from the same drawing. One thread at a time.
#pragma once

#include <chrono>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "devices/device.h"
#include "devices/render_world.h"
#include "render/camera.h"

namespace sim {

enum class CameraSees { colors, depth, points, labels, label_colors, heat, boxes };

struct CameraChannel {
  CameraSees what;
  std::shared_ptr<shm::IfaceWriter> writer;
};

struct CameraJob {
  Snapshot snapshot;
  Eigen::Isometry3d pose;  // of the camera in the world
  std::chrono::nanoseconds time;
  std::vector<bool> channels;  // which are wanted
  double air = 0;              // temperature at the camera [K]
};

// In the order of the ifaces. The first one publishes frames.
std::span<const CameraSees> seen_by(SensorKind kind);
shm::IfaceType type_of(CameraSees what);
// What the name of the iface has behind that of the sensor.
std::string ending_of(CameraSees what);

// The camera's whole work, and that for the channels that are wanted.
Camera::Output output_of(std::span<const CameraSees> all);
Camera::Output output_of(std::span<const CameraChannel> channels, const std::vector<bool>& wanted);

// The iface of a channel. `info` holds what all of the sensor have; format and capacity are those of the channel.
base::Result<CameraChannel> make_channel(DeviceWorld& world, CameraSees what, const std::string& name, shm::CameraInfo info,
                                         const CameraDef& def);

// What the camera has taken for this job. Boxes first: who has seen the image finds them.
void publish(const Camera& camera, const CameraJob& job, std::span<CameraChannel> channels);

}  // namespace sim
