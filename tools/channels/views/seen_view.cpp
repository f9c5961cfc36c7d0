#include "channels/views/seen_view.h"

#include <string>

#include "channels/views/view_parts.h"
#include "ros/from_device.h"

namespace channels {

IfaceView logical_camera_view(const shm::Iface& iface) {
  return simple_view<ros::MarkerArray, shm::LogicalCameraInfo>(iface, ros::seen_models_message);
}

IfaceView boxes_view(const shm::Iface& iface) {
  const bool is_oriented = iface.info<shm::BoxesInfo>().kind == RTMSIM_BOX_ORIENTED;
  IfaceView view;
  view.channels = {is_oriented ? channel<ros::Detection3DArray>(iface) : channel<ros::Detection2DArray>(iface)};
  view.rate = iface.info<shm::BoxesInfo>().rate;  // the image of the same name has the frames
  view.tell = [is_oriented](shm::Iface& from, const shm::HeldFrame*, Said& said) {
    if (from.sample<shm::Stamp>().valid == 0) return;
    if (is_oriented) {
      said.add(0, ros::oriented_boxes_message(from, from.name()));
    } else {
      said.add(0, ros::image_boxes_message(from, from.name() + "/optical"));
    }
  };
  return view;
}

IfaceView fiducial_view(const shm::Iface& iface) { return simple_view<ros::MarkerArray, shm::FiducialInfo>(iface, ros::marks_message); }

}  // namespace channels
