// C++ names and enums of what lies in shared memory (rtmsim_layout.h), with the offsets pinned. Plain data; no thread rule.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "shm/rtmsim_layout.h"

namespace shm {

using ProcessMark = ::rtmsim_process;
using Area = ::rtmsim_area;
using Header = ::rtmsim_header;
using Lease = ::rtmsim_lease;
using Command = ::rtmsim_command;
using Stamp = ::rtmsim_stamp;
using Pose = ::rtmsim_pose;
using Part = ::rtmsim_part;
using SimulationInfo = ::rtmsim_simulation_info;
using SimulationSample = ::rtmsim_simulation_sample;
using LaserInfo = ::rtmsim_laser_info;
using LaserSample = ::rtmsim_laser_sample;
using SonarInfo = ::rtmsim_sonar_info;
using SonarSample = ::rtmsim_sonar_sample;
using Position2dInfo = ::rtmsim_position2d_info;
using Position2dSample = ::rtmsim_position2d_sample;
using Position3dInfo = ::rtmsim_position3d_info;
using Position3dSample = ::rtmsim_position3d_sample;
using CameraInfo = ::rtmsim_camera_info;
using FrameHead = ::rtmsim_frame;
using ImuInfo = ::rtmsim_imu_info;
using ImuSample = ::rtmsim_imu_sample;
using GpsInfo = ::rtmsim_gps_info;
using GpsSample = ::rtmsim_gps_sample;
using BumperInfo = ::rtmsim_bumper_info;
using Contact = ::rtmsim_contact;
using BumperSample = ::rtmsim_bumper_sample;
using MeterInfo = ::rtmsim_meter_info;
using ForceTorqueSample = ::rtmsim_force_torque_sample;
using AltimeterSample = ::rtmsim_altimeter_sample;
using MagnetometerSample = ::rtmsim_magnetometer_sample;
using AirPressureSample = ::rtmsim_air_pressure_sample;
using TruthInfo = ::rtmsim_truth_info;
using TruthSample = ::rtmsim_truth_sample;
using RequestBody = ::rtmsim_request_body;
using ReplyBody = ::rtmsim_reply_body;
using RequestSlot = ::rtmsim_request_slot;
using Control = ::rtmsim_control;
using ParticipantSlot = ::rtmsim_participant;

inline constexpr std::uint32_t layout_version = RTMSIM_LAYOUT_VERSION;
inline constexpr std::size_t max_name_length = 200;
inline constexpr std::size_t text_piece = RTMSIM_TEXT_PIECE;
inline constexpr unsigned max_holds = RTMSIM_HOLDS;
inline constexpr Pose identity_pose{0, 0, 0, 1, 0, 0, 0};

enum class IfaceType : std::uint32_t {
  simulation = RTMSIM_SIMULATION,
  laser = RTMSIM_LASER,
  sonar = RTMSIM_SONAR,
  position2d = RTMSIM_POSITION2D,
  position3d = RTMSIM_POSITION3D,
  camera = RTMSIM_CAMERA,
  depth = RTMSIM_DEPTH,
  points = RTMSIM_POINTS,
  imu = RTMSIM_IMU,
  gps = RTMSIM_GPS,
  bumper = RTMSIM_BUMPER,
  truth = RTMSIM_TRUTH,
  force_torque = RTMSIM_FORCE_TORQUE,
  altimeter = RTMSIM_ALTIMETER,
  magnetometer = RTMSIM_MAGNETOMETER,
  air_pressure = RTMSIM_AIR_PRESSURE,
};

inline constexpr std::array<std::string_view, 17> type_names = {
    "",    "simulation", "laser",  "sonar", "position2d",   "position3d", "camera",       "depth",       "points",
    "imu", "gps",        "bumper", "truth", "force_torque", "altimeter",  "magnetometer", "air_pressure"};

constexpr bool is_type(std::uint32_t type) { return type >= 1 && type < type_names.size(); }
constexpr std::string_view to_text(IfaceType type) {
  return is_type(static_cast<std::uint32_t>(type)) ? type_names[static_cast<std::size_t>(type)] : "?";
}
constexpr std::optional<IfaceType> parse_type(std::string_view name) {
  for (std::size_t i = 1; i < type_names.size(); ++i) {
    if (type_names[i] == name) return static_cast<IfaceType>(i);
  }
  return std::nullopt;
}
// Camera, depth and points publish frames; all others publish samples.
constexpr bool has_frames(IfaceType type) { return type == IfaceType::camera || type == IfaceType::depth || type == IfaceType::points; }

enum class AreaIndex : std::size_t {
  info = RTMSIM_AREA_INFO,
  cells = RTMSIM_AREA_CELLS,
  frames = RTMSIM_AREA_FRAMES,
  leases = RTMSIM_AREA_LEASES,
  control = RTMSIM_AREA_CONTROL,
  requests = RTMSIM_AREA_REQUESTS,
  participants = RTMSIM_AREA_PARTICIPANTS,
};

enum class CommandKind : std::uint32_t { stop = RTMSIM_COMMAND_STOP, velocity = RTMSIM_COMMAND_VELOCITY, pose = RTMSIM_COMMAND_POSE };

enum class Format : std::uint32_t {
  rgb8 = RTMSIM_FORMAT_RGB8,
  mono8 = RTMSIM_FORMAT_MONO8,
  depth_float = RTMSIM_FORMAT_DEPTH_FLOAT,
  points_float = RTMSIM_FORMAT_POINTS_FLOAT,
  points_intensity_float = RTMSIM_FORMAT_POINTS_INTENSITY_FLOAT,
  bgr8 = RTMSIM_FORMAT_BGR8,
  rgba8 = RTMSIM_FORMAT_RGBA8,
  bgra8 = RTMSIM_FORMAT_BGRA8,
  mono16 = RTMSIM_FORMAT_MONO16,
  bayer_rggb8 = RTMSIM_FORMAT_BAYER_RGGB8,
  bayer_bggr8 = RTMSIM_FORMAT_BAYER_BGGR8,
  bayer_gbrg8 = RTMSIM_FORMAT_BAYER_GBRG8,
  bayer_grbg8 = RTMSIM_FORMAT_BAYER_GRBG8,
};
// Bytes of a pixel or point; 0 for an unknown format.
constexpr std::uint32_t bytes_per_pixel(Format format) {
  switch (format) {
    case Format::rgb8:
    case Format::bgr8:
      return 3;
    case Format::mono8:
    case Format::bayer_rggb8:
    case Format::bayer_bggr8:
    case Format::bayer_gbrg8:
    case Format::bayer_grbg8:
      return 1;
    case Format::mono16:
      return 2;
    case Format::depth_float:
    case Format::rgba8:
    case Format::bgra8:
      return 4;
    case Format::points_float:
      return 12;
    case Format::points_intensity_float:
      return 16;
  }
  return 0;
}

static_assert(sizeof(Header) == 1024 && offsetof(Header, server) == 32 && offsetof(Header, areas) == 320 &&
              offsetof(Header, state) == 512 && offsetof(Header, sequence) == 576 && offsetof(Header, wake_word) == 592);
static_assert(sizeof(Lease) == 256 && offsetof(Lease, holds) == 64 && offsetof(Lease, command_lock) == 128 && sizeof(Command) == 120);
static_assert(sizeof(Stamp) == 32 && sizeof(Pose) == 56 && sizeof(Part) == 40);
static_assert(sizeof(SimulationInfo) == 696 && sizeof(SimulationSample) == 600);
static_assert(sizeof(LaserInfo) == 272 && sizeof(LaserSample) == 96 && sizeof(SonarInfo) == 232 && sizeof(SonarSample) == 40);
static_assert(sizeof(Position2dInfo) == 272 && sizeof(Position2dSample) == 200);
static_assert(sizeof(Position3dInfo) == 240 && sizeof(Position3dSample) == 304);
static_assert(sizeof(CameraInfo) == 320 && sizeof(FrameHead) == 128);
static_assert(sizeof(ImuInfo) == 208 && sizeof(ImuSample) == 112 && sizeof(GpsInfo) == 248 && sizeof(GpsSample) == 80);
static_assert(sizeof(BumperInfo) == 200 && sizeof(Contact) == 192 && sizeof(BumperSample) == 40);
static_assert(sizeof(MeterInfo) == 344 && sizeof(ForceTorqueSample) == 80 && sizeof(AltimeterSample) == 48);
static_assert(sizeof(MagnetometerSample) == 56 && sizeof(AirPressureSample) == 40);
static_assert(sizeof(TruthInfo) == 128 && sizeof(TruthSample) == 136);
static_assert(sizeof(RequestBody) == 408 && sizeof(ReplyBody) == 416 && sizeof(RequestSlot) == 1024 && offsetof(RequestSlot, body) == 64);
static_assert(sizeof(Control) == 192 && offsetof(Control, pending) == 64 && offsetof(Control, tick_words) == 128);
static_assert(sizeof(ParticipantSlot) == 256 && offsetof(ParticipantSlot, go) == 128 && offsetof(ParticipantSlot, done) == 192);

}  // namespace shm
