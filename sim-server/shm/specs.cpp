// The geometry of each iface type.
#include <cmath>
#include <cstring>

#include "shm/words.h"
#include "shm/writer.h"

namespace shm {
namespace {

constexpr std::uint64_t max_values = std::uint64_t{1} << 24;
constexpr std::uint64_t max_pixels = std::uint64_t{1} << 26;  // the loader of worlds (sensor_builder) leaves larger cameras out

template <class Info>
IfaceSpec make(IfaceType type, const std::string& name, const Info& info, std::size_t sample_size) {
  IfaceSpec spec;
  spec.type = type;
  spec.name = name;
  spec.info.resize(sizeof info);
  std::memcpy(spec.info.data(), &info, sizeof info);
  spec.geometry.info_size = sizeof info;
  spec.geometry.sample_size = sample_size;
  return spec;
}

}  // namespace

IfaceSpec simulation_spec(const SimulationInfo& info, std::uint32_t request_slots, std::uint32_t participants) {
  IfaceSpec spec = make(IfaceType::simulation, "world", info, sizeof(SimulationSample));
  spec.geometry.leases = 128;
  spec.geometry.request_slots = request_slots;
  spec.geometry.participants = participants;
  return spec;
}

IfaceSpec laser_spec(const std::string& name, const LaserInfo& info) {
  const std::uint64_t count = static_cast<std::uint64_t>(info.beams) * info.layers;
  const bool is_good = count > 0 && count <= max_values;
  return make(IfaceType::laser, name, info, is_good ? sizeof(LaserSample) + count * 2 * sizeof(float) : 0);
}

IfaceSpec sonar_spec(const std::string& name, const SonarInfo& info, std::span<const Pose> poses) {
  SonarInfo counted = info;
  counted.count = static_cast<std::uint32_t>(poses.size());
  const bool is_good = !poses.empty() && poses.size() <= max_values;
  IfaceSpec spec = make(IfaceType::sonar, name, counted, is_good ? round_up(sizeof(SonarSample) + poses.size() * sizeof(float), 8) : 0);
  spec.info.resize(sizeof counted + poses.size_bytes());
  if (!poses.empty()) std::memcpy(spec.info.data() + sizeof counted, poses.data(), poses.size_bytes());
  spec.geometry.info_size = spec.info.size();
  return spec;
}

IfaceSpec position2d_spec(const std::string& name, const Position2dInfo& info) {
  return make(IfaceType::position2d, name, info, sizeof(Position2dSample));
}

IfaceSpec position3d_spec(const std::string& name, const Position3dInfo& info) {
  return make(IfaceType::position3d, name, info, sizeof(Position3dSample));
}

IfaceSpec camera_spec(IfaceType type, const std::string& name, const CameraInfo& info, std::uint32_t slots) {
  CameraInfo whole = info;
  const std::uint32_t pixel = bytes_per_pixel(static_cast<Format>(info.format));
  const bool is_good = pixel > 0 && info.width > 0 && info.height > 0 && info.width <= max_pixels / info.height;
  if (is_good && whole.stride == 0) whole.stride = whole.width * pixel;
  if (is_good && whole.frame_size == 0) whole.frame_size = static_cast<std::uint64_t>(whole.stride) * whole.height;
  const bool fits = is_good && whole.stride >= static_cast<std::uint64_t>(whole.width) * pixel &&
                    whole.frame_size >= static_cast<std::uint64_t>(whole.stride) * whole.height;
  IfaceSpec spec = make(type, name, whole, 0);
  spec.geometry.frame_size = fits ? whole.frame_size : 0;
  spec.geometry.frame_slots = slots;
  return spec;
}

IfaceSpec imu_spec(const std::string& name, const ImuInfo& info) { return make(IfaceType::imu, name, info, sizeof(ImuSample)); }

IfaceSpec gps_spec(const std::string& name, const GpsInfo& info) { return make(IfaceType::gps, name, info, sizeof(GpsSample)); }

IfaceSpec bumper_spec(const std::string& name, const BumperInfo& info) {
  const bool is_good = info.capacity > 0 && info.capacity <= 65536;
  return make(IfaceType::bumper, name, info, is_good ? sizeof(BumperSample) + info.capacity * sizeof(Contact) : 0);
}

IfaceSpec meter_spec(IfaceType type, const std::string& name, const MeterInfo& info) {
  const std::size_t sample_size = type == IfaceType::force_torque   ? sizeof(ForceTorqueSample)
                                  : type == IfaceType::altimeter    ? sizeof(AltimeterSample)
                                  : type == IfaceType::magnetometer ? sizeof(MagnetometerSample)
                                  : type == IfaceType::air_pressure ? sizeof(AirPressureSample)
                                                                    : 0;
  return make(type, name, info, sample_size);
}

IfaceSpec truth_spec(const std::string& name, const TruthInfo& info) { return make(IfaceType::truth, name, info, sizeof(TruthSample)); }

}  // namespace shm
