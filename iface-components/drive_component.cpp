#include "drive_component.h"

#include <utility>

namespace iface {
namespace {

constexpr double default_timeout = 1.0;  // [s]

}  // namespace

std::vector<Parameter> drive_parameters() {
  return {{"motors_enabled", "1", "int", "radio", "(0,1)"}, {"command_timeout", "1.0", "double", "text", "x>=0"}};
}

Drive::Drive(RTC::Manager* manager, const Specification& specification, shm::IfaceType type)
    : IfaceComponent(manager, specification, type, true), commanding_client_(type, say()), async_requests_(say()), service_port_("drive") {}

void Drive::bindDrive() {
  addPort(service_port_);
  bindDevice();
  bind("motors_enabled", motors_enabled_);
  bind("command_timeout", command_timeout_);
}

void Drive::attached(const Device& device) {
  commanding_client_.set_simulated_time(in_simulated_time());  // before the first velocity comes
  if (const auto done = commanding_client_.attach(device); !done) say_limited(true, done.error().message);
}

void Drive::detaching() { commanding_client_.detach(); }

void Drive::describe(const shm::Iface&) { *described_.lock() = link().device(); }

void Drive::set_odometry(shm::ResetOdometryRequest request) {
  const Device device = described_.snapshot();
  if (device.device_id.empty()) {
    RTC_WARN(("SetOdometry is ignored: the component has not been active yet"));
    return;
  }
  request.iface = device.device_id;
  async_requests_.post(device.server_id, request);
}

void Drive::switch_motors() {
  if (!link().live()) return;
  if (told_attachment_ != link().attachments()) {
    told_attachment_ = link().attachments();
    motors_ = true;  // as a new drive is
  }
  if (motors_ == motors_enabled_) return;
  motors_ = motors_enabled_;
  const auto& device = link().device();
  async_requests_.post(device.server_id, shm::SetMotorsRequest{device.device_id, motors_enabled_});
}

// A value that means nothing must not switch the robot's safety off.
double Drive::command_timeout() {
  const bool is_good = command_timeout_ >= 0;
  if (!is_good && std::exchange(timeout_was_good_, false))
    RTC_WARN(("command_timeout must be 0 (never) or more seconds, got %g; it is %g instead", command_timeout_, default_timeout));
  timeout_was_good_ = is_good;
  return is_good ? command_timeout_ : default_timeout;
}

void Drive::watch_and_publish() {
  auto* robot = link().fresh(wait_limit());
  if (!robot) return;
  const auto& stamp = robot->sample<shm::Stamp>();
  if (watch_.expired(commanding_client_, stamp.sim_time_ns, command_timeout())) {
    RTC_WARN(("no velocity for %g s: the robot stops", command_timeout()));
    timed_out();
  }
  if (stamp.valid) publish(*robot);
}

}  // namespace iface
