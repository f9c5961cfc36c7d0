// The table of iface types: number, name, constants, samples, trailing arrays, and every visible field with its unit. Lists, output,
// completion, checks and documentation of ifaces use it; the structures are in rtmsim_layout.h, for C. A new type needs an enumerator, its
// fields and its row. Constants; no thread rule.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "shm/iface_fields.h"

namespace shm {

// Of infos and samples; FrameHead is that of the frames of camera, depth and points.
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
using JointsInfo = ::rtmsim_joints_info;
using Joint = ::rtmsim_joint;
using JointState = ::rtmsim_joint_state;
using JointsSample = ::rtmsim_joints_sample;
using LogicalCameraInfo = ::rtmsim_logical_camera_info;
using SeenModel = ::rtmsim_seen_model;
using LogicalCameraSample = ::rtmsim_logical_camera_sample;
using BoxesInfo = ::rtmsim_boxes_info;
using Box = ::rtmsim_box;
using BoxesSample = ::rtmsim_boxes_sample;
using FiducialInfo = ::rtmsim_fiducial_info;
using Mark = ::rtmsim_mark;
using FiducialSample = ::rtmsim_fiducial_sample;
using BatteryInfo = ::rtmsim_battery_info;
using BatterySample = ::rtmsim_battery_sample;
using DvlInfo = ::rtmsim_dvl_info;
using DvlBeam = ::rtmsim_dvl_beam;
using DvlSample = ::rtmsim_dvl_sample;
using DvlEcho = ::rtmsim_dvl_echo;
using AirSpeedSample = ::rtmsim_air_speed_sample;
using InsInfo = ::rtmsim_ins_info;
using InsSample = ::rtmsim_ins_sample;
using RfidInfo = ::rtmsim_rfid_info;
using RfidTag = ::rtmsim_rfid_tag;
using RfidSample = ::rtmsim_rfid_sample;
using WirelessInfo = ::rtmsim_wireless_info;
using Radio = ::rtmsim_radio;
using WirelessSample = ::rtmsim_wireless_sample;
using WheelsInfo = ::rtmsim_wheels_info;
using Wheel = ::rtmsim_wheel;
using WheelsSample = ::rtmsim_wheels_sample;
using WheelState = ::rtmsim_wheel_state;
using LocalizationInfo = ::rtmsim_localization_info;
using Hypothesis = ::rtmsim_hypothesis;
using LocalizationSample = ::rtmsim_localization_sample;
using TruthInfo = ::rtmsim_truth_info;
using TruthSample = ::rtmsim_truth_sample;

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
  joints = RTMSIM_JOINTS,
  logical_camera = RTMSIM_LOGICAL_CAMERA,
  boxes = RTMSIM_BOXES,
  fiducial = RTMSIM_FIDUCIAL,
  battery = RTMSIM_BATTERY,
  dvl = RTMSIM_DVL,
  air_speed = RTMSIM_AIR_SPEED,
  ins = RTMSIM_INS,
  rfid = RTMSIM_RFID,
  wireless = RTMSIM_WIRELESS,
  wheels = RTMSIM_WHEELS,
  localization = RTMSIM_LOCALIZATION,
};

struct IfaceRow {
  IfaceType type;
  std::string_view name, meaning;
  std::size_t info_size;             // fixed part
  std::size_t oldest_info_size = 0;  // of older simulators, whose info ends earlier: the rest is 0; 0: as info_size
  std::size_t sample_size = 0;       // fixed part; a type without samples publishes frames
  std::span<const Field> info, sample;
  std::uint32_t command_values = 0;  // of each command, for types whose ifaces have all as many; 0: no commands, or the iface says
  std::uint64_t (*count)(const void* info) = nullptr;  // elements of an array of its tails, or pixels of a frame
  std::uint64_t most = 0;                              // of those; at least one
  Tail info_tail{}, sample_tail{};
  const void* (*filled)(const void* sample) = nullptr;  // u32: elements of the sample's arrays that are true, at most count
  bool is_always_full = false;                          // that is always count
};

namespace detail {

// --- infos and samples: the order is that in which they are printed

inline constexpr std::array simulation_info{field<&SimulationInfo::world>("world"),       field<&SimulationInfo::file>("file"),
                                            field<&SimulationInfo::step_ns>("step", "s"), field<&SimulationInfo::seed>("seed"),
                                            flag<&SimulationInfo::lockstep>("lockstep"),  field<&SimulationInfo::version>("version")};
inline constexpr std::array simulation_sample{
    field<&SimulationSample::stamp>("stamp"),       field<&SimulationSample::steps>("steps"),
    flag<&SimulationSample::paused>("paused"),      field<&SimulationSample::waiting_for>("waiting_for"),
    field<&SimulationSample::rtf_reached>("rtf"),   field<&SimulationSample::load>("load"),
    field<&SimulationSample::contacts>("contacts"), field<&SimulationSample::participants>("participants")};

inline constexpr std::array laser_info{field<&LaserInfo::model>("model"),
                                       field<&LaserInfo::beams>("beams"),
                                       field<&LaserInfo::layers>("layers"),
                                       field<&LaserInfo::min_angle>("min_angle", "rad"),
                                       field<&LaserInfo::max_angle>("max_angle", "rad"),
                                       field<&LaserInfo::angle_step>("angle_step", "rad"),
                                       field<&LaserInfo::min_vertical>("min_vertical", "rad"),
                                       field<&LaserInfo::max_vertical>("max_vertical", "rad"),
                                       field<&LaserInfo::min_range>("min_range", "m"),
                                       field<&LaserInfo::max_range>("max_range", "m"),
                                       field<&LaserInfo::range_step>("resolution", "m"),
                                       field<&LaserInfo::rate>("rate", "Hz"),
                                       field<&LaserInfo::noise>("noise", "m"),
                                       field<&LaserInfo::pose>("pose")};
inline constexpr std::array laser_sample{field<&LaserSample::stamp>("stamp"), followers("ranges", 0, "m"), followers("intensities", 1),
                                         field<&LaserSample::pose>("pose")};

inline constexpr std::array sonar_info{field<&SonarInfo::model>("model"),
                                       field<&SonarInfo::count>("count"),
                                       field<&SonarInfo::min_range>("min_range", "m"),
                                       field<&SonarInfo::max_range>("max_range", "m"),
                                       field<&SonarInfo::cone>("cone", "rad"),
                                       field<&SonarInfo::rate>("rate", "Hz"),
                                       field<&SonarInfo::noise>("noise", "m"),
                                       followers("poses", 0)};
inline constexpr std::array sonar_sample{field<&SonarSample::stamp>("stamp"), followers("ranges", 0, "m")};

inline constexpr std::array position2d_info{field<&Position2dInfo::model>("model"),
                                            field<&Position2dInfo::drive>("drive"),
                                            field<&Position2dInfo::size>("size", "m"),
                                            field<&Position2dInfo::max_speed>("max_speed", "m/s"),
                                            field<&Position2dInfo::max_yaw_rate>("max_yaw_rate", "rad/s"),
                                            field<&Position2dInfo::max_acceleration>("max_acceleration", "m/s^2"),
                                            field<&Position2dInfo::max_yaw_acceleration>("max_yaw_acceleration", "rad/s^2"),
                                            field<&Position2dInfo::wheel_separation>("wheel_separation", "m"),
                                            field<&Position2dInfo::wheel_radius>("wheel_radius", "m"),
                                            field<&Position2dInfo::wheel_base>("wheel_base", "m"),
                                            field<&Position2dInfo::max_steering_angle>("max_steering_angle", "rad"),
                                            field<&Position2dInfo::rate>("rate", "Hz"),
                                            field<&Position2dInfo::pose>("pose")};
inline constexpr std::array position2d_sample{field<&Position2dSample::stamp>("stamp"),
                                              field<&Position2dSample::odometry>("odometry", "m m rad"),
                                              field<&Position2dSample::velocity>("velocity", "m/s m/s rad/s"),
                                              field<&Position2dSample::true_pose>("true_pose"),
                                              field<&Position2dSample::true_velocity>("true_velocity", "m/s m/s rad/s"),
                                              field<&Position2dSample::command>("command", "m/s m/s rad/s"),
                                              flag<&Position2dSample::stalled>("stalled"),
                                              flag<&Position2dSample::motors_enabled>("motors_enabled"),
                                              flag<&Position2dSample::commanded>("commanded")};

inline constexpr std::array position3d_info{field<&Position3dInfo::model>("model"),
                                            field<&Position3dInfo::drive>("drive"),
                                            field<&Position3dInfo::size>("size", "m"),
                                            field<&Position3dInfo::max_speed>("max_speed", "m/s"),
                                            field<&Position3dInfo::max_yaw_rate>("max_yaw_rate", "rad/s"),
                                            field<&Position3dInfo::rate>("rate", "Hz"),
                                            field<&Position3dInfo::pose>("pose")};
inline constexpr std::array position3d_sample{field<&Position3dSample::stamp>("stamp"),
                                              field<&Position3dSample::odometry>("odometry"),
                                              field<&Position3dSample::velocity>("velocity", "m/s, rad/s"),
                                              field<&Position3dSample::true_pose>("true_pose"),
                                              field<&Position3dSample::command>("command", "m/s, rad/s"),
                                              flag<&Position3dSample::commanded>("commanded")};

// Of camera, depth and points; their samples are the heads of frames.
inline constexpr std::array camera_info{field<&CameraInfo::model>("model"),
                                        field<&CameraInfo::width>("width", "pixel"),
                                        field<&CameraInfo::height>("height", "pixel"),
                                        field<&CameraInfo::format>("format"),
                                        field<&CameraInfo::stride>("stride", "byte"),
                                        field<&CameraInfo::hfov>("hfov", "rad"),
                                        field<&CameraInfo::near_clip>("near", "m"),
                                        field<&CameraInfo::far_clip>("far", "m"),
                                        field<&CameraInfo::fx>("fx", "pixel"),
                                        field<&CameraInfo::fy>("fy", "pixel"),
                                        field<&CameraInfo::cx>("cx", "pixel"),
                                        field<&CameraInfo::cy>("cy", "pixel"),
                                        field<&CameraInfo::distortion>("distortion"),
                                        field<&CameraInfo::rate>("rate", "Hz"),
                                        field<&CameraInfo::noise>("noise"),
                                        field<&CameraInfo::pose>("pose")};
inline constexpr std::array frame_head{
    field<&FrameHead::stamp>("stamp"),   field<&FrameHead::width>("width", "pixel"), field<&FrameHead::height>("height", "pixel"),
    field<&FrameHead::format>("format"), field<&FrameHead::size>("size", "byte"),    field<&FrameHead::pose>("pose")};

inline constexpr std::array imu_info{field<&ImuInfo::model>("model"), field<&ImuInfo::rate>("rate", "Hz"),
                                     field<&ImuInfo::angular_velocity_noise>("angular_velocity_noise", "rad/s"),
                                     field<&ImuInfo::acceleration_noise>("acceleration_noise", "m/s^2"), field<&ImuInfo::pose>("pose")};
inline constexpr std::array imu_sample{field<&ImuSample::stamp>("stamp"), field<&ImuSample::orientation>("orientation"),
                                       field<&ImuSample::angular_velocity>("angular_velocity", "rad/s"),
                                       field<&ImuSample::acceleration>("acceleration", "m/s^2")};

inline constexpr std::array gps_info{field<&GpsInfo::model>("model"),
                                     field<&GpsInfo::rate>("rate", "Hz"),
                                     field<&GpsInfo::latitude>("latitude", "degree"),
                                     field<&GpsInfo::longitude>("longitude", "degree"),
                                     field<&GpsInfo::altitude>("altitude", "m"),
                                     field<&GpsInfo::heading>("heading", "rad"),
                                     field<&GpsInfo::position_noise>("position_noise", "m"),
                                     field<&GpsInfo::altitude_noise>("altitude_noise", "m"),
                                     field<&GpsInfo::pose>("pose")};
inline constexpr std::array gps_sample{field<&GpsSample::stamp>("stamp"), field<&GpsSample::latitude>("latitude", "degree"),
                                       field<&GpsSample::longitude>("longitude", "degree"), field<&GpsSample::altitude>("altitude", "m"),
                                       field<&GpsSample::velocity>("velocity", "m/s")};

inline constexpr std::array bumper_info{field<&BumperInfo::model>("model"),       field<&BumperInfo::rate>("rate", "Hz"),
                                        field<&BumperInfo::capacity>("capacity"), field<&BumperInfo::pose>("pose"),
                                        field<&BumperInfo::middle>("middle"),     field<&BumperInfo::size>("size", "m"),
                                        field<&BumperInfo::radius>("radius", "m")};
inline constexpr std::array bumper_sample{field<&BumperSample::stamp>("stamp"), field<&BumperSample::total>("total"),
                                          followers("contacts", 0)};
inline constexpr std::array contact_fields{field<&Contact::other>("other"), field<&Contact::position>("position", "m"),
                                           field<&Contact::normal>("normal"), field<&Contact::force>("force", "N"),
                                           field<&Contact::depth>("depth", "m")};

inline constexpr std::array meter_info{field<&MeterInfo::model>("model"), field<&MeterInfo::rate>("rate", "Hz"),
                                       field<&MeterInfo::noise>("noise"), field<&MeterInfo::reference>("reference", "m"),
                                       field<&MeterInfo::pose>("pose"),   field<&MeterInfo::joint>("joint")};
inline constexpr std::span meter_info_without_joint = std::span(meter_info).first<meter_info.size() - 1>();
inline constexpr std::array force_torque_sample{field<&ForceTorqueSample::stamp>("stamp"), field<&ForceTorqueSample::force>("force", "N"),
                                                field<&ForceTorqueSample::torque>("torque", "N m")};
inline constexpr std::array altimeter_sample{field<&AltimeterSample::stamp>("stamp"), field<&AltimeterSample::height>("height", "m"),
                                             field<&AltimeterSample::climb>("climb", "m/s")};
inline constexpr std::array magnetometer_sample{field<&MagnetometerSample::stamp>("stamp"),
                                                field<&MagnetometerSample::field>("field", "T")};
inline constexpr std::array air_pressure_sample{field<&AirPressureSample::stamp>("stamp"),
                                                field<&AirPressureSample::pressure>("pressure", "Pa")};

inline constexpr std::array joints_info{field<&JointsInfo::model>("model"), field<&JointsInfo::rate>("rate", "Hz"),
                                        field<&JointsInfo::count>("count"), followers("joints", 0)};
inline constexpr std::array joint_fields{field<&Joint::name>("name"),
                                         field<&Joint::id>("id"),
                                         field<&Joint::kind>("kind"),
                                         field<&Joint::link>("link"),
                                         field<&Joint::parent>("parent"),
                                         field<&Joint::lower>("lower", "rad or m"),
                                         field<&Joint::upper>("upper", "rad or m"),
                                         field<&Joint::max_velocity>("max_velocity", "rad/s or m/s"),
                                         field<&Joint::max_effort>("max_effort", "N m or N"),
                                         field<&Joint::rest>("rest", "rad or m"),
                                         field<&Joint::p>("p"),
                                         field<&Joint::i>("i"),
                                         field<&Joint::d>("d"),
                                         field<&Joint::gains_from>("gains_from"),
                                         flag<&Joint::compensated>("compensated"),
                                         field<&Joint::axis>("axis"),
                                         field<&Joint::pose>("pose")};
inline constexpr std::array joints_sample{field<&JointsSample::stamp>("stamp"), field<&JointsSample::commanded>("commanded"),
                                          followers("joints", 0)};
inline constexpr std::array joint_state_fields{field<&JointState::position>("position", "rad or m"),
                                               field<&JointState::velocity>("velocity", "rad/s or m/s"),
                                               field<&JointState::effort>("effort", "N m or N"),
                                               field<&JointState::target>("target"),
                                               field<&JointState::mode>("mode"),
                                               field<&JointState::status>("status")};

inline constexpr std::array logical_camera_info{
    field<&LogicalCameraInfo::model>("model"),         field<&LogicalCameraInfo::capacity>("capacity"),
    field<&LogicalCameraInfo::near_clip>("near", "m"), field<&LogicalCameraInfo::far_clip>("far", "m"),
    field<&LogicalCameraInfo::hfov>("hfov", "rad"),    field<&LogicalCameraInfo::aspect_ratio>("aspect_ratio"),
    field<&LogicalCameraInfo::rate>("rate", "Hz"),     field<&LogicalCameraInfo::pose>("pose")};
inline constexpr std::array logical_camera_sample{field<&LogicalCameraSample::stamp>("stamp"), field<&LogicalCameraSample::pose>("pose"),
                                                  field<&LogicalCameraSample::total>("total"), followers("models", 0)};
inline constexpr std::array seen_model_fields{field<&SeenModel::name>("name"), field<&SeenModel::pose>("pose")};

inline constexpr std::array boxes_info{field<&BoxesInfo::model>("model"),
                                       field<&BoxesInfo::kind>("kind"),
                                       field<&BoxesInfo::capacity>("capacity"),
                                       field<&BoxesInfo::width>("width", "pixel"),
                                       field<&BoxesInfo::height>("height", "pixel"),
                                       field<&BoxesInfo::rate>("rate", "Hz"),
                                       field<&BoxesInfo::pose>("pose")};
inline constexpr std::array boxes_sample{field<&BoxesSample::stamp>("stamp"), field<&BoxesSample::total>("total"), followers("boxes", 0)};
inline constexpr std::array box_fields{field<&Box::label>("label"),        field<&Box::name>("name"),
                                       field<&Box::pixels>("pixels"),      field<&Box::center>("center", "pixel"),
                                       field<&Box::size>("size", "pixel"), field<&Box::pose>("pose"),
                                       field<&Box::extent>("extent", "m")};

inline constexpr std::array fiducial_info{field<&FiducialInfo::model>("model"),
                                          field<&FiducialInfo::capacity>("capacity"),
                                          field<&FiducialInfo::min_range>("min_range", "m"),
                                          field<&FiducialInfo::max_range>("max_range", "m"),
                                          field<&FiducialInfo::view_angle>("view_angle", "rad"),
                                          field<&FiducialInfo::noise>("noise", "m rad"),
                                          field<&FiducialInfo::rate>("rate", "Hz"),
                                          field<&FiducialInfo::pose>("pose")};
inline constexpr std::array fiducial_sample{field<&FiducialSample::stamp>("stamp"), field<&FiducialSample::pose>("pose"),
                                            field<&FiducialSample::total>("total"), followers("marks", 0)};
inline constexpr std::array mark_fields{field<&Mark::id>("id"), field<&Mark::pose>("pose"), field<&Mark::size>("size", "m"),
                                        field<&Mark::model>("model")};
inline constexpr std::array battery_info{field<&BatteryInfo::model>("model"),
                                         field<&BatteryInfo::name>("battery"),
                                         field<&BatteryInfo::rate>("rate", "Hz"),
                                         field<&BatteryInfo::capacity>("capacity", "A h"),
                                         field<&BatteryInfo::initial_charge>("initial_charge", "A h"),
                                         field<&BatteryInfo::constant>("constant", "V"),
                                         field<&BatteryInfo::linear>("linear", "V"),
                                         field<&BatteryInfo::resistance>("resistance", "ohm"),
                                         field<&BatteryInfo::smoothing>("smoothing", "s"),
                                         field<&BatteryInfo::load>("load", "W"),
                                         field<&BatteryInfo::charging_time>("charging_time", "h")};
inline constexpr std::array battery_sample{field<&BatterySample::stamp>("stamp"),          field<&BatterySample::voltage>("voltage", "V"),
                                           field<&BatterySample::current>("current", "A"), field<&BatterySample::charge>("charge", "A h"),
                                           field<&BatterySample::level>("level"),          field<&BatterySample::power>("power", "W"),
                                           field<&BatterySample::state>("state"),          flag<&BatterySample::is_empty>("is_empty")};

inline constexpr std::array dvl_info{field<&DvlInfo::model>("model"),
                                     field<&DvlInfo::rate>("rate", "Hz"),
                                     field<&DvlInfo::noise>("noise", "m/s"),
                                     field<&DvlInfo::min_range>("min_range", "m"),
                                     field<&DvlInfo::max_range>("max_range", "m"),
                                     field<&DvlInfo::count>("count"),
                                     field<&DvlInfo::pose>("pose"),
                                     field<&DvlInfo::reference>("reference"),
                                     followers("beams", 0)};
inline constexpr std::array dvl_beam_fields{field<&DvlBeam::axis>("axis"), field<&DvlBeam::aperture>("aperture", "rad")};
inline constexpr std::array dvl_sample{field<&DvlSample::stamp>("stamp"),
                                       field<&DvlSample::velocity>("velocity", "m/s"),
                                       field<&DvlSample::covariance>("covariance", "m^2/s^2"),
                                       field<&DvlSample::range>("range", "m"),
                                       field<&DvlSample::locked>("locked"),
                                       flag<&DvlSample::has_velocity>("has_velocity"),
                                       followers("echoes", 0)};
inline constexpr std::array dvl_echo_fields{field<&DvlEcho::range>("range", "m"), field<&DvlEcho::speed>("speed", "m/s")};

inline constexpr std::array air_speed_sample{field<&AirSpeedSample::stamp>("stamp"), field<&AirSpeedSample::pressure>("pressure", "Pa"),
                                             field<&AirSpeedSample::temperature>("temperature", "K")};
inline constexpr std::array ins_info{field<&InsInfo::model>("model"),
                                     field<&InsInfo::rate>("rate", "Hz"),
                                     field<&InsInfo::position_noise>("position_noise", "m"),
                                     field<&InsInfo::altitude_noise>("altitude_noise", "m"),
                                     field<&InsInfo::velocity_noise>("velocity_noise", "m/s"),
                                     field<&InsInfo::heading_noise>("heading_noise", "rad"),
                                     field<&InsInfo::pose>("pose")};
inline constexpr std::array ins_sample{field<&InsSample::stamp>("stamp"),
                                       field<&InsSample::latitude>("latitude", "degree"),
                                       field<&InsSample::longitude>("longitude", "degree"),
                                       field<&InsSample::altitude>("altitude", "m"),
                                       field<&InsSample::height>("height", "m"),
                                       field<&InsSample::velocity>("velocity", "m/s"),
                                       field<&InsSample::orientation>("orientation", "rad")};

inline constexpr std::array rfid_info{field<&RfidInfo::model>("model"),        field<&RfidInfo::rate>("rate", "Hz"),
                                      field<&RfidInfo::capacity>("capacity"),  field<&RfidInfo::range>("range", "m"),
                                      field<&RfidInfo::angle>("angle", "rad"), flag<&RfidInfo::needs_sight>("needs_sight"),
                                      field<&RfidInfo::pose>("pose")};
inline constexpr std::array rfid_sample{field<&RfidSample::stamp>("stamp"), field<&RfidSample::total>("total"), followers("tags", 0)};
inline constexpr std::array rfid_tag_fields{field<&RfidTag::id>("id"), field<&RfidTag::data>("data")};

inline constexpr std::array wireless_info{field<&WirelessInfo::model>("model"),
                                          field<&WirelessInfo::rate>("rate", "Hz"),
                                          field<&WirelessInfo::capacity>("capacity"),
                                          field<&WirelessInfo::gain>("gain", "dBi"),
                                          field<&WirelessInfo::sensitivity>("sensitivity", "dBm"),
                                          field<&WirelessInfo::min_frequency>("min_frequency", "MHz"),
                                          field<&WirelessInfo::max_frequency>("max_frequency", "MHz"),
                                          field<&WirelessInfo::pose>("pose")};
inline constexpr std::array wireless_sample{field<&WirelessSample::stamp>("stamp"), field<&WirelessSample::total>("total"),
                                            followers("transmitters", 0)};
inline constexpr std::array radio_fields{field<&Radio::essid>("essid"), field<&Radio::transmitter>("transmitter"),
                                         field<&Radio::frequency>("frequency", "MHz"), field<&Radio::level>("level", "dBm"),
                                         flag<&Radio::is_blocked>("is_blocked")};

inline constexpr std::array wheels_info{field<&WheelsInfo::model>("model"), field<&WheelsInfo::rate>("rate", "Hz"),
                                        field<&WheelsInfo::ticks>("ticks"), field<&WheelsInfo::count>("count"), followers("wheels", 0)};
inline constexpr std::array wheel_fields{field<&Wheel::joint>("joint"), field<&Wheel::radius>("radius", "m")};
inline constexpr std::array wheels_sample{field<&WheelsSample::stamp>("stamp"), followers("wheels", 0)};
inline constexpr std::array wheel_state_fields{field<&WheelState::ticks>("ticks"), field<&WheelState::angle>("angle", "rad"),
                                               field<&WheelState::speed>("speed", "rad/s")};

inline constexpr std::array localization_info{
    field<&LocalizationInfo::model>("model"), field<&LocalizationInfo::rate>("rate", "Hz"), field<&LocalizationInfo::capacity>("capacity"),
    field<&LocalizationInfo::position_noise>("position_noise", "m"), field<&LocalizationInfo::heading_noise>("heading_noise", "rad")};
inline constexpr std::array localization_sample{field<&LocalizationSample::stamp>("stamp"), followers("hypotheses", 0)};
inline constexpr std::array hypothesis_fields{field<&Hypothesis::pose>("pose"), field<&Hypothesis::covariance>("covariance"),
                                              field<&Hypothesis::weight>("weight")};

inline constexpr std::array truth_info{field<&TruthInfo::model>("model")};
inline constexpr std::array truth_sample{field<&TruthSample::stamp>("stamp"), field<&TruthSample::pose>("pose"),
                                         field<&TruthSample::velocity>("velocity", "m/s, rad/s")};

// --- counts

inline constexpr std::uint64_t max_values = std::uint64_t{1} << 24;
inline constexpr std::uint64_t max_pixels = std::uint64_t{1} << 26;
inline constexpr std::uint64_t max_contacts = 65536;
inline constexpr std::uint64_t max_joints = 4096;
inline constexpr std::uint64_t max_elements = 4096;  // beams of a dvl, tags, transmitters, wheels, hypotheses

constexpr auto beams = [](const void* info) {
  const auto& laser = *static_cast<const LaserInfo*>(info);
  return std::uint64_t{laser.beams} * laser.layers;
};
constexpr auto transducers = [](const void* info) { return std::uint64_t{static_cast<const SonarInfo*>(info)->count}; };
constexpr auto capacity = [](const void* info) { return std::uint64_t{static_cast<const BumperInfo*>(info)->capacity}; };
constexpr auto seen_models = [](const void* info) { return std::uint64_t{static_cast<const LogicalCameraInfo*>(info)->capacity}; };
constexpr auto boxes_of = [](const void* info) { return std::uint64_t{static_cast<const BoxesInfo*>(info)->capacity}; };
constexpr auto marks_of = [](const void* info) { return std::uint64_t{static_cast<const FiducialInfo*>(info)->capacity}; };
constexpr auto joints_of = [](const void* info) { return std::uint64_t{static_cast<const JointsInfo*>(info)->count}; };
// Of those whose info begins with it.
constexpr auto first_word = [](const void* info) { return std::uint64_t{*static_cast<const std::uint32_t*>(info)}; };
constexpr auto pixels = [](const void* info) {
  const auto& camera = *static_cast<const CameraInfo*>(info);
  return std::uint64_t{camera.width} * camera.height;
};

// The sizes stand in each row as numbers, too: a structure that changes its size does not compile.
template <class Struct, std::size_t bytes>
constexpr std::size_t size() {
  static_assert(sizeof(Struct) == bytes);
  return bytes;
}

constexpr IfaceRow frames(IfaceType type, std::string_view name, std::string_view meaning) {
  return {.type = type,
          .name = name,
          .meaning = meaning,
          .info_size = size<CameraInfo, 320>(),
          .sample_size = 0,
          .info = camera_info,
          .sample = frame_head,
          .count = pixels,
          .most = max_pixels};
}

}  // namespace detail

// By number, in ascending order; some numbers are free.
inline constexpr std::array iface_types{
    IfaceRow{.type = IfaceType::simulation,
             .name = "simulation",
             .meaning = "clock, statistics, requests, participants",
             .info_size = detail::size<SimulationInfo, 696>(),
             .sample_size = detail::size<SimulationSample, 600>(),
             .info = detail::simulation_info,
             .sample = detail::simulation_sample},
    IfaceRow{.type = IfaceType::laser,
             .name = "laser",
             .meaning = "ranges of a scanner in one or more layers",
             .info_size = detail::size<LaserInfo, 272>(),
             .sample_size = detail::size<LaserSample, 96>(),
             .info = detail::laser_info,
             .sample = detail::laser_sample,
             .count = detail::beams,
             .most = detail::max_values,
             .sample_tail = {2, sizeof(float), detail::value_fields},
             .filled = detail::part<&LaserSample::count>(),
             .is_always_full = true},
    IfaceRow{.type = IfaceType::sonar,
             .name = "sonar",
             .meaning = "ranges of a ring of transducers",
             .info_size = detail::size<SonarInfo, 232>(),
             .sample_size = detail::size<SonarSample, 40>(),
             .info = detail::sonar_info,
             .sample = detail::sonar_sample,
             .count = detail::transducers,
             .most = detail::max_values,
             .info_tail = {1, sizeof(Pose), detail::pose_fields},
             .sample_tail = {1, sizeof(float), detail::value_fields},
             .filled = detail::part<&SonarSample::count>(),
             .is_always_full = true},
    IfaceRow{.type = IfaceType::position2d,
             .name = "position2d",
             .meaning = "drive of a robot on wheels",
             .info_size = detail::size<Position2dInfo, 288>(),
             .oldest_info_size = 272,
             .sample_size = detail::size<Position2dSample, 200>(),
             .info = detail::position2d_info,
             .sample = detail::position2d_sample,
             .command_values = 3},
    IfaceRow{.type = IfaceType::position3d,
             .name = "position3d",
             .meaning = "drive of a robot that flies",
             .info_size = detail::size<Position3dInfo, 240>(),
             .sample_size = detail::size<Position3dSample, 304>(),
             .info = detail::position3d_info,
             .sample = detail::position3d_sample,
             .command_values = 6},
    detail::frames(IfaceType::camera, "camera", "ring of images"),
    detail::frames(IfaceType::depth, "depth", "ring of float images [m]"),
    detail::frames(IfaceType::points, "points", "ring of float x y z (and intensity)"),
    IfaceRow{.type = IfaceType::imu,
             .name = "imu",
             .meaning = "orientation, angular velocity, acceleration",
             .info_size = detail::size<ImuInfo, 208>(),
             .sample_size = detail::size<ImuSample, 112>(),
             .info = detail::imu_info,
             .sample = detail::imu_sample},
    IfaceRow{.type = IfaceType::gps,
             .name = "gps",
             .meaning = "place on earth",
             .info_size = detail::size<GpsInfo, 248>(),
             .sample_size = detail::size<GpsSample, 80>(),
             .info = detail::gps_info,
             .sample = detail::gps_sample},
    IfaceRow{.type = IfaceType::bumper,
             .name = "bumper",
             .meaning = "contacts",
             .info_size = detail::size<BumperInfo, 288>(),
             .sample_size = detail::size<BumperSample, 40>(),
             .info = detail::bumper_info,
             .sample = detail::bumper_sample,
             .count = detail::capacity,
             .most = detail::max_contacts,
             .sample_tail = {1, detail::size<Contact, 192>(), detail::contact_fields},
             .filled = detail::part<&BumperSample::count>()},
    IfaceRow{.type = IfaceType::truth,
             .name = "truth",
             .meaning = "true pose and velocity of a model",
             .info_size = detail::size<TruthInfo, 128>(),
             .sample_size = detail::size<TruthSample, 136>(),
             .info = detail::truth_info,
             .sample = detail::truth_sample},
    IfaceRow{.type = IfaceType::force_torque,
             .name = "force_torque",
             .meaning = "load of a joint",
             .info_size = detail::size<MeterInfo, 344>(),
             .sample_size = detail::size<ForceTorqueSample, 80>(),
             .info = detail::meter_info,
             .sample = detail::force_torque_sample},
    IfaceRow{.type = IfaceType::altimeter,
             .name = "altimeter",
             .meaning = "height and climb",
             .info_size = detail::size<MeterInfo, 344>(),
             .sample_size = detail::size<AltimeterSample, 48>(),
             .info = detail::meter_info_without_joint,
             .sample = detail::altimeter_sample},
    IfaceRow{.type = IfaceType::magnetometer,
             .name = "magnetometer",
             .meaning = "the earth's magnetic field",
             .info_size = detail::size<MeterInfo, 344>(),
             .sample_size = detail::size<MagnetometerSample, 56>(),
             .info = detail::meter_info_without_joint,
             .sample = detail::magnetometer_sample},
    IfaceRow{.type = IfaceType::air_pressure,
             .name = "air_pressure",
             .meaning = "pressure of the air",
             .info_size = detail::size<MeterInfo, 344>(),
             .sample_size = detail::size<AirPressureSample, 40>(),
             .info = detail::meter_info_without_joint,
             .sample = detail::air_pressure_sample},
    IfaceRow{.type = IfaceType::joints,
             .name = "joints",
             .meaning = "joints of an arm, hand or other model",
             .info_size = detail::size<JointsInfo, 144>(),
             .sample_size = detail::size<JointsSample, 40>(),
             .info = detail::joints_info,
             .sample = detail::joints_sample,
             .count = detail::joints_of,
             .most = detail::max_joints,
             .info_tail = {1, detail::size<Joint, 448>(), detail::joint_fields},
             .sample_tail = {1, detail::size<JointState, 40>(), detail::joint_state_fields},
             .filled = detail::part<&JointsSample::count>(),
             .is_always_full = true},
    IfaceRow{.type = IfaceType::logical_camera,
             .name = "logical_camera",
             .meaning = "models in a frustum",
             .info_size = detail::size<LogicalCameraInfo, 232>(),
             .sample_size = detail::size<LogicalCameraSample, 96>(),
             .info = detail::logical_camera_info,
             .sample = detail::logical_camera_sample,
             .count = detail::seen_models,
             .most = detail::max_contacts,
             .sample_tail = {1, detail::size<SeenModel, 184>(), detail::seen_model_fields},
             .filled = detail::part<&LogicalCameraSample::count>()},
    IfaceRow{.type = IfaceType::boxes,
             .name = "boxes",
             .meaning = "boxes around labelled objects in an image",
             .info_size = detail::size<BoxesInfo, 208>(),
             .sample_size = detail::size<BoxesSample, 40>(),
             .info = detail::boxes_info,
             .sample = detail::boxes_sample,
             .count = detail::boxes_of,
             .most = detail::max_contacts,
             .sample_tail = {1, detail::size<Box, 248>(), detail::box_fields},
             .filled = detail::part<&BoxesSample::count>()},
    IfaceRow{.type = IfaceType::fiducial,
             .name = "fiducial",
             .meaning = "marks that a detector sees",
             .info_size = detail::size<FiducialInfo, 240>(),
             .sample_size = detail::size<FiducialSample, 96>(),
             .info = detail::fiducial_info,
             .sample = detail::fiducial_sample,
             .count = detail::marks_of,
             .most = detail::max_contacts,
             .sample_tail = {1, detail::size<Mark, 216>(), detail::mark_fields},
             .filled = detail::part<&FiducialSample::count>()},
    IfaceRow{.type = IfaceType::battery,
             .name = "battery",
             .meaning = "charge of a battery and what it drives",
             .info_size = detail::size<BatteryInfo, 264>(),
             .sample_size = detail::size<BatterySample, 80>(),
             .info = detail::battery_info,
             .sample = detail::battery_sample},
    IfaceRow{.type = IfaceType::dvl,
             .name = "dvl",
             .meaning = "velocity against the bottom by sound",
             .info_size = detail::size<DvlInfo, 280>(),
             .sample_size = detail::size<DvlSample, 152>(),
             .info = detail::dvl_info,
             .sample = detail::dvl_sample,
             .count = detail::first_word,
             .most = detail::max_elements,
             .info_tail = {1, detail::size<DvlBeam, 32>(), detail::dvl_beam_fields},
             .sample_tail = {1, detail::size<DvlEcho, 16>(), detail::dvl_echo_fields},
             .filled = detail::part<&DvlSample::count>(),
             .is_always_full = true},
    IfaceRow{.type = IfaceType::air_speed,
             .name = "air_speed",
             .meaning = "pressure of the air that meets it",
             .info_size = detail::size<MeterInfo, 344>(),
             .sample_size = detail::size<AirSpeedSample, 48>(),
             .info = detail::meter_info_without_joint,
             .sample = detail::air_speed_sample},
    IfaceRow{.type = IfaceType::ins,
             .name = "ins",
             .meaning = "place, velocity and orientation on earth",
             .info_size = detail::size<InsInfo, 224>(),
             .sample_size = detail::size<InsSample, 112>(),
             .info = detail::ins_info,
             .sample = detail::ins_sample},
    IfaceRow{.type = IfaceType::rfid,
             .name = "rfid",
             .meaning = "tags in reach of a reader",
             .info_size = detail::size<RfidInfo, 216>(),
             .sample_size = detail::size<RfidSample, 40>(),
             .info = detail::rfid_info,
             .sample = detail::rfid_sample,
             .count = detail::first_word,
             .most = detail::max_elements,
             .sample_tail = {1, detail::size<RfidTag, 192>(), detail::rfid_tag_fields},
             .filled = detail::part<&RfidSample::count>()},
    IfaceRow{.type = IfaceType::wireless,
             .name = "wireless",
             .meaning = "transmitters that a receiver hears",
             .info_size = detail::size<WirelessInfo, 232>(),
             .sample_size = detail::size<WirelessSample, 40>(),
             .info = detail::wireless_info,
             .sample = detail::wireless_sample,
             .count = detail::first_word,
             .most = detail::max_elements,
             .sample_tail = {1, detail::size<Radio, 216>(), detail::radio_fields},
             .filled = detail::part<&WirelessSample::count>()},
    IfaceRow{.type = IfaceType::wheels,
             .name = "wheels",
             .meaning = "encoders of wheels",
             .info_size = detail::size<WheelsInfo, 152>(),
             .sample_size = detail::size<WheelsSample, 40>(),
             .info = detail::wheels_info,
             .sample = detail::wheels_sample,
             .count = detail::first_word,
             .most = detail::max_elements,
             .info_tail = {1, detail::size<Wheel, 104>(), detail::wheel_fields},
             .sample_tail = {1, detail::size<WheelState, 24>(), detail::wheel_state_fields},
             .filled = detail::part<&WheelsSample::count>(),
             .is_always_full = true},
    IfaceRow{.type = IfaceType::localization,
             .name = "localization",
             .meaning = "hypotheses of where a model is",
             .info_size = detail::size<LocalizationInfo, 160>(),
             .sample_size = detail::size<LocalizationSample, 40>(),
             .info = detail::localization_info,
             .sample = detail::localization_sample,
             .count = detail::first_word,
             .most = detail::max_elements,
             .sample_tail = {1, detail::size<Hypothesis, 80>(), detail::hypothesis_fields},
             .filled = detail::part<&LocalizationSample::count>()},
    // A new type gets its row here.
};

// --- what follows from it

inline constexpr std::uint32_t highest_type = static_cast<std::uint32_t>(iface_types.back().type);

namespace detail {
// The place of each number in the table; one past its end for those that are free.
inline constexpr auto places = [] {
  std::array<std::uint8_t, highest_type + 1> places{};
  places.fill(static_cast<std::uint8_t>(iface_types.size()));
  for (std::size_t i = 0; i < iface_types.size(); ++i) places[static_cast<std::size_t>(iface_types[i].type)] = static_cast<std::uint8_t>(i);
  return places;
}();
}  // namespace detail

constexpr bool is_type(std::uint32_t type) { return type <= highest_type && detail::places[type] < iface_types.size(); }
// Only of a type that there is.
constexpr const IfaceRow& row_of(IfaceType type) { return iface_types[detail::places[static_cast<std::size_t>(type)]]; }
constexpr std::string_view to_text(IfaceType type) { return is_type(static_cast<std::uint32_t>(type)) ? row_of(type).name : "?"; }
constexpr std::optional<IfaceType> parse_type(std::string_view name) {
  for (const IfaceRow& row : iface_types) {
    if (row.name == name) return row.type;
  }
  return std::nullopt;
}
// Camera, depth and points publish frames; all others publish samples.
constexpr bool has_frames(IfaceType type) { return row_of(type).sample_size == 0; }

// Elements in each array of the tails of an iface with this info, or pixels of its frames; empty when that is 0 or more than can be.
constexpr std::optional<std::uint64_t> plausible_count(const IfaceRow& row, const void* info) {
  if (row.count == nullptr) return 0;
  const std::uint64_t count = row.count(info);
  if (count < 1 || count > row.most) return std::nullopt;
  return count;
}
constexpr std::size_t info_size(const IfaceRow& row, std::uint64_t count) {
  return row.info_size + row.info_tail.arrays * row.info_tail.size * count;
}
// A multiple of 8. 0 for those with frames.
constexpr std::size_t sample_size(const IfaceRow& row, std::uint64_t count) {
  return (row.sample_size + row.sample_tail.arrays * row.sample_tail.size * count + 7) / 8 * 8;
}

namespace detail {
constexpr bool ascend() {
  for (std::size_t i = 1; i < iface_types.size(); ++i) {
    if (iface_types[i].type <= iface_types[i - 1].type) return false;
  }
  return iface_types.size() < 255;
}
static_assert(ascend(), "rows are in the order of their numbers, and each number has one");
}  // namespace detail

}  // namespace shm
