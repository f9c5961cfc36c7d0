// Converts ifaces with detections to channels: models of a logical camera, boxes of a bounding box camera, marks of a detector. One thread
// at a time.
#pragma once

#include "channels/views/iface_view.h"

namespace channels {

IfaceView logical_camera_view(const shm::Iface& iface);
IfaceView boxes_view(const shm::Iface& iface);
IfaceView fiducial_view(const shm::Iface& iface);

}  // namespace channels
