#include "rtc_position3d.h"

#include <array>

#include "conversions.h"
#include "sim_clock.h"

// clang-format off
static const char* const rtcposition3d_spec[] = {
    "implementation_id", "RTCPosition3d",
    "type_name", "RTCPosition3d",
    "description", "Flight or free movement of a simulated robot",
    "version", "1.0.0",
    "vendor", "rtm-sim",
    "category", "simulation",
    "activity_type", "PERIODIC",
    "kind", "DataFlowComponent",
    "max_instance", "0",
    "language", "C++",
    "lang_type", "compile",
    "exec_cxt.periodic.rate", "1000",
    "exec_cxt.sim_time.phase", "2",
    "conf.default.server_id", "0",
    "conf.default.device_id", "helicopter::position3d",
    "conf.default.motors_enabled", "1",
    "conf.default.command_timeout", "1.0",
    "conf.__type__.server_id", "int",
    "conf.__type__.device_id", "string",
    "conf.__type__.motors_enabled", "int",
    "conf.__type__.command_timeout", "double",
    "conf.__widget__.server_id", "spin",
    "conf.__widget__.device_id", "text",
    "conf.__widget__.motors_enabled", "radio",
    "conf.__widget__.command_timeout", "text",
    "conf.__constraints__.server_id", "0<=x<=9999",
    "conf.__constraints__.motors_enabled", "(0,1)",
    ""};
// clang-format on

namespace {

// Linear, then angular; the standard type calls the rates of roll, pitch and yaw vr, vp, va.
std::array<double, 6> values_of(const RTC::TimedVelocity3D& velocity) {
  const auto& v = velocity.data;
  return {v.vx, v.vy, v.vz, v.vr, v.vp, v.va};
}

class Received : public RTC::ConnectorDataListenerT<RTC::TimedVelocity3D> {
 public:
  explicit Received(iface::Commander& commander) : commander_(commander) {}
  USE_CONNLISTENER_STATUS;
  ReturnCode operator()(RTC::ConnectorInfo&, RTC::TimedVelocity3D& velocity) override {
    commander_.received(values_of(velocity));
    return NO_CHANGE;
  }

 private:
  iface::Commander& commander_;
};

}  // namespace

RTCPosition3d::RTCPosition3d(RTC::Manager* manager)
    : IfaceComponent(manager, shm::IfaceType::position3d, true),
      velocity_in_("velocity", velocity_),
      pose_out_("pose", pose_),
      actual_velocity_out_("actual_velocity", actual_velocity_),
      commander_(shm::IfaceType::position3d, say()),
      errand_(say()) {}

RTC::ReturnCode_t RTCPosition3d::onInitialize() {
  addInPort("velocity", velocity_in_);
  addOutPort("pose", pose_out_);
  addOutPort("actual_velocity", actual_velocity_out_);
  velocity_in_.addConnectorDataListener(RTC::ConnectorDataListenerType::ON_RECEIVED, new Received(commander_));
  bindDevice("helicopter::position3d");
  bindParameter("motors_enabled", motors_enabled_, "1");
  bindParameter("command_timeout", command_timeout_, "1.0");
  return RTC::RTC_OK;
}

void RTCPosition3d::attached(const iface::Device& device) {
  if (const auto done = commander_.attach(device); !done) RTC_ERROR(("%s", done.error().message.c_str()));
  motors_ = true;  // as a new drive is
}

void RTCPosition3d::detaching() { commander_.detach(); }

RTC::ReturnCode_t RTCPosition3d::onExecute(RTC::UniqueId) {
  if (!follow_configuration()) return RTC::RTC_ERROR;
  const bool simulated = iface::in_simulated_time();
  commander_.set_simulated_time(simulated);
  if (velocity_in_.isNew()) {
    velocity_in_.read();
    // In real time the listener has driven the robot already.
    if (simulated) commander_.drive(values_of(velocity_));
  }
  switch_motors();
  publish();
  return RTC::RTC_OK;
}

void RTCPosition3d::switch_motors() {
  if (motors_ == motors_enabled_) return;
  motors_ = motors_enabled_;
  const auto& device = link().device();
  errand_.post(device.server_id, shm::SetMotorsRequest{device.device_id, motors_enabled_});
}

void RTCPosition3d::publish() {
  auto* robot = link().fresh(iface::wait_limit());
  if (!robot) return;
  const auto& sample = robot->sample<shm::Position3dSample>();
  if (watch_.expired(commander_, sample.stamp.sim_time_ns, command_timeout_))
    RTC_WARN(("no velocity for %g s: the robot stops", command_timeout_));
  if (!sample.stamp.valid) return;
  pose_.tm = iface::to_time(sample.stamp.sim_time_ns);
  pose_.data = iface::to_pose(sample.odometry);
  pose_out_.write();
  const auto& v = sample.velocity;
  actual_velocity_.tm = pose_.tm;
  actual_velocity_.data = {v[0], v[1], v[2], v[3], v[4], v[5]};
  actual_velocity_out_.write();
}

extern "C" {
void RTCPosition3dInit(RTC::Manager* manager) {
  coil::Properties profile(rtcposition3d_spec);
  manager->registerFactory(profile, RTC::Create<RTCPosition3d>, RTC::Delete<RTCPosition3d>);
}
}
