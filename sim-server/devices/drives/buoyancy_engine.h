// The bladder of an underwater glider (gz-sim's BuoyancyEngine). It lifts its link by the weight of the displaced water, compared with that
// of its neutral volume. Without a command it keeps its default volume. It is an iface position3d that follows the vertical part of
// velocities and goals: the pump fills and empties the bladder for the vertical speed. When a client detaches or commands a stop, the
// vehicle keeps its depth. Odometry is the true pose, from its own origin. See device.h for the thread rule.
#pragma once

#include "devices/drives/drive.h"
#include "devices/sensors/sensor.h"

namespace sim {

class BuoyancyEngine final : public Sensor, public Drive {
 public:
  struct Bladder {
    LinkId link;
    double low = 3e-5, high = 9.9e-4;     // volume [m^3]
    double neutral = 3e-4, start = 3e-5;  // [m^3]
    double density = 1000;                // of the water [kg/m^3]
    double pump = 3e-6;                   // [m^3/s]
    std::optional<double> surface;        // above this height of the link there is no water [m]; nothing: there is water everywhere
    double mass = 1;                      // of the model [kg]
  };
  // Null, with a line, for a plugin that is wrong.
  static MadeDevice make(DeviceWorld& world, ModelId model, const PluginDef& plugin, std::vector<std::string>& left_out);
  BuoyancyEngine(Setup setup, const Bladder& bladder);

  bool follows_steps() const override { return true; }
  void before_step(const Moment& moment) override;
  bool set_odometry(const Eigen::Isometry3d& pose) override;
  bool set_motors(bool enabled) override;
  void set_fault(double strength, bool is_halted) override;
  bool is_working() const override { return volume_ != wanted_volume_; }
  void set_power(bool has_power) override { has_power_ = has_power; }

 private:
  void measure(const Moment& moment) const override;
  void restart() override;
  void add_state_to(StateHash& hash) const override;
  void take(const Moment& moment);
  double wanted_speed() const;
  void control(double dt);

  Bladder bladder_;
  double volume_, wanted_volume_;  // [m^3]
  double learned_ = 0;             // acceleration that holds the speed against drag and weight [m/s^2]
  double followed_ = 0;            // vertical speed [m/s]
  double command_ = 0;             // likewise
  std::optional<double> goal_;     // height in odometry [m]
  std::optional<double> halted_at_;
  Eigen::Isometry3d odometry_origin_ = Eigen::Isometry3d::Identity();
  double strength_ = 1;
  bool is_idle_ = true;  // before the first command
  bool motors_enabled_ = true, has_power_ = true, is_commanded_ = false;
};

}  // namespace sim
