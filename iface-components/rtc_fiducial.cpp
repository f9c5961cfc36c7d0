#include "rtc_fiducial.h"

#include <algorithm>
#include <cmath>

#include "conversions.h"
#include "specification.h"

static const iface::Specification specification{
    .type_name = "RTCFiducial",
    .description = "Detector of fiducial marks of a simulated robot",
    .phase = iface::sensor_phase,
    .device = "pioneer2dx::fiducial",
};

namespace {

bool is_within(const shm::Mark& mark, const RTC::FiducialFOV& view) {
  const auto& p = mark.pose;
  const double range = std::sqrt(p.x * p.x + p.y * p.y + p.z * p.z);
  return range >= view.minRange && range <= view.maxRange && std::abs(std::atan2(p.y, p.x)) <= view.viewAngle / 2;
}

}  // namespace

void FiducialService::describe(const shm::FiducialInfo& info) {
  GeometryService::describe(iface::to_geometry(info.pose));
  auto state = state_.lock();
  state->own = state->wanted = {info.min_range, info.max_range, info.view_angle};
}

void FiducialService::SetFOV(const RTC::FiducialFOV& wanted) {
  auto state = state_.lock();
  const auto& own = state->own;
  const auto within = [](double value, double low, double high) { return std::isfinite(value) ? std::clamp(value, low, high) : high; };
  auto& view = state->wanted;
  view.minRange = std::isfinite(wanted.minRange) ? std::clamp(wanted.minRange, own.minRange, own.maxRange) : own.minRange;
  view.maxRange = within(wanted.maxRange, view.minRange, own.maxRange);
  view.viewAngle = within(wanted.viewAngle, 0, own.viewAngle);
}

RTCFiducial::RTCFiducial(RTC::Manager* manager)
    : IfaceComponent(manager, specification, shm::IfaceType::fiducial, true),
      fiducials_out_("fiducials", fiducials_),
      service_port_("fiducial") {}

RTC::ReturnCode_t RTCFiducial::onInitialize() {
  addOutPort("fiducials", fiducials_out_);
  service_port_.registerProvider("fiducial", "RTC::Fiducial", service_);
  addPort(service_port_);
  bindDevice();
  return RTC::RTC_OK;
}

void RTCFiducial::publish(const shm::Iface& detector) {
  const auto& info = detector.info<shm::FiducialInfo>();
  const auto* marks = reinterpret_cast<const shm::Mark*>(detector.sample_followers(0));
  const RTC::FiducialFOV view = service_.GetFOV();
  fiducials_.tm = iface::to_time(detector.sample<shm::FiducialSample>().stamp.sim_time_ns);
  auto& list = fiducials_.fiducialsList;
  list.length(0);
  for (std::size_t i = 0; i < detector.filled(); ++i) {
    if (!is_within(marks[i], view)) continue;
    list.length(list.length() + 1);
    RTC::FiducialInfo& one = list[list.length() - 1];
    one = RTC::FiducialInfo{};
    one.id = marks[i].id;
    one.pose = iface::to_pose(marks[i].pose);
    one.poseUncertainty = {{info.noise[0], info.noise[0], info.noise[0]}, {info.noise[1], info.noise[1], info.noise[1]}};
    one.size = {marks[i].size[0], marks[i].size[1], marks[i].size[2]};
  }
  fiducials_out_.write();
}

extern "C" {
void RTCFiducialInit(RTC::Manager* manager) { iface::register_type<RTCFiducial>(manager, specification); }
}
