#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/text.h"
#include "world/model_builder.h"
#include "world/sensor_parts.h"
#include "world/xml_file.h"
#include "world/xml_values.h"

namespace sim {

NoiseDef build_noise(pugi::xml_node node, BuildContext& context) {
  NoiseDef noise;
  if (!node) return noise;
  const std::string type = node.attribute("type") ? node.attribute("type").value() : text_at(node, "type", "gaussian");
  if (type == "none") return noise;
  if (type != "gaussian" && type != "gaussian_quantized") {
    context.complaints.warn(
        node, "noise of type " + base::in_quotes(type) + " in " + describe_in_context(node.parent()) + " is not known; none is taken");
    return noise;
  }
  noise.kind = type == "gaussian" ? NoiseDef::Kind::gaussian : NoiseDef::Kind::gaussian_quantized;
  noise.mean = number_at(node, "mean", 0);
  noise.stddev = number_at(node, "stddev", 0);
  noise.bias_mean = number_at(node, "bias_mean", 0);
  noise.bias_stddev = number_at(node, "bias_stddev", 0);
  noise.dynamic_bias_stddev = std::max(0.0, number_at(node, "dynamic_bias_stddev", 0));
  noise.dynamic_bias_correlation_time = std::max(0.0, number_at(node, "dynamic_bias_correlation_time", 0));
  noise.precision = std::max(0.0, number_at(node, "precision", 0));
  return noise;
}

NoiseDef noise_at(pugi::xml_node node, const std::string& path, BuildContext& context) {
  return build_noise(child_at(node, path + "/noise"), context);
}

std::array<NoiseDef, 3> noises_at(pugi::xml_node node, const std::string& path, BuildContext& context) {
  return {noise_at(node, path + "/x", context), noise_at(node, path + "/y", context), noise_at(node, path + "/z", context)};
}

// What is wrong with the sensor, for one line.
std::string must(pugi::xml_node sensor, const std::string& what, const std::string& expected, double got) {
  return what + " of " + describe_in_context(sensor) + " must be " + expected + ", got " + base::format_number(got) +
         "; the sensor is left out";
}

namespace {

constexpr int max_rays = 4000000;  // of one scan
constexpr int max_pixels_a_side = 16384;
constexpr double max_pixels = 1 << 26;  // an iface holds no larger frames

ScanDef build_scan(pugi::xml_node node) {
  ScanDef scan;
  scan.samples = node ? integer_at(node, "samples", 640) : 1;
  // Gazebo lets some rays stand for more points and fills in between; here every point has its own ray.
  scan.resolution = number_at(node, "resolution", 1);
  const double points = std::round(scan.samples * scan.resolution);
  if (scan.samples >= 1) scan.samples = static_cast<int>(std::clamp(points, 1.0, max_rays + 1.0));
  scan.min_angle = number_at(node, "min_angle", 0);
  scan.max_angle = number_at(node, "max_angle", 0);
  return scan;
}

std::optional<RayDef> build_ray(pugi::xml_node sensor, BuildContext& context) {
  const pugi::xml_node node = sensor.child("lidar") ? sensor.child("lidar") : sensor.child("ray");
  RayDef ray;
  ray.horizontal = build_scan(child_at(node, "scan/horizontal"));
  ray.vertical = build_scan(child_at(node, "scan/vertical"));
  ray.range_min = number_at(node, "range/min", 0);
  ray.range_max = number_at(node, "range/max", 10);
  ray.range_resolution = number_at(node, "range/resolution", 0);
  ray.noise = build_noise(node.child("noise"), context);
  ray.visibility_mask = static_cast<std::uint32_t>(std::strtoul(text_at(node, "visibility_mask", "4294967295").c_str(), nullptr, 0));
  ray.is_rolling = bool_at(node, "rolling", false);
  // Old files have 0 for "one layer".
  if (ray.vertical.samples == 0) ray.vertical.samples = 1;
  std::string wrong;
  for (const ScanDef* scan : {&ray.horizontal, &ray.vertical}) {
    if (scan->samples < 1 || scan->samples > max_rays) wrong = must(sensor, "number of samples", "from 1 to 4000000", scan->samples);
    if (scan->min_angle > scan->max_angle) wrong = must(sensor, "smallest angle", "at most the largest", scan->min_angle);
    if (scan->max_angle - scan->min_angle > 4 * std::numbers::pi)
      wrong = must(sensor, "angle", "within two turns", scan->max_angle - scan->min_angle);
  }
  if (wrong.empty() && static_cast<double>(ray.horizontal.samples) * ray.vertical.samples > max_rays) {
    wrong = must(sensor, "number of rays", "at most 4000000", static_cast<double>(ray.horizontal.samples) * ray.vertical.samples);
  }
  // "inf" stands for a sensor that sees to the end of the world.
  if (ray.range_max > 1e6) {
    context.complaints.note(node, "largest range of " + describe_in_context(sensor) + " is cut to 1000000 m");
    ray.range_max = 1e6;
  }
  if (ray.range_max <= ray.range_min) wrong = must(sensor, "largest range", "above the smallest", ray.range_max);
  if (wrong.empty()) return ray;
  context.complaints.drop(sensor, wrong);
  return std::nullopt;
}

// Depth is always float, and colours never are; models that were copied from one kind to the other say nothing wrong.
PixelFormat format_at(pugi::xml_node sensor, pugi::xml_node node, SensorKind kind, BuildContext& context) {
  const std::string name = text_at(node, "image/format", "R8G8B8");
  const auto format = parse_pixel_format(name);
  const bool is_color_only = kind == SensorKind::camera || kind == SensorKind::multi_camera;
  if (format && (*format != PixelFormat::float32 || !is_color_only)) return *format == PixelFormat::float32 ? PixelFormat::rgb8 : *format;
  context.complaints.warn(child_at(node, "image/format"), "image format " + base::in_quotes(name) + " of " + describe_in_context(sensor) +
                                                              (format ? " is for depth cameras" : " is not known") + "; R8G8B8 is taken");
  return PixelFormat::rgb8;
}

std::optional<CameraDef> build_camera(pugi::xml_node sensor, pugi::xml_node node, SensorKind kind, BuildContext& context) {
  CameraDef camera;
  camera.name = node.attribute("name").value();
  if (camera.name.empty()) camera.name = sensor.attribute("name").value();
  camera.pose = pose_at(node, "pose");
  camera.horizontal_fov = number_at(node, "horizontal_fov", 1.047);
  camera.width = integer_at(node, "image/width", 320);
  camera.height = integer_at(node, "image/height", 240);
  camera.format = format_at(sensor, node, kind, context);
  camera.near_clip = number_at(node, "clip/near", 0.1);
  camera.far_clip = number_at(node, "clip/far", 100);
  if (const pugi::xml_node depth = child_at(node, "depth_camera/clip")) {
    camera.depth_clip = {number_at(depth, "near", camera.near_clip), number_at(depth, "far", camera.far_clip)};
  }
  camera.noise = build_noise(node.child("noise"), context);
  if (const pugi::xml_node lens = node.child("distortion")) {
    DistortionDef& d = camera.distortion.emplace();
    d.k1 = number_at(lens, "k1", 0), d.k2 = number_at(lens, "k2", 0), d.k3 = number_at(lens, "k3", 0);
    d.p1 = number_at(lens, "p1", 0), d.p2 = number_at(lens, "p2", 0);
    d.center = vector2_at(lens, "center", d.center);
    if (d.k1 == 0 && d.k2 == 0 && d.k3 == 0 && d.p1 == 0 && d.p2 == 0) camera.distortion.reset();
  }
  if (const pugi::xml_node lens = node.child("lens")) {
    LensDef& l = camera.lens.emplace();
    l.type = text_at(lens, "type", "gnomonical");
    l.scale_to_fov = bool_at(lens, "scale_to_hfov", true);
    l.cutoff_angle = number_at(lens, "cutoff_angle", l.cutoff_angle);
    l.environment_texture_size = std::clamp(integer_at(lens, "env_texture_size", 256), 16, 4096);
    const pugi::xml_node custom = lens.child("custom_function");
    l.c1 = number_at(custom, "c1", 1), l.c2 = number_at(custom, "c2", 1), l.c3 = number_at(custom, "c3", 0),
    l.f = number_at(custom, "f", 1);
    l.function = text_at(custom, "fun", "tan");
  }
  camera.visibility_mask = static_cast<std::uint32_t>(std::strtoul(text_at(node, "visibility_mask", "4294967295").c_str(), nullptr, 0));
  std::string wrong;
  if (camera.width < 1 || camera.width > max_pixels_a_side) wrong = must(sensor, "image width", "from 1 to 16384", camera.width);
  if (camera.height < 1 || camera.height > max_pixels_a_side) wrong = must(sensor, "image height", "from 1 to 16384", camera.height);
  if (const double pixels = static_cast<double>(camera.width) * camera.height; wrong.empty() && pixels > max_pixels) {
    wrong = must(sensor, "number of pixels", "at most 67108864", pixels);
  }
  if (!(camera.horizontal_fov > 0.001 && camera.horizontal_fov <= 2 * std::numbers::pi + 1e-3)) {
    wrong = must(sensor, "horizontal field of view", "above 0.001 and at most a turn", camera.horizontal_fov);
  }
  if (!camera.lens && camera.horizontal_fov >= 3.1)
    wrong = must(sensor, "horizontal field of view", "below 3.1 without a <lens>", camera.horizontal_fov);
  if (!(camera.near_clip < camera.far_clip)) wrong = must(sensor, "near clip distance", "below the far one", camera.near_clip);
  if (camera.lens && camera.lens->type == "custom" && camera.lens->c1 * camera.lens->c2 * camera.lens->f == 0)
    wrong = must(sensor, "c1, c2 and f of the custom lens", "other than zero", 0);
  if (wrong.empty()) return camera;
  context.complaints.drop(sensor, wrong);
  return std::nullopt;
}

// What cameras have that show something else than colours.
void build_special_camera(CameraDef& camera, pugi::xml_node sensor, pugi::xml_node node, SensorKind kind, BuildContext& context) {
  const auto unknown = [&](const char* element, const std::string& value, const char* taken) {
    context.complaints.warn(child_at(node, element), std::string(element) + " " + base::in_quotes(value) + " of " +
                                                         describe_in_context(sensor) + " is not known; " + taken + " is taken");
  };
  if (kind == SensorKind::segmentation_camera) {
    const std::string type = base::to_lower(text_at(node, "segmentation_type", "semantic"));
    camera.has_instances = type == "instance" || type == "panoptic";
    if (!camera.has_instances && type != "semantic") unknown("segmentation_type", type, "semantic");
  } else if (kind == SensorKind::box_camera) {
    const char* element = node.child("boundingbox_type") ? "boundingbox_type" : "box_type";
    const std::string type = base::to_lower(text_at(node, element, "2d"));
    camera.boxes = type == "full_2d" || type == "full_box_2d" ? BoxKind::full : type == "3d" ? BoxKind::oriented : BoxKind::visible;
    if (camera.boxes == BoxKind::visible && type != "2d" && type != "visible_2d" && type != "visible_box_2d")
      unknown(element, type, "visible_2d");
  } else if (kind == SensorKind::thermal_camera) {
    camera.thermal.is_wide = camera.format != PixelFormat::mono8;
    if (!camera.thermal.is_wide) camera.thermal.resolution = 3;
    camera.thermal.highest = camera.thermal.resolution * (camera.thermal.is_wide ? 65535 : 255);
  }
}

std::optional<CameraSetDef> build_cameras(pugi::xml_node sensor, SensorKind kind, BuildContext& context) {
  CameraSetDef set;
  for (pugi::xml_node node : sensor.children("camera")) {
    std::optional<CameraDef> camera = build_camera(sensor, node, kind, context);
    if (!camera) return std::nullopt;
    build_special_camera(*camera, sensor, node, kind, context);
    set.cameras.push_back(std::move(*camera));
    if (kind != SensorKind::multi_camera) break;
  }
  if (!set.cameras.empty()) return set;
  context.complaints.drop(sensor, describe_in_context(sensor) + " has no <camera> and is left out");
  return std::nullopt;
}

std::optional<LogicalCameraDef> build_logical_camera(pugi::xml_node sensor, BuildContext& context) {
  const pugi::xml_node node = sensor.child("logical_camera");
  LogicalCameraDef camera{number_at(node, "near", 0), number_at(node, "far", 1), number_at(node, "horizontal_fov", 1),
                          number_at(node, "aspect_ratio", 1)};
  std::string wrong;
  if (!(camera.near_clip >= 0)) wrong = must(sensor, "near distance", "0 or more", camera.near_clip);
  if (!(camera.far_clip > camera.near_clip)) wrong = must(sensor, "far distance", "above the near one", camera.far_clip);
  if (!(camera.horizontal_fov > 0 && camera.horizontal_fov < std::numbers::pi))
    wrong = must(sensor, "horizontal field of view", "above 0 and below half a turn", camera.horizontal_fov);
  if (!(camera.aspect_ratio > 0)) wrong = must(sensor, "aspect ratio", "positive", camera.aspect_ratio);
  if (wrong.empty()) return camera;
  context.complaints.drop(sensor, wrong);
  return std::nullopt;
}

std::optional<FiducialDef> build_fiducial(pugi::xml_node sensor, BuildContext& context) {
  const pugi::xml_node node = sensor.child("fiducial");
  FiducialDef detector{number_at(node, "range/min", 0), number_at(node, "range/max", 8),
                       number_at(node, "horizontal_fov", std::numbers::pi), noise_at(node, "position", context),
                       noise_at(node, "orientation", context)};
  std::string wrong;
  if (!(detector.range_min >= 0)) wrong = must(sensor, "smallest range", "0 or more", detector.range_min);
  if (!(detector.range_max > detector.range_min)) wrong = must(sensor, "largest range", "above the smallest", detector.range_max);
  if (!(detector.view_angle > 0 && detector.view_angle <= 2 * std::numbers::pi + 1e-9))
    wrong = must(sensor, "horizontal field of view", "above 0 and at most a turn", detector.view_angle);
  if (wrong.empty()) return detector;
  context.complaints.drop(sensor, wrong);
  return std::nullopt;
}

std::optional<SonarDef> build_sonar(pugi::xml_node sensor, BuildContext& context) {
  const pugi::xml_node node = sensor.child("sonar");
  SonarDef sonar;
  sonar.range_min = number_at(node, "min", 0);
  sonar.range_max = number_at(node, "max", 1);
  sonar.radius = number_at(node, "radius", 0.5);
  if (sonar.range_max > sonar.range_min) return sonar;
  context.complaints.drop(sensor, must(sensor, "largest range", "above the smallest", sonar.range_max));
  return std::nullopt;
}

ForceTorqueDef build_force_torque(pugi::xml_node sensor, BuildContext& context) {
  const pugi::xml_node node = sensor.child("force_torque");
  ForceTorqueDef out;
  const std::string frame = text_at(node, "frame", "child");
  out.frame = frame == "parent"   ? ForceTorqueDef::Frame::parent
              : frame == "sensor" ? ForceTorqueDef::Frame::sensor
                                  : ForceTorqueDef::Frame::child;
  out.measures_parent_to_child = text_at(node, "measure_direction") == "parent_to_child";
  out.force = noises_at(node, "force", context);
  out.torque = noises_at(node, "torque", context);
  return out;
}

ImuDef build_imu(pugi::xml_node sensor, BuildContext& context) {
  const pugi::xml_node node = sensor.child("imu");
  ImuDef imu;
  imu.angular_velocity = noises_at(node, "angular_velocity", context);
  imu.linear_acceleration = noises_at(node, "linear_acceleration", context);
  imu.has_orientation = bool_at(node, "enable_orientation", true);
  using Reference = ImuDef::Reference;
  const pugi::xml_node frame = node.child("orientation_reference_frame");
  const std::string where = text_at(frame, "localization", frame ? "CUSTOM" : "");
  if (where == "ENU" || where == "NED" || where == "NWU") {
    imu.reference = where == "ENU" ? Reference::enu : where == "NED" ? Reference::ned : Reference::nwu;
  } else if (where == "CUSTOM") {
    const Eigen::Vector3d rpy = vector3_at(frame, "custom_rpy", Eigen::Vector3d::Zero());
    if (rpy.allFinite()) {
      imu.reference = Reference::custom;
      imu.custom_axes = (Eigen::AngleAxisd(rpy.z(), Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(rpy.y(), Eigen::Vector3d::UnitY()) *
                         Eigen::AngleAxisd(rpy.x(), Eigen::Vector3d::UnitX()))
                            .toRotationMatrix();
    }
  } else if (!where.empty()) {
    context.complaints.warn(frame, "localization " + base::in_quotes(where) + " of " + describe_in_context(sensor) +
                                       " is not known; its orientation is that in the world");
  }
  return imu;
}

GpsDef build_gps(pugi::xml_node sensor, BuildContext& context) {
  const pugi::xml_node node = sensor.child("navsat") ? sensor.child("navsat") : sensor.child("gps");
  GpsDef gps;
  gps.horizontal_position = noise_at(node, "position_sensing/horizontal", context);
  gps.vertical_position = noise_at(node, "position_sensing/vertical", context);
  gps.horizontal_velocity = noise_at(node, "velocity_sensing/horizontal", context);
  gps.vertical_velocity = noise_at(node, "velocity_sensing/vertical", context);
  return gps;
}

// Takes what a builder has made; false when it has left the sensor out.
template <class Data>
bool take(SensorDef& out, std::optional<Data> data) {
  if (data) out.data = std::move(*data);
  return data.has_value();
}

bool take_cameras(SensorDef& out, pugi::xml_node sensor, BuildContext& context) {
  return take(out, build_cameras(sensor, out.kind, context));
}

ContactDef build_contact(pugi::xml_node sensor) {
  ContactDef contact;
  for (pugi::xml_node name : sensor.child("contact").children("collision")) contact.collisions.push_back(text_of(name));
  return contact;
}

AltimeterDef build_altimeter(pugi::xml_node sensor, BuildContext& context) {
  return {noise_at(sensor, "altimeter/vertical_position", context), noise_at(sensor, "altimeter/vertical_velocity", context)};
}

AirPressureDef build_air_pressure(pugi::xml_node sensor, BuildContext& context) {
  return {noise_at(sensor, "air_pressure/pressure", context), number_at(sensor, "air_pressure/reference_altitude", 0)};
}

using Node = pugi::xml_node;

// A kind of sensor: what files call it, the first being its name in messages, and how the part of it that is the kind's own is read; false
// when the sensor is left out.
struct KindRow {
  SensorKind kind;
  std::array<std::string_view, 4> spellings;
  bool (*build)(SensorDef& out, Node sensor, BuildContext& context);
};

constexpr std::array kinds{
    KindRow{SensorKind::ray,
            {"ray", "gpu_ray", "lidar", "gpu_lidar"},
            [](SensorDef& out, Node sensor, BuildContext& context) { return take(out, build_ray(sensor, context)); }},
    KindRow{SensorKind::camera, {"camera", "wideanglecamera", "wide_angle_camera"}, take_cameras},
    KindRow{SensorKind::depth_camera, {"depth_camera", "depth"}, take_cameras},
    KindRow{SensorKind::rgbd_camera, {"rgbd_camera", "rgbd"}, take_cameras},
    KindRow{SensorKind::multi_camera, {"multicamera"}, take_cameras},
    KindRow{SensorKind::contact,
            {"contact"},
            [](SensorDef& out, Node sensor, BuildContext&) { return take(out, std::optional(build_contact(sensor))); }},
    KindRow{SensorKind::imu,
            {"imu"},
            [](SensorDef& out, Node sensor, BuildContext& context) { return take(out, std::optional(build_imu(sensor, context))); }},
    KindRow{SensorKind::gps,
            {"gps", "navsat"},
            [](SensorDef& out, Node sensor, BuildContext& context) { return take(out, std::optional(build_gps(sensor, context))); }},
    KindRow{SensorKind::sonar,
            {"sonar"},
            [](SensorDef& out, Node sensor, BuildContext& context) { return take(out, build_sonar(sensor, context)); }},
    KindRow{
        SensorKind::force_torque,
        {"force_torque"},
        [](SensorDef& out, Node sensor, BuildContext& context) { return take(out, std::optional(build_force_torque(sensor, context))); }},
    KindRow{SensorKind::altimeter,
            {"altimeter"},
            [](SensorDef& out, Node sensor, BuildContext& context) { return take(out, std::optional(build_altimeter(sensor, context))); }},
    KindRow{SensorKind::magnetometer,
            {"magnetometer"},
            [](SensorDef& out, Node sensor, BuildContext& context) {
              return take(out, std::optional(MagnetometerDef{noises_at(sensor, "magnetometer", context)}));
            }},
    KindRow{
        SensorKind::air_pressure,
        {"air_pressure"},
        [](SensorDef& out, Node sensor, BuildContext& context) { return take(out, std::optional(build_air_pressure(sensor, context))); }},
    KindRow{
        SensorKind::dvl, {"dvl"}, [](SensorDef& out, Node sensor, BuildContext& context) { return take(out, build_dvl(sensor, context)); }},
    KindRow{SensorKind::air_speed,
            {"air_speed", "airspeed"},
            [](SensorDef& out, Node sensor, BuildContext& context) {
              return take(out, std::optional(AirSpeedDef{noise_at(sensor, "air_speed/pressure", context)}));
            }},
    KindRow{SensorKind::ins,
            {"ins"},
            [](SensorDef& out, Node sensor, BuildContext& context) { return take(out, std::optional(build_ins(sensor, context))); }},
    KindRow{SensorKind::rfid,
            {"rfid"},
            [](SensorDef& out, Node sensor, BuildContext& context) { return take(out, build_rfid(sensor, context)); }},
    KindRow{SensorKind::rfid_tag,
            {"rfidtag"},
            [](SensorDef& out, Node sensor, BuildContext&) { return take(out, std::optional(build_rfid_tag(sensor))); }},
    KindRow{SensorKind::wireless_receiver,
            {"wireless_receiver"},
            [](SensorDef& out, Node sensor, BuildContext& context) { return take(out, build_radio(sensor, context)); }},
    KindRow{SensorKind::wireless_transmitter,
            {"wireless_transmitter"},
            [](SensorDef& out, Node sensor, BuildContext& context) { return take(out, build_radio(sensor, context)); }},
    KindRow{SensorKind::wheels,
            {"wheel_encoders"},
            [](SensorDef& out, Node sensor, BuildContext& context) { return take(out, build_wheels(sensor, context)); }},
    KindRow{SensorKind::localization,
            {"localization"},
            [](SensorDef& out, Node sensor, BuildContext& context) { return take(out, build_localization(sensor, context)); }},
    KindRow{SensorKind::segmentation_camera, {"segmentation_camera", "segmentation"}, take_cameras},
    KindRow{SensorKind::box_camera, {"boundingbox_camera", "boundingbox", "bounding_box_camera"}, take_cameras},
    KindRow{SensorKind::thermal_camera, {"thermal_camera", "thermal"}, take_cameras},
    KindRow{SensorKind::logical_camera,
            {"logical_camera"},
            [](SensorDef& out, Node sensor, BuildContext& context) { return take(out, build_logical_camera(sensor, context)); }},
    KindRow{SensorKind::fiducial,
            {"fiducial"},
            [](SensorDef& out, Node sensor, BuildContext& context) { return take(out, build_fiducial(sensor, context)); }},
};

const KindRow* row_of(std::string_view spelling) {
  const auto row = std::find_if(kinds.begin(), kinds.end(), [&](const KindRow& one) {
    return !spelling.empty() && std::find(one.spellings.begin(), one.spellings.end(), spelling) != one.spellings.end();
  });
  return row == kinds.end() ? nullptr : &*row;
}

// A sensor of type "custom" names its type in an attribute with a prefix of its own: gz:type="dvl".
std::string type_of(Node sensor) {
  const std::string type = sensor.attribute("type").value();
  if (type != "custom") return type;
  for (const pugi::xml_attribute attribute : sensor.attributes()) {
    if (std::string_view(attribute.name()).ends_with(":type") && row_of(attribute.value()) != nullptr) return attribute.value();
  }
  return type;
}

}  // namespace

std::string_view to_text(SensorKind kind) {
  const auto row = std::find_if(kinds.begin(), kinds.end(), [&](const KindRow& one) { return one.kind == kind; });
  return row == kinds.end() ? "unknown" : row->spellings.front();
}

std::optional<SensorDef> build_sensor(pugi::xml_node node, BuildContext& context) {
  SensorDef sensor;
  sensor.name = node.attribute("name").value();
  sensor.type = type_of(node);
  const KindRow* kind = row_of(sensor.type);
  if (kind == nullptr) {
    context.complaints.drop(
        node, "sensors of type " + base::in_quotes(sensor.type) + " are not simulated; " + describe_in_context(node) + " is left out");
    return std::nullopt;
  }
  sensor.kind = kind->kind;
  sensor.pose = pose_at(node, "pose");
  sensor.update_rate = std::min(number_at(node, "update_rate", 0), 1e6);
  sensor.always_on = bool_at(node, "always_on", false);
  sensor.visualize = bool_at(node, "visualize", false);
  sensor.topic = text_at(node, "topic");
  if (sensor.topic == "__default__") sensor.topic.clear();
  if (!kind->build(sensor, node, context)) return std::nullopt;
  return sensor;
}

}  // namespace sim
