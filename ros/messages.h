// Messages of ROS 2. Members, their order and their types are those of ROS 2; units are m, rad,
// s; x forward, y left, z up. Values.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ros/cdr.h"

namespace ros {

struct Time {
  static constexpr std::string_view name = "builtin_interfaces/msg/Time";
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;
  static void fields(auto& m, auto& visit) {
    visit("sec", m.sec);
    visit("nanosec", m.nanosec);
  }
};
// Since time 0, which is never negative.
inline Time to_time(std::chrono::nanoseconds time) {
  constexpr std::int64_t second = 1'000'000'000;
  const std::int64_t ns = std::max<std::int64_t>(time.count(), 0);
  return {static_cast<std::int32_t>(std::min<std::int64_t>(ns / second, INT32_MAX)), static_cast<std::uint32_t>(ns % second)};
}

struct Duration {
  static constexpr std::string_view name = "builtin_interfaces/msg/Duration";
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;
  static void fields(auto& m, auto& visit) {
    visit("sec", m.sec);
    visit("nanosec", m.nanosec);
  }
};

struct Header {
  static constexpr std::string_view name = "std_msgs/msg/Header";
  Time stamp{};
  std::string frame_id{};
  static void fields(auto& m, auto& visit) {
    visit("stamp", m.stamp);
    visit("frame_id", m.frame_id);
  }
};

struct ColorRGBA {
  static constexpr std::string_view name = "std_msgs/msg/ColorRGBA";
  float r = 0, g = 0, b = 0, a = 1;
  static void fields(auto& m, auto& visit) {
    visit("r", m.r);
    visit("g", m.g);
    visit("b", m.b);
    visit("a", m.a);
  }
};

struct Text {
  static constexpr std::string_view name = "std_msgs/msg/String";
  std::string data{};
  static void fields(auto& m, auto& visit) { visit("data", m.data); }
};

// ---- geometry_msgs ----

struct Vector3 {
  static constexpr std::string_view name = "geometry_msgs/msg/Vector3";
  double x = 0, y = 0, z = 0;
  static void fields(auto& m, auto& visit) {
    visit("x", m.x);
    visit("y", m.y);
    visit("z", m.z);
  }
};
struct Point {
  static constexpr std::string_view name = "geometry_msgs/msg/Point";
  double x = 0, y = 0, z = 0;
  static void fields(auto& m, auto& visit) {
    visit("x", m.x);
    visit("y", m.y);
    visit("z", m.z);
  }
};
struct Quaternion {
  static constexpr std::string_view name = "geometry_msgs/msg/Quaternion";
  double x = 0, y = 0, z = 0, w = 1;
  static void fields(auto& m, auto& visit) {
    visit("x", m.x);
    visit("y", m.y);
    visit("z", m.z);
    visit("w", m.w);
  }
};
struct Pose {
  static constexpr std::string_view name = "geometry_msgs/msg/Pose";
  Point position{};
  Quaternion orientation{};
  static void fields(auto& m, auto& visit) {
    visit("position", m.position);
    visit("orientation", m.orientation);
  }
};
struct Twist {
  static constexpr std::string_view name = "geometry_msgs/msg/Twist";
  Vector3 linear{}, angular{};
  static void fields(auto& m, auto& visit) {
    visit("linear", m.linear);
    visit("angular", m.angular);
  }
};
struct PoseWithCovariance {
  static constexpr std::string_view name = "geometry_msgs/msg/PoseWithCovariance";
  Pose pose{};
  std::array<double, 36> covariance{};
  static void fields(auto& m, auto& visit) {
    visit("pose", m.pose);
    visit("covariance", m.covariance);
  }
};
struct TwistWithCovariance {
  static constexpr std::string_view name = "geometry_msgs/msg/TwistWithCovariance";
  Twist twist{};
  std::array<double, 36> covariance{};
  static void fields(auto& m, auto& visit) {
    visit("twist", m.twist);
    visit("covariance", m.covariance);
  }
};
struct TwistStamped {
  static constexpr std::string_view name = "geometry_msgs/msg/TwistStamped";
  Header header{};
  Twist twist{};
  static void fields(auto& m, auto& visit) {
    visit("header", m.header);
    visit("twist", m.twist);
  }
};
struct TwistWithCovarianceStamped {
  static constexpr std::string_view name = "geometry_msgs/msg/TwistWithCovarianceStamped";
  Header header{};
  TwistWithCovariance twist{};
  static void fields(auto& m, auto& visit) {
    visit("header", m.header);
    visit("twist", m.twist);
  }
};
struct PoseWithCovarianceStamped {
  static constexpr std::string_view name = "geometry_msgs/msg/PoseWithCovarianceStamped";
  Header header{};
  PoseWithCovariance pose{};
  static void fields(auto& m, auto& visit) {
    visit("header", m.header);
    visit("pose", m.pose);
  }
};
struct Transform {
  static constexpr std::string_view name = "geometry_msgs/msg/Transform";
  Vector3 translation{};
  Quaternion rotation{};
  static void fields(auto& m, auto& visit) {
    visit("translation", m.translation);
    visit("rotation", m.rotation);
  }
};
struct TransformStamped {
  static constexpr std::string_view name = "geometry_msgs/msg/TransformStamped";
  Header header{};  // the parent
  std::string child_frame_id{};
  Transform transform{};
  static void fields(auto& m, auto& visit) {
    visit("header", m.header);
    visit("child_frame_id", m.child_frame_id);
    visit("transform", m.transform);
  }
};
struct Wrench {
  static constexpr std::string_view name = "geometry_msgs/msg/Wrench";
  Vector3 force{}, torque{};
  static void fields(auto& m, auto& visit) {
    visit("force", m.force);
    visit("torque", m.torque);
  }
};
struct WrenchStamped {
  static constexpr std::string_view name = "geometry_msgs/msg/WrenchStamped";
  Header header{};
  Wrench wrench{};
  static void fields(auto& m, auto& visit) {
    visit("header", m.header);
    visit("wrench", m.wrench);
  }
};

struct TFMessage {
  static constexpr std::string_view name = "tf2_msgs/msg/TFMessage";
  std::vector<TransformStamped> transforms{};
  static void fields(auto& m, auto& visit) { visit("transforms", m.transforms); }
};
struct Clock {
  static constexpr std::string_view name = "rosgraph_msgs/msg/Clock";
  Time clock{};
  static void fields(auto& m, auto& visit) { visit("clock", m.clock); }
};

// ---- sensor_msgs; octets and numbers of sensors stay where they are until they are encoded ----

struct LaserScan {
  static constexpr std::string_view name = "sensor_msgs/msg/LaserScan";
  Header header{};
  float angle_min = 0, angle_max = 0, angle_increment = 0, time_increment = 0, scan_time = 0, range_min = 0, range_max = 0;
  std::span<const float> ranges{}, intensities{};
  static void fields(auto& m, auto& visit) {
    visit("header", m.header);
    visit("angle_min", m.angle_min);
    visit("angle_max", m.angle_max);
    visit("angle_increment", m.angle_increment);
    visit("time_increment", m.time_increment);
    visit("scan_time", m.scan_time);
    visit("range_min", m.range_min);
    visit("range_max", m.range_max);
    visit("ranges", m.ranges);
    visit("intensities", m.intensities);
  }
};
struct Image {
  static constexpr std::string_view name = "sensor_msgs/msg/Image";
  Header header{};
  std::uint32_t height = 0, width = 0;
  std::string encoding{};  // "rgb8", "bayer_rggb8", "32FC1", ...
  std::uint8_t is_bigendian = 0;
  std::uint32_t step = 0;
  std::span<const std::uint8_t> data{};
  static void fields(auto& m, auto& visit) {
    visit("header", m.header);
    visit("height", m.height);
    visit("width", m.width);
    visit("encoding", m.encoding);
    visit("is_bigendian", m.is_bigendian);
    visit("step", m.step);
    visit("data", m.data);
  }
};
struct CompressedImage {
  static constexpr std::string_view name = "sensor_msgs/msg/CompressedImage";
  Header header{};
  std::string format{};  // "jpeg", "png"
  std::span<const std::uint8_t> data{};
  static void fields(auto& m, auto& visit) {
    visit("header", m.header);
    visit("format", m.format);
    visit("data", m.data);
  }
};
struct RegionOfInterest {
  static constexpr std::string_view name = "sensor_msgs/msg/RegionOfInterest";
  std::uint32_t x_offset = 0, y_offset = 0, height = 0, width = 0;
  bool do_rectify = false;
  static void fields(auto& m, auto& visit) {
    visit("x_offset", m.x_offset);
    visit("y_offset", m.y_offset);
    visit("height", m.height);
    visit("width", m.width);
    visit("do_rectify", m.do_rectify);
  }
};
struct CameraInfo {
  static constexpr std::string_view name = "sensor_msgs/msg/CameraInfo";
  Header header{};
  std::uint32_t height = 0, width = 0;
  std::string distortion_model{};
  std::vector<double> d{};
  std::array<double, 9> k{}, r{};
  std::array<double, 12> p{};
  std::uint32_t binning_x = 0, binning_y = 0;
  RegionOfInterest roi{};
  static void fields(auto& m, auto& visit) {
    visit("header", m.header);
    visit("height", m.height);
    visit("width", m.width);
    visit("distortion_model", m.distortion_model);
    visit("d", m.d);
    visit("k", m.k);
    visit("r", m.r);
    visit("p", m.p);
    visit("binning_x", m.binning_x);
    visit("binning_y", m.binning_y);
    visit("roi", m.roi);
  }
};
struct Imu {
  static constexpr std::string_view name = "sensor_msgs/msg/Imu";
  Header header{};
  Quaternion orientation{};
  std::array<double, 9> orientation_covariance{};
  Vector3 angular_velocity{};
  std::array<double, 9> angular_velocity_covariance{};
  Vector3 linear_acceleration{};
  std::array<double, 9> linear_acceleration_covariance{};
  static void fields(auto& m, auto& visit) {
    visit("header", m.header);
    visit("orientation", m.orientation);
    visit("orientation_covariance", m.orientation_covariance);
    visit("angular_velocity", m.angular_velocity);
    visit("angular_velocity_covariance", m.angular_velocity_covariance);
    visit("linear_acceleration", m.linear_acceleration);
    visit("linear_acceleration_covariance", m.linear_acceleration_covariance);
  }
};
struct NavSatStatus {
  static constexpr std::string_view name = "sensor_msgs/msg/NavSatStatus";
  static constexpr std::string_view constants = "int8 STATUS_NO_FIX=-1\nint8 STATUS_FIX=0\nuint16 SERVICE_GPS=1\n";
  std::int8_t status = 0;
  std::uint16_t service = 1;
  static void fields(auto& m, auto& visit) {
    visit("status", m.status);
    visit("service", m.service);
  }
};
struct NavSatFix {
  static constexpr std::string_view name = "sensor_msgs/msg/NavSatFix";
  static constexpr std::string_view constants = "uint8 COVARIANCE_TYPE_UNKNOWN=0\nuint8 COVARIANCE_TYPE_DIAGONAL_KNOWN=2\n";
  Header header{};
  NavSatStatus status{};
  double latitude = 0, longitude = 0, altitude = 0;  // [degree, degree, m]
  std::array<double, 9> position_covariance{};
  std::uint8_t position_covariance_type = 0;
  static void fields(auto& m, auto& visit) {
    visit("header", m.header);
    visit("status", m.status);
    visit("latitude", m.latitude);
    visit("longitude", m.longitude);
    visit("altitude", m.altitude);
    visit("position_covariance", m.position_covariance);
    visit("position_covariance_type", m.position_covariance_type);
  }
};
struct PointField {
  static constexpr std::string_view name = "sensor_msgs/msg/PointField";
  static constexpr std::string_view constants = "uint8 UINT16=4\nuint8 FLOAT32=7\n";
  static constexpr std::uint8_t uint16 = 4, float32 = 7;
  std::string field{};
  std::uint32_t offset = 0;
  std::uint8_t datatype = float32;
  std::uint32_t count = 1;
  static void fields(auto& m, auto& visit) {
    visit("name", m.field);
    visit("offset", m.offset);
    visit("datatype", m.datatype);
    visit("count", m.count);
  }
};
struct PointCloud2 {
  static constexpr std::string_view name = "sensor_msgs/msg/PointCloud2";
  Header header{};
  std::uint32_t height = 0, width = 0;
  std::vector<PointField> point_fields{};
  bool is_bigendian = false;
  std::uint32_t point_step = 0, row_step = 0;
  std::span<const std::uint8_t> data{};
  bool is_dense = false;
  static void fields(auto& m, auto& visit) {
    visit("header", m.header);
    visit("height", m.height);
    visit("width", m.width);
    visit("fields", m.point_fields);
    visit("is_bigendian", m.is_bigendian);
    visit("point_step", m.point_step);
    visit("row_step", m.row_step);
    visit("data", m.data);
    visit("is_dense", m.is_dense);
  }
};
struct Range {
  static constexpr std::string_view name = "sensor_msgs/msg/Range";
  static constexpr std::string_view constants = "uint8 ULTRASOUND=0\nuint8 INFRARED=1\n";
  Header header{};
  std::uint8_t radiation_type = 0;
  float field_of_view = 0, min_range = 0, max_range = 0, range = 0, variance = 0;
  static void fields(auto& m, auto& visit) {
    visit("header", m.header);
    visit("radiation_type", m.radiation_type);
    visit("field_of_view", m.field_of_view);
    visit("min_range", m.min_range);
    visit("max_range", m.max_range);
    visit("range", m.range);
    visit("variance", m.variance);
  }
};
struct JointState {
  static constexpr std::string_view name = "sensor_msgs/msg/JointState";
  Header header{};
  std::vector<std::string> names{};
  std::vector<double> position{}, velocity{}, effort{};
  static void fields(auto& m, auto& visit) {
    visit("header", m.header);
    visit("name", m.names);
    visit("position", m.position);
    visit("velocity", m.velocity);
    visit("effort", m.effort);
  }
};
struct BatteryState {
  static constexpr std::string_view name = "sensor_msgs/msg/BatteryState";
  static constexpr std::string_view constants =
      "uint8 POWER_SUPPLY_STATUS_UNKNOWN=0\nuint8 POWER_SUPPLY_STATUS_CHARGING=1\nuint8 POWER_SUPPLY_STATUS_DISCHARGING=2\n"
      "uint8 POWER_SUPPLY_STATUS_NOT_CHARGING=3\nuint8 POWER_SUPPLY_STATUS_FULL=4\nuint8 POWER_SUPPLY_HEALTH_GOOD=1\n"
      "uint8 POWER_SUPPLY_TECHNOLOGY_UNKNOWN=0\n";
  enum Status : std::uint8_t { charging = 1, discharging = 2, not_charging = 3, full = 4 };
  static constexpr float unknown = std::numeric_limits<float>::quiet_NaN();
  Header header{};
  float voltage = 0, temperature = unknown, current = 0;  // [V], [degree C], [A]: negative while it discharges
  float charge = 0, capacity = 0, design_capacity = 0;    // [Ah]
  float percentage = 0;                                   // 0 to 1
  std::uint8_t power_supply_status = 0, power_supply_health = 1, power_supply_technology = 0;
  bool present = true;
  std::vector<float> cell_voltage{}, cell_temperature{};
  std::string location{}, serial_number{};
  static void fields(auto& m, auto& visit) {
    visit("header", m.header);
    visit("voltage", m.voltage);
    visit("temperature", m.temperature);
    visit("current", m.current);
    visit("charge", m.charge);
    visit("capacity", m.capacity);
    visit("design_capacity", m.design_capacity);
    visit("percentage", m.percentage);
    visit("power_supply_status", m.power_supply_status);
    visit("power_supply_health", m.power_supply_health);
    visit("power_supply_technology", m.power_supply_technology);
    visit("present", m.present);
    visit("cell_voltage", m.cell_voltage);
    visit("cell_temperature", m.cell_temperature);
    visit("location", m.location);
    visit("serial_number", m.serial_number);
  }
};
struct MagneticField {
  static constexpr std::string_view name = "sensor_msgs/msg/MagneticField";
  Header header{};
  Vector3 magnetic_field{};  // [T]
  std::array<double, 9> magnetic_field_covariance{};
  static void fields(auto& m, auto& visit) {
    visit("header", m.header);
    visit("magnetic_field", m.magnetic_field);
    visit("magnetic_field_covariance", m.magnetic_field_covariance);
  }
};
struct FluidPressure {
  static constexpr std::string_view name = "sensor_msgs/msg/FluidPressure";
  Header header{};
  double fluid_pressure = 0;  // [Pa]
  double variance = 0;
  static void fields(auto& m, auto& visit) {
    visit("header", m.header);
    visit("fluid_pressure", m.fluid_pressure);
    visit("variance", m.variance);
  }
};

struct Odometry {
  static constexpr std::string_view name = "nav_msgs/msg/Odometry";
  Header header{};
  std::string child_frame_id{};
  PoseWithCovariance pose{};
  TwistWithCovariance twist{};
  static void fields(auto& m, auto& visit) {
    visit("header", m.header);
    visit("child_frame_id", m.child_frame_id);
    visit("pose", m.pose);
    visit("twist", m.twist);
  }
};

// ---- visualization_msgs ----

struct UVCoordinate {
  static constexpr std::string_view name = "visualization_msgs/msg/UVCoordinate";
  float u = 0, v = 0;
  static void fields(auto& m, auto& visit) {
    visit("u", m.u);
    visit("v", m.v);
  }
};
struct MeshFile {
  static constexpr std::string_view name = "visualization_msgs/msg/MeshFile";
  std::string filename{};
  std::span<const std::uint8_t> data{};
  static void fields(auto& m, auto& visit) {
    visit("filename", m.filename);
    visit("data", m.data);
  }
};
struct Marker {
  static constexpr std::string_view name = "visualization_msgs/msg/Marker";
  static constexpr std::string_view constants =
      "int32 ARROW=0\nint32 CUBE=1\nint32 SPHERE=2\nint32 CYLINDER=3\nint32 TRIANGLE_LIST=11\nint32 ADD=0\nint32 DELETE=2\nint32 "
      "DELETEALL=3\n";
  static constexpr std::int32_t arrow = 0, cube = 1, triangle_list = 11;
  static constexpr std::int32_t add = 0, remove_all = 3;
  Header header{};
  std::string ns{};
  std::int32_t id = 0, type = 0, action = 0;
  Pose pose{};
  Vector3 scale{};
  ColorRGBA color{};
  Duration lifetime{};
  bool frame_locked = false;
  std::vector<Point> points{};
  std::vector<ColorRGBA> colors{};
  std::string texture_resource{};
  CompressedImage texture{};
  std::vector<UVCoordinate> uv_coordinates{};
  std::string text{};
  std::string mesh_resource{};
  MeshFile mesh_file{};
  bool mesh_use_embedded_materials = false;
  static void fields(auto& m, auto& visit) {
    visit("header", m.header);
    visit("ns", m.ns);
    visit("id", m.id);
    visit("type", m.type);
    visit("action", m.action);
    visit("pose", m.pose);
    visit("scale", m.scale);
    visit("color", m.color);
    visit("lifetime", m.lifetime);
    visit("frame_locked", m.frame_locked);
    visit("points", m.points);
    visit("colors", m.colors);
    visit("texture_resource", m.texture_resource);
    visit("texture", m.texture);
    visit("uv_coordinates", m.uv_coordinates);
    visit("text", m.text);
    visit("mesh_resource", m.mesh_resource);
    visit("mesh_file", m.mesh_file);
    visit("mesh_use_embedded_materials", m.mesh_use_embedded_materials);
  }
};
struct MarkerArray {
  static constexpr std::string_view name = "visualization_msgs/msg/MarkerArray";
  std::vector<Marker> markers{};
  static void fields(auto& m, auto& visit) { visit("markers", m.markers); }
};

// ---- vision_msgs ----

struct Point2D {
  static constexpr std::string_view name = "vision_msgs/msg/Point2D";
  double x = 0, y = 0;
  static void fields(auto& m, auto& visit) {
    visit("x", m.x);
    visit("y", m.y);
  }
};
struct Pose2D {
  static constexpr std::string_view name = "vision_msgs/msg/Pose2D";
  Point2D position{};
  double theta = 0;
  static void fields(auto& m, auto& visit) {
    visit("position", m.position);
    visit("theta", m.theta);
  }
};
struct BoundingBox2D {
  static constexpr std::string_view name = "vision_msgs/msg/BoundingBox2D";
  Pose2D center{};
  double size_x = 0, size_y = 0;
  static void fields(auto& m, auto& visit) {
    visit("center", m.center);
    visit("size_x", m.size_x);
    visit("size_y", m.size_y);
  }
};
struct BoundingBox3D {
  static constexpr std::string_view name = "vision_msgs/msg/BoundingBox3D";
  Pose center{};
  Vector3 size{};
  static void fields(auto& m, auto& visit) {
    visit("center", m.center);
    visit("size", m.size);
  }
};
struct ObjectHypothesis {
  static constexpr std::string_view name = "vision_msgs/msg/ObjectHypothesis";
  std::string class_id{};
  double score = 0;
  static void fields(auto& m, auto& visit) {
    visit("class_id", m.class_id);
    visit("score", m.score);
  }
};
struct ObjectHypothesisWithPose {
  static constexpr std::string_view name = "vision_msgs/msg/ObjectHypothesisWithPose";
  ObjectHypothesis hypothesis{};
  PoseWithCovariance pose{};
  static void fields(auto& m, auto& visit) {
    visit("hypothesis", m.hypothesis);
    visit("pose", m.pose);
  }
};
struct Detection2D {
  static constexpr std::string_view name = "vision_msgs/msg/Detection2D";
  Header header{};
  std::vector<ObjectHypothesisWithPose> results{};
  BoundingBox2D bbox{};
  std::string id{};
  static void fields(auto& m, auto& visit) {
    visit("header", m.header);
    visit("results", m.results);
    visit("bbox", m.bbox);
    visit("id", m.id);
  }
};
struct Detection2DArray {
  static constexpr std::string_view name = "vision_msgs/msg/Detection2DArray";
  Header header{};
  std::vector<Detection2D> detections{};
  static void fields(auto& m, auto& visit) {
    visit("header", m.header);
    visit("detections", m.detections);
  }
};
struct Detection3D {
  static constexpr std::string_view name = "vision_msgs/msg/Detection3D";
  Header header{};
  std::vector<ObjectHypothesisWithPose> results{};
  BoundingBox3D bbox{};
  std::string id{};
  static void fields(auto& m, auto& visit) {
    visit("header", m.header);
    visit("results", m.results);
    visit("bbox", m.bbox);
    visit("id", m.id);
  }
};
struct Detection3DArray {
  static constexpr std::string_view name = "vision_msgs/msg/Detection3DArray";
  Header header{};
  std::vector<Detection3D> detections{};
  static void fields(auto& m, auto& visit) {
    visit("header", m.header);
    visit("detections", m.detections);
  }
};

// ---- logs and states ----

struct Log {
  static constexpr std::string_view name = "rcl_interfaces/msg/Log";
  static constexpr std::string_view constants = "byte DEBUG=10\nbyte INFO=20\nbyte WARN=30\nbyte ERROR=40\nbyte FATAL=50\n";
  Time stamp{};
  std::uint8_t level = 20;
  std::string logger{}, msg{}, file{}, function{};
  std::uint32_t line = 0;
  static void fields(auto& m, auto& visit) {
    visit("stamp", m.stamp);
    visit("level", m.level);
    visit("name", m.logger);
    visit("msg", m.msg);
    visit("file", m.file);
    visit("function", m.function);
    visit("line", m.line);
  }
};
struct KeyValue {
  static constexpr std::string_view name = "diagnostic_msgs/msg/KeyValue";
  std::string key{}, value{};
  static void fields(auto& m, auto& visit) {
    visit("key", m.key);
    visit("value", m.value);
  }
};
struct DiagnosticStatus {
  static constexpr std::string_view name = "diagnostic_msgs/msg/DiagnosticStatus";
  static constexpr std::string_view constants = "byte OK=0\nbyte WARN=1\nbyte ERROR=2\nbyte STALE=3\n";
  Byte level{0};
  std::string subject{}, message{}, hardware_id{};
  std::vector<KeyValue> values{};
  static void fields(auto& m, auto& visit) {
    visit("level", m.level);
    visit("name", m.subject);
    visit("message", m.message);
    visit("hardware_id", m.hardware_id);
    visit("values", m.values);
  }
};
struct DiagnosticArray {
  static constexpr std::string_view name = "diagnostic_msgs/msg/DiagnosticArray";
  Header header{};
  std::vector<DiagnosticStatus> status{};
  static void fields(auto& m, auto& visit) {
    visit("header", m.header);
    visit("status", m.status);
  }
};

}  // namespace ros
