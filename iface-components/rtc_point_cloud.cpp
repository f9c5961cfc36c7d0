#include "rtc_point_cloud.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "conversions.h"
#include "specification.h"

static const iface::Specification specification{
    .type_name = "RTCPointCloud",
    .description = "Point cloud of a simulated laser scanner",
    .phase = iface::sensor_phase,
    .device = "pioneer2dx::laser",
    .parameters = {{"organised", "0", "int", "radio", "(0,1)"}, {"fields", "xyz", "string", "radio", "(xyz,all)"}},
};

RTCPointCloud::RTCPointCloud(RTC::Manager* manager)
    : IfaceComponent(manager, specification, shm::IfaceType::laser, true),
      points_out_("points", points_),
      cloud_out_("cloud", cloud_),
      service_port_("point_cloud") {}

RTC::ReturnCode_t RTCPointCloud::onInitialize() {
  addOutPort("points", points_out_);
  addOutPort("cloud", cloud_out_);
  service_port_.registerProvider("point_cloud", "RTC::PointCloudServices", service_);
  addPort(service_port_);
  bindDevice();
  bind("organised", organised_);
  bind("fields", fields_);
  return RTC::RTC_OK;
}

void RTCPointCloud::describe(const shm::Iface& laser) { service_.describe(iface::to_geometry(laser.info<shm::LaserInfo>().pose)); }

void RTCPointCloud::publish(const shm::Iface& laser) {
  const bool has_points = !points_out_.connectors().empty(), has_cloud = !cloud_out_.connectors().empty();
  if (!has_points && !has_cloud) return;
  const auto& info = laser.info<shm::LaserInfo>();
  const auto scan = laser.laser_scan();
  time_ = iface::to_time(scan.sample->stamp.sim_time_ns);
  begin_ns_ = std::max<std::int64_t>(scan.sample->stamp.sim_time_ns - scan.sample->sweep_ns, 0);
  iface::to_points(info, scan, organised_ != 0, rays_);
  if (has_points) send_points(rays_);
  if (has_cloud) send_cloud(info, rays_);
}

void RTCPointCloud::send_points(const std::vector<iface::RayPoint>& points) {
  points_.tm = time_;
  points_.points.length(static_cast<CORBA::ULong>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto& [position, intensity, ring, time] = points[i];
    points_.points[static_cast<CORBA::ULong>(i)] = {{position[0], position[1], position[2]}, {intensity, intensity, intensity}};
  }
  points_out_.write();
}

void RTCPointCloud::send_cloud(const shm::LaserInfo& info, const std::vector<iface::RayPoint>& points) {
  struct Column {
    const char* name;
    PointCloudTypes::DataType type;
    CORBA::ULong size;
  };
  static constexpr Column columns[] = {{"x", PointCloudTypes::FLOAT32, 4},   {"y", PointCloudTypes::FLOAT32, 4},
                                       {"z", PointCloudTypes::FLOAT32, 4},   {"intensity", PointCloudTypes::FLOAT32, 4},
                                       {"ring", PointCloudTypes::UINT16, 2}, {"time", PointCloudTypes::FLOAT32, 4}};
  const bool has_all = fields_ == "all";
  const CORBA::ULong count = has_all ? 6 : 3;
  const RTC::Time begin = iface::to_time(begin_ns_);
  cloud_.tm = {begin.sec, begin.nsec};
  ++cloud_.seq;
  cloud_.type = CORBA::string_dup(has_all ? "xyzirt" : "xyz");
  cloud_.fields.length(count);
  CORBA::ULong step = 0;
  for (CORBA::ULong i = 0; i < count; ++i) {
    cloud_.fields[i].name = CORBA::string_dup(columns[i].name);
    step = (step + columns[i].size - 1) / columns[i].size * columns[i].size;
    cloud_.fields[i].offset = step;
    cloud_.fields[i].data_type = columns[i].type;
    cloud_.fields[i].count = columns[i].size;
    step += columns[i].size;
  }
  const auto size = static_cast<CORBA::ULong>(points.size());
  cloud_.height = organised_ != 0 ? std::max(info.layers, 1u) : 1;
  cloud_.width = size / cloud_.height;
  cloud_.is_bigendian = std::endian::native == std::endian::big;
  cloud_.is_dense = organised_ == 0;
  cloud_.point_step = step;
  cloud_.row_step = step * cloud_.width;
  cloud_.data.length(step * size);
  CORBA::Octet* to = cloud_.data.get_buffer();
  for (const auto& [position, intensity, ring, time] : points) {
    std::memcpy(to, position.data(), 12);
    if (has_all) {
      const auto short_ring = static_cast<std::uint16_t>(ring);
      std::memcpy(to + 12, &intensity, 4);
      std::memcpy(to + 16, &short_ring, 2);
      std::memcpy(to + 20, &time, 4);
    }
    to += step;
  }
  cloud_out_.write();
}

extern "C" {
void RTCPointCloudInit(RTC::Manager* manager) { iface::register_type<RTCPointCloud>(manager, specification); }
}
