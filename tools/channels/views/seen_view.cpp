#include "channels/views/seen_view.h"

#include <string>

#include "channels/views/view_parts.h"

namespace channels {
namespace {

template <class Message, class Info>
IfaceView placed_view(const shm::Iface& iface) {
  IfaceView view;
  view.channels = {channel<Message>(iface)};
  place<Info>(view, iface);
  return view;
}

template <class Element>
std::span<const Element> filled(const shm::Iface& iface) {
  return {reinterpret_cast<const Element*>(iface.sample_followers(0)), iface.filled()};
}

// A cube with a text for each thing, in the frame of the sensor.
ros::MarkerArray cubes(const shm::Iface& iface, const shm::Stamp& stamp) {
  ros::MarkerArray array;
  array.markers.push_back({.header = header_of(stamp, iface.name()), .ns = iface.name(), .action = ros::Marker::remove_all});
  return array;
}

void add_cube(ros::MarkerArray& array, const shm::Pose& pose, const ros::Vector3& size, const std::string& text) {
  ros::Marker cube{.header = array.markers.front().header, .ns = array.markers.front().ns};
  cube.id = static_cast<std::int32_t>(array.markers.size());
  cube.type = ros::Marker::cube;
  cube.pose = pose_of(pose);
  cube.scale = size;
  cube.color = {0.2F, 0.8F, 0.3F, 0.6F};
  cube.text = text;
  array.markers.push_back(std::move(cube));
}

ros::ObjectHypothesisWithPose certain(const shm::Box& box) { return {{std::to_string(box.label), 1}, {pose_of(box.pose)}}; }

ros::Detection2DArray image_boxes(const shm::Iface& iface) {
  ros::Detection2DArray array{header_of(iface.sample<shm::Stamp>(), iface.name() + "/optical")};
  for (const shm::Box& box : filled<shm::Box>(iface)) {
    array.detections.push_back(
        {array.header, {certain(box)}, {{{box.center[0], box.center[1]}, 0}, box.size[0], box.size[1]}, text_of(box.name)});
  }
  return array;
}

ros::Detection3DArray oriented_boxes(const shm::Iface& iface) {
  ros::Detection3DArray array{header_of(iface.sample<shm::Stamp>(), iface.name())};
  for (const shm::Box& box : filled<shm::Box>(iface)) {
    array.detections.push_back(
        {array.header, {certain(box)}, {pose_of(box.pose), {box.extent[0], box.extent[1], box.extent[2]}}, text_of(box.name)});
  }
  return array;
}

}  // namespace

IfaceView logical_camera_view(const shm::Iface& iface) {
  IfaceView view = placed_view<ros::MarkerArray, shm::LogicalCameraInfo>(iface);
  view.tell = [](shm::Iface& from, const shm::HeldFrame*, Said& said) {
    const auto& stamp = from.sample<shm::Stamp>();
    if (stamp.valid == 0) return;
    auto array = cubes(from, stamp);
    for (const auto& model : filled<shm::SeenModel>(from)) add_cube(array, model.pose, {0.1, 0.1, 0.1}, text_of(model.name));
    said.add(0, array);
  };
  return view;
}

IfaceView boxes_view(const shm::Iface& iface) {
  const bool is_oriented = iface.info<shm::BoxesInfo>().kind == RTMSIM_BOX_ORIENTED;
  IfaceView view =
      is_oriented ? placed_view<ros::Detection3DArray, shm::BoxesInfo>(iface) : placed_view<ros::Detection2DArray, shm::BoxesInfo>(iface);
  view.frames.clear();  // the image of the same name has them
  view.tell = [is_oriented](shm::Iface& from, const shm::HeldFrame*, Said& said) {
    if (from.sample<shm::Stamp>().valid == 0) return;
    if (is_oriented) {
      said.add(0, oriented_boxes(from));
    } else {
      said.add(0, image_boxes(from));
    }
  };
  return view;
}

IfaceView fiducial_view(const shm::Iface& iface) {
  IfaceView view = placed_view<ros::MarkerArray, shm::FiducialInfo>(iface);
  view.tell = [](shm::Iface& from, const shm::HeldFrame*, Said& said) {
    const auto& stamp = from.sample<shm::Stamp>();
    if (stamp.valid == 0) return;
    auto array = cubes(from, stamp);
    for (const auto& mark : filled<shm::Mark>(from))
      add_cube(array, mark.pose, {0.01, mark.size[1], mark.size[2]}, std::to_string(mark.id));
    said.add(0, array);
  };
  return view;
}

}  // namespace channels
