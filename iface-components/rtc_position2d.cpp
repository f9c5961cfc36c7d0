#include "rtc_position2d.h"

#include <array>

#include "conversions.h"
#include "sim_clock.h"

// clang-format off
static const char* const rtcposition2d_spec[] = {
    "implementation_id", "RTCPosition2d",
    "type_name", "RTCPosition2d",
    "description", "Drive of a simulated robot",
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
    "conf.default.device_id", "pioneer2dx::position2d",
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

std::array<double, 3> values_of(const RTC::TimedVelocity2D& velocity) { return {velocity.data.vx, velocity.data.vy, velocity.data.va}; }

class Received : public RTC::ConnectorDataListenerT<RTC::TimedVelocity2D> {
 public:
  explicit Received(iface::Commander& commander) : commander_(commander) {}
  USE_CONNLISTENER_STATUS;
  ReturnCode operator()(RTC::ConnectorInfo&, RTC::TimedVelocity2D& velocity) override {
    commander_.received(values_of(velocity));
    return NO_CHANGE;
  }

 private:
  iface::Commander& commander_;
};

}  // namespace

RTCPosition2d::RTCPosition2d(RTC::Manager* manager)
    : IfaceComponent(manager, shm::IfaceType::position2d, true),
      velocity_in_("velocity", velocity_),
      odometry_out_("odometry", odometry_),
      actual_velocity_out_("actual_velocity", actual_velocity_),
      commander_(shm::IfaceType::position2d, say()),
      errand_(say()) {}

RTC::ReturnCode_t RTCPosition2d::onInitialize() {
  addInPort("velocity", velocity_in_);
  addOutPort("odometry", odometry_out_);
  addOutPort("actual_velocity", actual_velocity_out_);
  velocity_in_.addConnectorDataListener(RTC::ConnectorDataListenerType::ON_RECEIVED, new Received(commander_));
  bindDevice("pioneer2dx::position2d");
  bindParameter("motors_enabled", motors_enabled_, "1");
  bindParameter("command_timeout", command_timeout_, "1.0");
  return RTC::RTC_OK;
}

void RTCPosition2d::attached(const iface::Device& device) {
  if (const auto done = commander_.attach(device); !done) RTC_ERROR(("%s", done.error().message.c_str()));
  motors_ = true;  // as a new drive is
}

void RTCPosition2d::detaching() { commander_.detach(); }

RTC::ReturnCode_t RTCPosition2d::onExecute(RTC::UniqueId) {
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

void RTCPosition2d::switch_motors() {
  if (motors_ == motors_enabled_) return;
  motors_ = motors_enabled_;
  const auto& device = link().device();
  errand_.post(device.server_id, shm::SetMotorsRequest{device.device_id, motors_enabled_});
}

void RTCPosition2d::publish() {
  auto* robot = link().fresh(iface::wait_limit());
  if (!robot) return;
  const auto& sample = robot->sample<shm::Position2dSample>();
  if (watch_.expired(commander_, sample.stamp.sim_time_ns, command_timeout_))
    RTC_WARN(("no velocity for %g s: the robot stops", command_timeout_));
  if (!sample.stamp.valid) return;
  odometry_.tm = iface::to_time(sample.stamp.sim_time_ns);
  odometry_.data.position.x = sample.odometry[0];
  odometry_.data.position.y = sample.odometry[1];
  odometry_.data.heading = sample.odometry[2];
  odometry_out_.write();
  actual_velocity_.tm = odometry_.tm;
  actual_velocity_.data.vx = sample.velocity[0];
  actual_velocity_.data.vy = sample.velocity[1];
  actual_velocity_.data.va = sample.velocity[2];
  actual_velocity_out_.write();
}

extern "C" {
void RTCPosition2dInit(RTC::Manager* manager) {
  coil::Properties profile(rtcposition2d_spec);
  manager->registerFactory(profile, RTC::Create<RTCPosition2d>, RTC::Delete<RTCPosition2d>);
}
}
