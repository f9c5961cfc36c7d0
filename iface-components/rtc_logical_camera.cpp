#include "rtc_logical_camera.h"

#include "conversions.h"
#include "specification.h"

static const iface::Specification specification{
    .type_name = "RTCLogicalCamera",
    .description = "Logical camera of a simulated robot: which models are in its view",
    .phase = iface::sensor_phase,
    .device = "pioneer2dx::logical_camera",
};

RTCLogicalCamera::RTCLogicalCamera(RTC::Manager* manager)
    : IfaceComponent(manager, specification, shm::IfaceType::logical_camera, true),
      models_out_("models", models_),
      fiducials_out_("fiducials", fiducials_) {}

RTC::ReturnCode_t RTCLogicalCamera::onInitialize() {
  addOutPort("models", models_out_);
  addOutPort("fiducials", fiducials_out_);
  bindDevice();
  return RTC::RTC_OK;
}

void RTCLogicalCamera::publish(const shm::Iface& camera) {
  const auto* models = reinterpret_cast<const shm::SeenModel*>(camera.sample_followers(0));
  const auto count = static_cast<CORBA::ULong>(camera.filled());
  models_.tm = fiducials_.tm = iface::to_time(camera.sample<shm::LogicalCameraSample>().stamp.sim_time_ns);
  models_.data.length(count);
  fiducials_.fiducialsList.length(count);
  for (CORBA::ULong i = 0; i < count; ++i) {
    models_.data[i] = CORBA::string_dup(models[i].name);
    fiducials_.fiducialsList[i] = RTC::FiducialInfo{};
    fiducials_.fiducialsList[i].id = i;
    fiducials_.fiducialsList[i].pose = iface::to_pose(models[i].pose);
  }
  models_out_.write();
  fiducials_out_.write();
}

extern "C" {
void RTCLogicalCameraInit(RTC::Manager* manager) { iface::register_type<RTCLogicalCamera>(manager, specification); }
}
