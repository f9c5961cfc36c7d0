#include "devices/sensors/camera_channels.h"

#include <algorithm>
#include <array>

#include "render/marks.h"
#include "render/object_boxes.h"
#include "render/pixels.h"
#include "shm/server.h"
#include "shm/specs.h"

namespace sim {
namespace {

constexpr std::uint32_t max_boxes = 256;  // of an image

shm::Format color_format(PixelFormat format) {
  switch (format) {
    case PixelFormat::rgb8:
    case PixelFormat::float32:
      return shm::Format::rgb8;
    case PixelFormat::bgr8:
      return shm::Format::bgr8;
    case PixelFormat::rgba8:
      return shm::Format::rgba8;
    case PixelFormat::bgra8:
      return shm::Format::bgra8;
    case PixelFormat::mono8:
      return shm::Format::mono8;
    case PixelFormat::mono16:
      return shm::Format::mono16;
    case PixelFormat::bayer_rggb8:
      return shm::Format::bayer_rggb8;
    case PixelFormat::bayer_bggr8:
      return shm::Format::bayer_bggr8;
    case PixelFormat::bayer_gbrg8:
      return shm::Format::bayer_gbrg8;
    case PixelFormat::bayer_grbg8:
      return shm::Format::bayer_grbg8;
  }
  return shm::Format::rgb8;
}

shm::Format format_of(CameraSees what, const CameraDef& def) {
  switch (what) {
    case CameraSees::depth:
      return shm::Format::depth_float;
    case CameraSees::points:
      return shm::Format::points_float;
    case CameraSees::labels:
      return shm::Format::labels;
    case CameraSees::label_colors:
      return shm::Format::rgb8;
    case CameraSees::heat:
      return def.thermal.is_wide ? shm::Format::thermal16 : shm::Format::thermal8;
    case CameraSees::colors:
    case CameraSees::boxes:
      break;
  }
  return color_format(def.format);
}

shm::BoxesInfo boxes_info(const shm::CameraInfo& camera, const CameraDef& def) {
  shm::BoxesInfo info{};
  info.kind = static_cast<std::uint32_t>(def.boxes);
  info.capacity = max_boxes;
  info.width = camera.width;
  info.height = camera.height;
  info.rate = camera.rate;
  info.pose = camera.pose;
  shm::set_text(info.model, camera.model);
  return info;
}

void set_image_box(shm::Box& box, const ImageBox& image) {
  box.center[0] = (image.left + image.right) / 2;
  box.center[1] = (image.top + image.bottom) / 2;
  box.size[0] = image.right - image.left;
  box.size[1] = image.bottom - image.top;
}

View view_of(const CameraDef& def, const Eigen::Isometry3d& pose) {
  View view = View::pinhole(pose, def.horizontal_fov, def.width, def.height);
  view.near_clip = def.near_clip;
  view.far_clip = def.far_clip;
  return view;
}

void set_box(shm::Box& box, const SeenObject& seen, const CameraDef& def, const CameraJob& job) {
  const Scene& scene = *job.snapshot.scene;
  const SceneObject& object = scene.objects[seen.object];
  box = {};
  box.label = object.label;
  box.pixels = seen.pixels;
  box.pose = shm::identity_pose;
  shm::set_text(box.name, object.name);
  const ImageBox outermost{double(seen.left), double(seen.top), double(seen.right + 1), double(seen.bottom + 1)};
  if (def.boxes == BoxKind::visible) {
    set_image_box(box, outermost);
  } else if (def.boxes == BoxKind::full) {
    set_image_box(box, image_box(scene, *job.snapshot.poses, object, view_of(def, job.pose)).value_or(outermost));
  } else {
    const OrientedBox oriented = oriented_box(scene, *job.snapshot.poses, object);
    box.pose = to_pose(job.pose.inverse() * oriented.pose);
    for (int i = 0; i < 3; ++i) box.extent[i] = oriented.size[i];
  }
}

void publish_boxes(const Camera& camera, const CameraJob& job, shm::IfaceWriter& writer) {
  const auto seen = seen_objects(*job.snapshot.scene, camera.marks(), camera.def().width);
  const auto boxes = writer.followers<shm::Box>(0);
  auto& sample = writer.sample<shm::BoxesSample>();
  sample.total = static_cast<std::uint32_t>(seen.size());
  sample.count = static_cast<std::uint32_t>(std::min(seen.size(), boxes.size()));
  for (std::size_t i = 0; i < sample.count; ++i) set_box(boxes[i], seen[i], camera.def(), job);
  writer.publish(job.time);
}

void fill_frame(const Camera& camera, const CameraJob& job, CameraSees what, std::span<std::byte> frame) {
  const std::span<std::uint8_t> bytes(reinterpret_cast<std::uint8_t*>(frame.data()), frame.size());
  const std::span<float> floats(reinterpret_cast<float*>(frame.data()), frame.size() / sizeof(float));
  const Scene& scene = *job.snapshot.scene;
  switch (what) {
    case CameraSees::colors:
      return camera.write_color(bytes);
    case CameraSees::points:
      return camera.write_points(floats);
    case CameraSees::labels:
      return write_labels(scene, camera.marks(), camera.def().has_instances, bytes);
    case CameraSees::label_colors:
      return write_label_colors(scene, camera.marks(), camera.def().has_instances, bytes);
    case CameraSees::heat:
      return camera.write_heat(scene, job.air, bytes);
    case CameraSees::depth:
      std::copy_n(camera.depth().begin(), std::min(floats.size(), camera.depth().size()), floats.begin());
    case CameraSees::boxes:
      return;
  }
}

struct Needs {
  bool color = false, depth = false, marks = false;
  void add(CameraSees what) {
    color = color || what == CameraSees::colors;
    depth = depth || what == CameraSees::depth || what == CameraSees::points;
    marks = marks || !(what == CameraSees::colors || what == CameraSees::depth || what == CameraSees::points);
  }
  // No kind of sensor has both depth and marks.
  Camera::Output output() const {
    if (marks) return color ? Camera::Output::color_and_marks : Camera::Output::marks;
    return !depth ? Camera::Output::color : color ? Camera::Output::color_and_depth : Camera::Output::depth;
  }
};

}  // namespace

std::span<const CameraSees> seen_by(SensorKind kind) {
  using enum CameraSees;
  static constexpr std::array color{colors};
  static constexpr std::array range{depth, points};
  static constexpr std::array both{colors, depth, points};
  static constexpr std::array segments{labels, label_colors};
  static constexpr std::array warmth{heat};
  static constexpr std::array boxed{colors, boxes};
  switch (kind) {
    case SensorKind::depth_camera:
      return range;
    case SensorKind::rgbd_camera:
      return both;
    case SensorKind::segmentation_camera:
      return segments;
    case SensorKind::thermal_camera:
      return warmth;
    case SensorKind::box_camera:
      return boxed;
    default:
      return color;
  }
}

shm::IfaceType type_of(CameraSees what) {
  if (what == CameraSees::depth) return shm::IfaceType::depth;
  if (what == CameraSees::points) return shm::IfaceType::points;
  return what == CameraSees::boxes ? shm::IfaceType::boxes : shm::IfaceType::camera;
}

std::string ending_of(CameraSees what) {
  if (what == CameraSees::labels) return "::labels_map";
  return what == CameraSees::label_colors ? "::colored_map" : "";
}

Camera::Output output_of(std::span<const CameraSees> all) {
  Needs needs;
  for (const CameraSees what : all) needs.add(what);
  return needs.output();
}

Camera::Output output_of(std::span<const CameraChannel> channels, const std::vector<bool>& wanted) {
  Needs needs;
  for (std::size_t i = 0; i < channels.size(); ++i) {
    if (wanted[i]) needs.add(channels[i].what);
  }
  return needs.output();
}

base::Result<CameraChannel> make_channel(DeviceWorld& world, CameraSees what, const std::string& name, shm::CameraInfo info,
                                         const CameraDef& def) {
  info.format = static_cast<std::uint32_t>(format_of(what, def));
  auto writer = world.shm.create(what == CameraSees::boxes ? shm::iface_spec(shm::IfaceType::boxes, name, boxes_info(info, def))
                                                           : shm::camera_spec(type_of(what), name, info));
  if (!writer) return writer.error();
  return CameraChannel{what, std::move(*writer)};
}

void publish(const Camera& camera, const CameraJob& job, std::span<CameraChannel> channels) {
  for (std::size_t i = 0; i < channels.size(); ++i) {
    if (job.channels[i] && channels[i].what == CameraSees::boxes) publish_boxes(camera, job, *channels[i].writer);
  }
  for (std::size_t i = 0; i < channels.size(); ++i) {
    if (!job.channels[i] || channels[i].what == CameraSees::boxes) continue;
    auto frame = channels[i].writer->begin_frame();
    if (!frame) continue;  // readers hold every slot: counted by the ring
    fill_frame(camera, job, channels[i].what, *frame);
    const double unit = channels[i].what == CameraSees::heat ? camera.def().thermal.resolution : 0;
    channels[i].writer->publish_frame(job.time, to_pose(job.pose), 0, unit);
  }
}

}  // namespace sim
