// The battery of a model, from the plugin LinearBatteryPlugin of gz-sim and Gazebo classic: its voltage falls with the charge and the
// current, and when it is empty, the motors of the model have no power. See device.h for the thread rule.
//
// It drains from the first step on in which a motor of the model works (or at once with <start_draining>), until a reset, with the load of
// <power_load> and of the plugins that name it in <battery_name>. A client that commands "charge" connects the charger; with it, the
// charge rises up to the capacity, which <charging_time> is for. When that client detaches or exits, the charger is disconnected. An
// empty battery drives motors again at a hundredth of its capacity.
#pragma once

#include <vector>

#include "devices/sensors/sensor.h"

namespace sim {

struct BatterySetup {
  double constant = 0, linear = 0;          // open-circuit voltage [V]
  double capacity = 0, initial_charge = 0;  // [Ah]
  double resistance = 0;                    // [ohm]
  double smoothing = 1;                     // of the current [s]
  double start_voltage = 0;                 // before it drains [V]
  double load = 0;                          // [W]
  double charging_time = 0;                 // [h]; 0: it cannot be charged
  bool drains_at_once = false;
};
// Fails with one line that names the plugin's place, the value and what was expected.
base::Result<BatterySetup> battery_setup(const ModelDef& model, const PluginDef& plugin);

class Battery final : public Sensor {
 public:
  // `others`: devices of the model, which live as long.
  static MadeDevice make(DeviceWorld& world, ModelId model, const PluginDef& plugin, const BatterySetup& setup,
                         std::vector<Device*> others);
  Battery(Setup setup, const BatterySetup& battery, std::vector<Device*> others);

  bool follows_steps() const override { return true; }
  void before_step(const Moment& moment) override;
  void after_step(const Moment& moment) override;

 private:
  void measure(const Moment& moment) const override;
  void restart() override;
  void add_state_to(StateHash& hash) const override;
  void flow(double dt);
  void set_empty(bool is_empty);
  bool is_full() const { return charge_ >= battery_.capacity; }
  double power() const { return is_draining_ && !is_empty_ ? battery_.load : 0; }

  BatterySetup battery_;
  std::vector<Device*> others_;
  double charge_ = 0, current_ = 0, voltage_ = 0;  // [Ah], [A], [V]
  bool is_draining_ = false, is_charging_ = false, is_empty_ = false;
};

}  // namespace sim
