// The constant description of a sensor: what it measures, how often, with which noise. The rules of world_def.h hold: names resolved,
// numbers finite and within bounds; m, rad, s. Values: any thread may read a shared one.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "world/pixel_format.h"
#include "world/plugin_def.h"

namespace sim {

struct NoiseDef {
  enum class Kind { none, gaussian, gaussian_quantized };
  Kind kind = Kind::none;
  double mean = 0, stddev = 0;
  double bias_mean = 0, bias_stddev = 0;
  double dynamic_bias_stddev = 0, dynamic_bias_correlation_time = 0;
  double precision = 0;  // gaussian_quantized: step of the output
};

struct ScanDef {
  int samples = 1;
  double resolution = 1;  // simulated rays per returned sample
  double min_angle = 0, max_angle = 0;
};

// Planar or layered range finder.
struct RayDef {
  ScanDef horizontal, vertical;
  double range_min = 0, range_max = 10;
  double range_resolution = 0;  // 0: none
  NoiseDef noise;
  std::uint32_t visibility_mask = 0xffffffff;
  bool is_rolling = false;  // the beams of a scan are from its whole period, as of a scanner that turns; else from one instant
};

// Brown's distortion.
struct DistortionDef {
  double k1 = 0, k2 = 0, k3 = 0, p1 = 0, p2 = 0;
  Eigen::Vector2d center{0.5, 0.5};
};
struct LensDef {
  std::string type = "gnomonical";  // stereographic, gnomonical, equidistant, equisolid_angle, orthographic, custom
  bool scale_to_fov = true;
  double cutoff_angle = 1.5707963267948966;
  int environment_texture_size = 256;
  double c1 = 1, c2 = 1, c3 = 0, f = 1;  // custom
  std::string function = "tan";          // custom: sin, tan, id
};
// What a box of a bounding box camera is around, as RTMSIM_BOX_* has it.
enum class BoxKind { visible = 1, full = 2, oriented = 3 };
// How a thermal camera counts. Temperatures beyond the range are at its ends.
struct ThermalDef {
  bool is_wide = true;                                     // 16 bits a pixel, else 8
  double resolution = 0.01, lowest = 0, highest = 655.35;  // [K]
};
struct CameraDef {
  std::string name;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  // in the sensor; looks along +x, z up
  double horizontal_fov = 1.047;
  int width = 320, height = 240;
  PixelFormat format = PixelFormat::rgb8;  // of the colours; depth is always float
  double near_clip = 0.1, far_clip = 100;
  std::optional<std::pair<double, double>> depth_clip;  // depth and rgbd cameras
  NoiseDef noise;
  std::optional<DistortionDef> distortion;
  std::optional<LensDef> lens;  // empty: pinhole
  std::uint32_t visibility_mask = 0xffffffff;
  bool has_instances = false;        // segmentation: each object has a number
  BoxKind boxes = BoxKind::visible;  // bounding box camera
  ThermalDef thermal;
};
// One camera, or several taken at the same time (multicamera).
struct CameraSetDef {
  std::vector<CameraDef> cameras;
};

// Models whose origin is in the frustum along x.
struct LogicalCameraDef {
  double near_clip = 0, far_clip = 1, horizontal_fov = 1, aspect_ratio = 1;
};
// Detector of marks (plugin Fiducial of models).
struct FiducialDef {
  double range_min = 0, range_max = 8;
  double view_angle = 3.141592653589793;  // centred on x
  NoiseDef position, orientation;         // of each coordinate [m], of each angle [rad]
};

struct SonarDef {
  double range_min = 0, range_max = 5;
  double radius = 0.5;  // of the cone at range_max
};
struct ImuDef {
  enum class Reference { world, enu, ned, nwu, custom };  // what the orientation is told against
  Reference reference = Reference::world;
  Eigen::Matrix3d custom_axes = Eigen::Matrix3d::Identity();      // columns: axes of a custom frame in the world
  std::array<NoiseDef, 3> angular_velocity, linear_acceleration;  // x, y, z
  bool has_orientation = true;
};
struct GpsDef {
  NoiseDef horizontal_position, vertical_position, horizontal_velocity, vertical_velocity;
};
struct ContactDef {
  std::vector<std::string> collisions;  // names within the sensor's link; all exist
};
struct ForceTorqueDef {
  enum class Frame { child, parent, sensor };
  std::string joint;  // name in the model when the sensor stands in a joint; empty otherwise
  Frame frame = Frame::child;
  bool measures_parent_to_child = false;
  std::array<NoiseDef, 3> force, torque;
};
struct AltimeterDef {
  NoiseDef vertical_position, vertical_velocity;
};
struct MagnetometerDef {
  std::array<NoiseDef, 3> field;
};
struct AirPressureDef {
  NoiseDef pressure;
  double reference_altitude = 0;
};

// Doppler velocity log: beams of sound that look down, along -z.
struct DvlDef {
  struct Beam {
    double aperture = 1.5707963267948966;  // full opening angle of its cone
    double rotation = 0, tilt = 0;         // about -z, after it was tilted away from -z
  };
  std::vector<Beam> beams;  // at least three
  double range_min = 0.1, range_max = 100;
  Eigen::Isometry3d reference = Eigen::Isometry3d::Identity();  // frame in the sensor that the velocity is told in
  NoiseDef speed;                                               // along a beam
};
struct AirSpeedDef {
  NoiseDef pressure;
};
struct InsDef {
  NoiseDef horizontal_position, vertical_position, horizontal_velocity, vertical_velocity, attitude, heading;
};
struct RfidDef {
  double range = 1;
  double angle = 6.283185307179586;  // full opening angle about x
  bool needs_sight = false;
};
struct RfidTagDef {
  std::string id, data;  // id empty: the scoped name of the sensor
};
// Receiver or transmitter.
struct RadioDef {
  std::string essid = "wireless";
  double frequency = 2442, min_frequency = 2412, max_frequency = 2484;  // [MHz]
  double gain = 2.5, power = 14.5, sensitivity = -90;                   // [dBi], [dBm], [dBm]
};
struct WheelsDef {
  std::vector<std::string> joints;  // as in the file
  double ticks = 500;               // in a turn of the wheel
};
struct LocalizationDef {
  NoiseDef position, heading;
  int hypotheses = 1;
};

enum class SensorKind {
  ray,  // ray, gpu_ray, lidar, gpu_lidar
  camera,
  depth_camera,
  rgbd_camera,
  multi_camera,
  contact,
  imu,
  gps,  // gps, navsat
  sonar,
  force_torque,
  altimeter,
  magnetometer,
  air_pressure,
  dvl,
  air_speed,
  ins,
  rfid,
  rfid_tag,
  wireless_receiver,
  wireless_transmitter,
  wheels,
  localization,
  segmentation_camera,
  box_camera,
  thermal_camera,
  logical_camera,
  fiducial,
};
std::string_view to_text(SensorKind kind);  // as the table of sensor_builder.cpp says it

struct SensorDef {
  std::string name;
  std::string scope;  // nested model it stands in, as in PluginDef
  std::string iface;  // what its iface is called after the model's name, see iface_names.h; empty: scope and name
  SensorKind kind = SensorKind::ray;
  std::string type;                                        // as written: "gpu_lidar"
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  // in the link
  double update_rate = 0;                                  // [Hz]; 0: every step
  bool always_on = false;
  bool visualize = false;
  std::string topic;
  std::variant<RayDef, CameraSetDef, ContactDef, ImuDef, GpsDef, SonarDef, ForceTorqueDef, AltimeterDef, MagnetometerDef, AirPressureDef,
               DvlDef, AirSpeedDef, InsDef, RfidDef, RfidTagDef, RadioDef, WheelsDef, LocalizationDef, LogicalCameraDef, FiducialDef>
      data;
  std::vector<PluginDef> plugins;
};

}  // namespace sim
