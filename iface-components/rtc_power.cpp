#include "rtc_power.h"

#include <array>

#include "conversions.h"
#include "specification.h"

static const iface::Specification specification{
    .type_name = "RTCPower",
    .description = "Battery of a simulated robot",
    .phase = iface::command_phase,
    .device = "pioneer2dx::battery",
};

RTCPower::RTCPower(RTC::Manager* manager)
    : IfaceComponent(manager, specification, shm::IfaceType::battery, true),
      charger_in_("charger", charger_),
      voltage_out_("voltage", voltage_),
      current_out_("current", current_),
      level_out_("level", level_),
      state_out_("state", state_) {}

RTC::ReturnCode_t RTCPower::onInitialize() {
  addInPort("charger", charger_in_);
  addOutPort("voltage", voltage_out_);
  addOutPort("current", current_out_);
  addOutPort("level", level_out_);
  addOutPort("state", state_out_);
  bindDevice();
  return RTC::RTC_OK;
}

RTC::ReturnCode_t RTCPower::onExecute(RTC::UniqueId) {
  if (!follow_configuration()) return RTC::RTC_ERROR;
  bool is_new = false;
  while (charger_in_.isNew()) is_new = charger_in_.read() || is_new;
  if (auto* battery = is_new ? link().live() : nullptr) {
    const auto done = battery->command(shm::CommandKind::charge, std::array{charger_.data ? 1.0 : 0.0});
    if (!done) RTC_WARN(("%s", done.error().message.c_str()));
  }
  publish_newest();
  return RTC::RTC_OK;
}

void RTCPower::publish(const shm::Iface& device) {
  const auto& sample = device.sample<shm::BatterySample>();
  voltage_.tm = current_.tm = level_.tm = state_.tm = iface::to_time(sample.stamp.sim_time_ns);
  voltage_.data = sample.voltage;
  current_.data = sample.current;
  level_.data = sample.level;
  state_.data = static_cast<CORBA::Long>(sample.state);
  voltage_out_.write();
  current_out_.write();
  level_out_.write();
  state_out_.write();
}

extern "C" {
void RTCPowerInit(RTC::Manager* manager) { iface::register_type<RTCPower>(manager, specification); }
}
