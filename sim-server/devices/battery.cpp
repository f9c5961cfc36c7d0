#include "devices/battery.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "base/log.h"
#include "base/text.h"
#include "world/iface_names.h"
#include "world/plugin_kind.h"

namespace sim {
namespace {

constexpr double usual_rate = 50;          // [Hz] of samples, as in gz-sim
constexpr double least_voltage = 1e-3;     // [V]
constexpr double level_to_restart = 0.01;  // of an empty battery

std::string battery_name(const PluginDef& plugin) { return plugin.parameters.text_of({"battery_name"}).value_or(""); }

// Of all consumers [W]: its own, and those of other plugins that name this battery.
double load_of(const ModelDef& model, const PluginDef& battery) {
  double load = battery.parameters.number_of({"power_load"}).value_or(0);
  for (const PluginDef& other : model.plugins) {
    const bool is_consumer = kind_of(other) != PluginKind::battery && other.scope == battery.scope && !battery_name(other).empty() &&
                             battery_name(other) == battery_name(battery);
    if (is_consumer) load += other.parameters.number_of({"power_load"}).value_or(0);
  }
  return load;
}

double rate_of(const PluginDef& plugin) { return std::clamp(plugin.parameters.number_of({"update_rate"}).value_or(usual_rate), 0.0, 1e6); }

}  // namespace

base::Result<BatterySetup> battery_setup(const ModelDef& model, const PluginDef& plugin) {
  const ParameterNode& file = plugin.parameters;
  BatterySetup setup;
  const auto voltage = file.number_of({"voltage"});
  setup.constant = file.number_of({"open_circuit_voltage_constant_coef"}).value_or(voltage.value_or(0));
  setup.linear = file.number_of({"open_circuit_voltage_linear_coef"}).value_or(0);
  setup.capacity = file.number_of({"capacity"}).value_or(0);
  setup.initial_charge = std::clamp(file.number_of({"initial_charge"}).value_or(setup.capacity), 0.0, std::max(0.0, setup.capacity));
  setup.resistance = file.number_of({"resistance"}).value_or(0);
  setup.smoothing = file.number_of({"smooth_current_tau"}).value_or(1);
  setup.start_voltage =
      voltage.value_or(setup.constant + (setup.capacity > 0 ? setup.linear * (1 - setup.initial_charge / setup.capacity) : 0));
  setup.load = load_of(model, plugin);
  if (file.bool_of({"enable_recharge"}).value_or(false)) setup.charging_time = file.number_of({"charging_time"}).value_or(0);
  setup.drains_at_once = file.bool_of({"start_draining"}).value_or(false);
  const auto fail = [&](std::string_view what, std::string_view expected, double got) {
    return base::Error{
        fmt::format("{}: plugin {}: {} must be {}, got {:g}; the battery is left out", plugin.source, plugin.name, what, expected, got)};
  };
  if (!(setup.capacity > 0)) return fail("<capacity>", "positive [Ah]", setup.capacity);
  if (!(setup.start_voltage > 0)) return fail("<voltage>", "positive [V]", setup.start_voltage);
  if (!(setup.load >= 0)) return fail("<power_load>", "at least 0 [W]", setup.load);
  if (!(setup.resistance >= 0)) return fail("<resistance>", "at least 0 [ohm]", setup.resistance);
  if (!(setup.charging_time >= 0)) return fail("<charging_time>", "at least 0 [h]", setup.charging_time);
  return setup;
}

MadeDevice Battery::make(DeviceWorld& world, ModelId model, const PluginDef& plugin, const BatterySetup& battery,
                         std::vector<Device*> others) {
  const ModelDef& def = world.physics.def(model);
  shm::BatteryInfo info{};
  info.rate = stated_rate(world, rate_of(plugin));
  info.capacity = battery.capacity;
  info.initial_charge = battery.initial_charge;
  info.constant = battery.constant;
  info.linear = battery.linear;
  info.resistance = battery.resistance;
  info.smoothing = battery.smoothing;
  info.load = battery.load;
  info.charging_time = battery.charging_time;
  shm::set_text(info.name, iface_own_name(plugin));
  shm::set_text(info.model, scoped_model(def, plugin.scope));
  auto spec = shm::iface_spec(shm::IfaceType::battery, iface_name(def, plugin), info);
  spec.geometry.command_values = 1;
  auto setup = set_up(world, model, rate_of(plugin), spec, {});
  if (!setup) return setup.error();
  return MadeDevice(std::make_unique<Battery>(std::move(*setup), battery, std::move(others)));
}

Battery::Battery(Setup setup, const BatterySetup& battery, std::vector<Device*> others)
    : Sensor(std::move(setup)), battery_(battery), others_(std::move(others)) {
  restart();
}

void Battery::before_step(const Moment& moment) {
  shm::Command command;
  const auto change = poll_command(moment, command);
  if (change == shm::CommandChange::none) return;
  const bool is_asked = change == shm::CommandChange::fresh && command.kind == shm::CommandKind::charge && command.values[0] >= 0.5;
  if (is_asked && battery_.charging_time <= 0) {
    base::log(base::Level::warn, writer().name(), "it cannot be charged: its plugin has no <enable_recharge> with a <charging_time>");
  }
  is_charging_ = is_asked && battery_.charging_time > 0;
}

void Battery::after_step(const Moment& moment) {
  is_draining_ = is_draining_ || battery_.drains_at_once ||
                 std::any_of(others_.begin(), others_.end(), [](const Device* device) { return device->is_working(); });
  if (!is_draining_ && !is_charging_) return;
  flow(moment.dt);
  const bool is_empty = is_empty_ ? charge_ < level_to_restart * battery_.capacity : charge_ <= 0;
  if (is_empty != is_empty_) set_empty(is_empty);
}

// gz-sim's equations, in the same order.
void Battery::flow(double dt) {
  double wanted = power() / std::max(voltage_, least_voltage);
  if (is_charging_ && !is_full()) wanted -= battery_.capacity / battery_.charging_time;
  current_ += dt / std::max(battery_.smoothing, dt) * (wanted - current_);
  charge_ = std::clamp(charge_ - current_ * dt / 3600, 0.0, battery_.capacity);
  voltage_ = battery_.constant + battery_.linear * (1 - charge_ / battery_.capacity) - battery_.resistance * current_;
}

void Battery::set_empty(bool is_empty) {
  is_empty_ = is_empty;
  for (Device* device : others_) device->set_power(!is_empty);
  base::log(base::Level::warn, writer().name(), "{}",
            is_empty ? "it is empty: the motors of its model have no power" : "it drives the motors of its model again");
}

void Battery::measure(const Moment&) const {
  auto& out = sample<shm::BatterySample>();
  out.voltage = voltage_;
  out.current = current_;
  out.charge = charge_;
  out.level = charge_ / battery_.capacity;
  out.power = power();
  out.state = is_charging_ && is_full() ? RTMSIM_BATTERY_FULL
              : is_charging_            ? RTMSIM_BATTERY_CHARGES
              : is_empty_               ? RTMSIM_BATTERY_EMPTY
              : is_draining_            ? RTMSIM_BATTERY_DRAINS
                                        : RTMSIM_BATTERY_IDLE;
  out.is_empty = is_empty_ ? 1 : 0;
}

void Battery::restart() {
  charge_ = battery_.initial_charge;
  voltage_ = battery_.start_voltage;
  current_ = 0;
  is_draining_ = is_charging_ = is_empty_ = false;
}

void Battery::add_state_to(StateHash& hash) const {
  hash.add(writer().name());
  hash.add_all(charge_, current_, voltage_, std::uint64_t{is_draining_}, std::uint64_t{is_charging_}, std::uint64_t{is_empty_});
}

}  // namespace sim
