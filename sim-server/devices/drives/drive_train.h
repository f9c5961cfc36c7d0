// Drive train of a robot on wheels: sets its motors for a commanded velocity, and reads the encoders of its wheels. The stepping thread
// only.
#pragma once

#include <array>
#include <memory>
#include <optional>

#include "devices/device.h"

namespace sim {

// What the encoders say of the last step, and the rates in its end.
struct Travel {
  double forward = 0, turn = 0;      // [m], [rad]
  double speed = 0, yaw_rate = 0;    // [m/s], [rad/s]
  double aside = 0, side_speed = 0;  // to the left [m], [m/s]; 0 of drives that cannot
};

// What a client asks for.
struct DriveOrder {
  std::array<double, 3> velocity{0, 0, 0};  // vx, vy [m/s], va [rad/s]; of a car command the speed alone
  std::optional<double> steering;           // of a car command [rad]
};

class DriveTrain {
 public:
  virtual ~DriveTrain() = default;
  // Name, sizes and limits of the drive in the iface's constants.
  virtual void describe(shm::Position2dInfo& info) const = 0;
  // Sets the motors for the next step of `dt`: on the way to what is asked for, within the limits.
  virtual void drive(const DriveOrder& order, bool motors_on, double dt) = 0;
  // After each step, once.
  virtual Travel travel() = 0;
  // vx, vy [m/s] and va [rad/s] that the motors follow now.
  virtual std::array<double, 3> followed() const = 0;
  // Its wheels carry the model; false: what stands still, as a conveyor.
  virtual bool moves_the_model() const { return true; }
  // Those that its motors turn, by their place in the model.
  virtual std::vector<std::uint32_t> joints() const = 0;
  // Links round which its belts run, likewise.
  virtual std::vector<std::uint32_t> belts() const { return {}; }
  virtual double rate() const = 0;  // of samples [Hz]; 0: every step
  // The model is (again) at its initial state.
  virtual void reset() = 0;
  virtual void add_to(StateHash& hash) const = 0;
};

using MadeTrain = base::Result<std::unique_ptr<DriveTrain>>;

// From the plugin element, in the spellings in use; what is missing is taken from the model. Fail with a line.
// Wheels on both sides that turn at speeds of their own: differential and skid drives.
MadeTrain make_wheel_pairs(Physics& physics, ModelId model, const PluginDef& plugin);
// Two steered wheels in front, as gz-sim's AckermannSteering and gazebo_ros' Ackermann drive have them; or one that is driven, of a
// tricycle.
MadeTrain make_car(Physics& physics, ModelId model, const PluginDef& plugin);
// Wheels with rollers, which push along one line each: mecanum wheels as gz-sim's MecanumDrive has them, and omni wheels wherever they are.
MadeTrain make_rollers(Physics& physics, ModelId model, const PluginDef& plugin);
// Tracks as gz-sim's TrackedVehicle and Gazebo classic's SimpleTrackedVehicle have them, or the belt of a TrackController that no vehicle
// has.
MadeTrain make_tracks(Physics& physics, ModelId model, const PluginDef& plugin);

// --- for the drives themselves

inline constexpr double strongest_torque = 1e6;  // [N m] of wheels that nothing but their grip holds back

// A line with plugin and model, and that the plugin is left out.
base::Error drive_error(const ModelDef& model, const PluginDef& plugin, const std::string& what);
// What is wrong with the size of a wheel or a distance of wheels, for that line; empty: nothing. From a millimetre to a kilometre.
std::string size_problem(std::string_view what, double size);
// All joints that the children of these names mean; one that is not there goes into `missing`.
void add_joints(const ModelDef& model, const PluginDef& plugin, std::initializer_list<std::string_view> spellings,
                std::vector<std::uint32_t>& joints, std::string& missing);
// Of the round collision of the wheel that a joint turns [m]; 0 without one.
double wheel_radius(const ModelDef& model, std::uint32_t joint);
// The middle of that wheel, in the model [m]: joints of models lie beside their wheels. The joint's place when there is no such collision
// on its axis.
Eigen::Vector3d wheel_place(const ModelDef& model, std::uint32_t joint);
// What a joint's own limit allows [N m].
double torque_of(const ModelDef& model, std::uint32_t joint);
// gz-sim turns wheels as told whatever it takes; in Gazebo classic they have a torque, 5 N m when nothing is said.
bool is_of_gz_sim(const PluginDef& plugin);

}  // namespace sim
