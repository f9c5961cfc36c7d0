// Payloads of the served interfaces, and their encoding. Lengths m, angles rad, counter-clockwise positive, x forward. decode returns
// nothing for bytes that are not exactly the structure. Values; any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "protocol/message.h"
#include "protocol/xdr.h"

namespace player {

struct Pose2d {
  double x = 0, y = 0, a = 0;
};
struct Pose3d {
  double x = 0, y = 0, z = 0, roll = 0, pitch = 0, yaw = 0;
};
struct Point3d {
  double x = 0, y = 0, z = 0;
};
// In the order of the wire: y extent, x extent, z extent.
struct Size3d {
  double width = 0, length = 0, height = 0;
};

void put(XdrWriter& out, const Pose2d& pose);
void put(XdrWriter& out, const Pose3d& pose);
void put(XdrWriter& out, const Size3d& size);
void put(XdrWriter& out, const Address& address);  // 16 bytes with host and robot
Pose2d take_pose2d(XdrReader& in);
Pose3d take_pose3d(XdrReader& in);
Address take_address(XdrReader& in);

// ---- player ----
struct DeviceRequest {
  Address address;
  std::uint32_t access = 0;  // Access, or anything else
  std::string driver;        // at most 63 characters
};
std::string encode(const DeviceRequest& request);
std::optional<DeviceRequest> decode_device_request(std::string_view payload);

struct DriverInfo {
  Address address;
  std::string driver;
};
std::string encode(const DriverInfo& info);
std::optional<DriverInfo> decode_driver_info(std::string_view payload);

// Of an authentication: at most 32 characters.
std::optional<std::string> decode_key(std::string_view payload);
std::string encode_key(std::string_view key);

std::string encode_device_list(const std::vector<Address>& devices);

// -1: any.
struct ReplaceRule {
  std::int32_t interface = -1, index = -1, type = -1, subtype = -1;
  std::int32_t replace = 0;  // 0 keep all, 1 the newest replaces the one before, 2 drop
};
std::optional<ReplaceRule> decode_replace_rule(std::string_view payload);

// ---- what each interface has (universal_request) ----
struct Capability {
  std::uint32_t type = 0, subtype = 0;
};
std::optional<Capability> decode_capability(std::string_view payload);
using PropertyValue = std::variant<std::int32_t, double, std::string, bool>;
struct DriverProperty {
  std::string key;
  PropertyValue value;
};
std::string encode(const DriverProperty& property);
// The type of the value is that of the request. Nothing for capabilities.
std::optional<DriverProperty> decode_driver_property(std::uint8_t subtype, std::string_view payload);

// ---- position2d (data 1, command 1), position3d (the same numbers) ----
struct Position2dState {
  Pose2d pose, velocity;
  bool is_stalled = false;
};
std::string encode(const Position2dState& state);
std::optional<Position2dState> decode_position2d_state(std::string_view payload);
struct Position3dState {
  Pose3d pose, velocity;
  bool is_stalled = false;
};
std::string encode(const Position3dState& state);
struct Velocity2d {
  Pose2d velocity;
  bool is_enabled = true;  // motors
};
std::string encode(const Velocity2d& velocity);
std::optional<Velocity2d> decode_velocity2d(std::string_view payload);
struct PoseCommand2d {
  Pose2d pose, velocity;  // where to, and how fast at most; 0: as the server likes
  bool is_enabled = true;
};
std::optional<PoseCommand2d> decode_pose_command2d(std::string_view payload);
struct PoseCommand3d {
  Pose3d pose, velocity;
  bool is_enabled = true;
};
std::optional<PoseCommand3d> decode_pose_command3d(std::string_view payload);
struct HeadingCommand {
  double speed = 0, angle = 0;
};
std::optional<HeadingCommand> decode_heading_command(std::string_view payload);
struct Pid {
  float p = 0, i = 0, d = 0;
};
std::optional<Pid> decode_pid(std::string_view payload);
struct SpeedProfile {
  float speed = 0, acceleration = 0;
};
std::optional<SpeedProfile> decode_speed_profile(std::string_view payload);
std::optional<Pose3d> decode_velocity3d(std::string_view payload);
std::optional<Pose2d> decode_pose2d(std::string_view payload);
std::optional<Pose3d> decode_pose3d(std::string_view payload);

// Pose and size: GET_GEOM of position2d, position3d and laser.
std::string encode_geometry(const Pose3d& pose, const Size3d& size);

// One byte in its cell: power, motor power, data type.
std::optional<std::uint8_t> decode_byte(std::string_view payload);
std::optional<std::uint32_t> decode_u32(std::string_view payload);
std::string encode_u32(std::uint32_t value);

// ---- laser ----
struct LaserScan {
  float min_angle = 0, max_angle = 0, resolution = 0, max_range = 0;
  std::vector<float> ranges;  // never negative, never NaN: clients abort on them
  std::string intensities;    // a byte per range, or none
  std::uint32_t id = 0;
};
std::string encode(const LaserScan& scan);
std::optional<LaserScan> decode_laser_scan(std::string_view payload);
struct LaserConfig {
  float min_angle = 0, max_angle = 0, resolution = 0, max_range = 0, range_resolution = 0;
  bool has_intensity = false;
  float rate = 0;  // [Hz]
};
std::string encode(const LaserConfig& config);
std::optional<LaserConfig> decode_laser_config(std::string_view payload);

// ---- ranger ----
struct RangerGeometry {
  Pose3d pose;
  Size3d size;
  std::vector<Pose3d> element_poses;
  std::vector<Size3d> element_sizes;
};
std::string encode(const RangerGeometry& geometry);
struct RangerConfig {
  double min_angle = 0, max_angle = 0, resolution = 0, min_range = 0, max_range = 0, range_resolution = 0, rate = 0;
};
std::string encode(const RangerConfig& config);
std::optional<RangerConfig> decode_ranger_config(std::string_view payload);
std::string encode_ranger_values(const std::vector<double>& values);

// ---- sonar ----
std::string encode_sonar_ranges(const std::vector<float>& ranges);
std::string encode_poses(const std::vector<Pose3d>& poses);

// ---- actarray ----
struct Actuator {
  float position = 0, speed = 0, acceleration = 0, current = 0;
  std::uint8_t state = 1;  // idle 1, moving 2, braked 4, stalled 8
};
std::string encode(const std::vector<Actuator>& actuators, bool is_powered);
struct ActuatorGeometry {
  bool turns = true;
  float length = 0;    // to the next one
  Pose3d orientation;  // of the next one; its angles count
  Point3d axis;
  float min = 0, centre = 0, max = 0, home = 0, speed = 0;
};
std::string encode(const std::vector<ActuatorGeometry>& actuators, const Pose3d& base);
struct JointNumber {
  std::int32_t joint = 0;
  float value = 0;
};
// A position, speed, current, highest speed or acceleration of one joint.
std::optional<JointNumber> decode_joint_number(std::string_view payload);
std::optional<std::int32_t> decode_joint(std::string_view payload);
std::optional<std::vector<float>> decode_joint_numbers(std::string_view payload);

// ---- limb ----
struct LimbPose {
  Point3d position, approach, orientation;
};
struct LimbState {
  LimbPose pose;
  std::uint8_t state = 1;  // idle 1, braked 2, moving 3, out of reach 4, collision 5
};
std::string encode(const LimbState& state);
std::string encode(const Point3d& point);
std::optional<LimbPose> decode_limb_pose(std::string_view payload);
std::optional<Point3d> decode_point(std::string_view payload);
struct VectorMove {
  Point3d direction;
  float length = 0;
};
std::optional<VectorMove> decode_vector_move(std::string_view payload);
std::optional<float> decode_float(std::string_view payload);

// ---- gripper ----
struct GripperState {
  std::uint8_t state = 1;  // open 1, closed 2, moving 3, error 4
};
std::string encode(const GripperState& state);
std::string encode_gripper_geometry(const Pose3d& pose, const Size3d& outer, const Size3d& inner);

// ---- ptz ----
struct PtzState {
  float pan = 0, tilt = 0, zoom = 0, pan_speed = 0, tilt_speed = 0;  // zoom: field of view
};
std::string encode(const PtzState& state);
std::optional<PtzState> decode_ptz_command(std::string_view payload);

// ---- aio ----
std::string encode_voltages(const std::vector<double>& values);

// ---- pointcloud3d ----
std::string encode_points(const std::vector<Point3d>& points);  // all white

// ---- camera ----
enum class ImageFormat : std::uint32_t { mono8 = 1, mono16 = 2, rgb888 = 5 };
struct Image {
  std::uint32_t width = 0, height = 0, bits = 0;
  ImageFormat format = ImageFormat::rgb888;
  std::string pixels;  // rows from the top, without gaps; or a JPEG file, when it is compressed
  bool is_compressed = false;
};
void put(XdrWriter& out, const Image& image);
std::string encode(const Image& image);
std::string encode_camera_source(std::string_view norm, std::int32_t source);

// ---- simulation ----
struct NamedPose2d {
  std::string name;
  Pose2d pose;
};
std::string encode(const NamedPose2d& request);
std::optional<NamedPose2d> decode_named_pose2d(std::string_view payload);
struct NamedPose3d {
  std::string name;
  Pose3d pose;
  double sim_time = 0;
};
std::string encode(const NamedPose3d& request);
std::optional<NamedPose3d> decode_named_pose3d(std::string_view payload);
struct Property {
  std::string name, property;
  std::uint32_t index = 0;
  std::string value;  // raw bytes in the order of the host
};
std::string encode(const Property& request);
std::optional<Property> decode_property(std::string_view payload);

// ---- gps ----
struct GpsState {
  std::uint32_t seconds = 0, microseconds = 0;
  std::int32_t latitude = 0, longitude = 0;                       // [degree * 1e7]
  std::int32_t altitude = 0;                                      // [mm]
  double speed = 0, course = 0;                                   // [m/s], clockwise from north
  double utm_east = 0, utm_north = 0;                             // [cm], as client libraries read them
  std::uint32_t quality = 0, satellites = 0, hdop = 0, vdop = 0;  // dop * 10
  double horizontal_error = 0, vertical_error = 0;
};
std::string encode(const GpsState& state);

// ---- imu ----
struct ImuCalibrated {
  float acceleration[3] = {}, angular_velocity[3] = {}, magnetic_field[3] = {};
};
void put(XdrWriter& out, const ImuCalibrated& values);

// ---- power ----
struct PowerState {
  float volts = 0, percent = 0, joules = 0, watts = 0;  // stored; negative: taken
  std::int32_t charging = 0;                            // 1 yes, -1 no, 0 not known
};
std::string encode(const PowerState& state);
struct ChargingPolicy {
  bool has_input = false, has_output = true;
};
std::optional<ChargingPolicy> decode_charging_policy(std::string_view payload);

// ---- rfid ----
std::string encode_tags(const std::vector<std::string>& ids);

// ---- wifi ----
struct WifiLink {
  std::string name;  // of the transmitter, in place of its MAC address
  std::string essid;
  std::uint32_t frequency = 0;  // [MHz]
  int level = 0;                // [dBm]
};
std::string encode_links(const std::vector<WifiLink>& links);

// ---- localize ----
struct Hypothesis {
  Pose2d mean;
  double covariance[6] = {};  // xx, yy, aa, xy, ya, xa
  double weight = 0;
};
std::string encode_hypotheses(double time, const std::vector<Hypothesis>& hypotheses);
std::string encode_particles(const std::vector<Hypothesis>& hypotheses);

// ---- map ----
struct MapTile {
  std::uint32_t column = 0, row = 0, width = 0, height = 0;  // [cell]
};
// `origin`: the corner of cell (0, 0).
std::string encode_map_info(double scale, std::uint32_t width, std::uint32_t height, const Pose2d& origin);
std::optional<MapTile> decode_map_tile(std::string_view payload);
// `packed`: the cells as a stream of zlib.
std::string encode_map_tile(const MapTile& tile, std::string_view packed);
struct Segment {
  double x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};
std::string encode_map_lines(const std::vector<Segment>& lines);

// ---- vectormap ----
// Of one layer, which has the extent of the map.
std::string encode_vectormap_info(std::string_view layer, const Segment& extent);
// Each line is a feature: a line string in well known binary.
std::string encode_vectormap_layer(std::string_view layer, const std::vector<Segment>& lines);
// The name of the layer that is asked for.
std::optional<std::string> decode_vectormap_layer(std::string_view payload);

// ---- planner ----
struct PlannerState {
  bool is_valid = false, is_done = false;
  Pose2d pose, goal, waypoint;
  std::int32_t index = -1;  // of the way point; -1: none
  std::uint32_t count = 0;
};
std::string encode(const PlannerState& state);
std::string encode_waypoints(double length, const std::vector<Pose2d>& waypoints);

// ---- stereo ----
struct ColoredPoint {
  Point3d at;
  std::array<std::uint8_t, 3> color{};  // red, green, blue
};
std::string encode_stereo(const Image& left, const Image& right, const Image& disparity, const std::vector<ColoredPoint>& points);

// ---- opaque ----
std::optional<std::string> decode_opaque(std::string_view payload);
std::string encode_opaque(std::string_view bytes);

// ---- graphics2d, graphics3d ----
struct Color {
  std::uint8_t alpha = 255, red = 0, green = 0, blue = 0;
};
struct Point2d {
  double x = 0, y = 0;
};
struct Shape2d {
  std::vector<Point2d> points;
  Color color, fill;  // of a polygon
  bool is_filled = false;
};
// Also of a polyline and of lines.
std::optional<Shape2d> decode_points(std::string_view payload);
std::optional<Shape2d> decode_polygon(std::string_view payload);
struct Drawing {
  enum class Mode : std::uint32_t {
    points,
    lines,
    line_strip,
    line_loop,
    triangles,
    triangle_strip,
    triangle_fan,
    quads,
    quad_strip,
    polygon
  } mode = Mode::points;
  std::vector<Point3d> points;
  Color color;
};
std::optional<Drawing> decode_drawing(std::string_view payload);
struct Rotation {
  double angle = 0;
  Point3d axis;
};
std::optional<Rotation> decode_rotation(std::string_view payload);

// ---- dio ----
std::string encode_bits(const std::vector<bool>& bits);

// ---- bumper ----
std::string encode_bumpers(const std::vector<bool>& pressed);
struct BumperShape {
  Pose3d pose;
  float length = 0, radius = 0;
};
std::string encode_bumper_shapes(const std::vector<BumperShape>& shapes);

// ---- fiducial, blobfinder ----
struct FiducialItem {
  std::int32_t id = -1;
  Pose3d pose, uncertainty;  // in the detector
};
std::string encode_fiducials(const std::vector<FiducialItem>& items);
// `width`, `height`: of a mark [m].
std::string encode_fiducial_geometry(const Pose3d& pose, double width, double height);
std::string encode_fiducial_fov(double min_range, double max_range, double view_angle);

struct Blob {
  std::uint32_t id = 0, color = 0;                                                 // 0x00RRGGBB
  std::uint32_t area = 0, x = 0, y = 0, left = 0, right = 0, top = 0, bottom = 0;  // [pixel] from the left and the top
  float range = 0;                                                                 // [m]; 0: not known
};
std::string encode_blobs(std::uint32_t width, std::uint32_t height, const std::vector<Blob>& blobs);

}  // namespace player
