// The rolling step of a model: while a robot on two driven wheels rolls alone on level ground, RollingMotion moves it in place of ODE.
// Private to physics/. The stepping thread of the shard.
//
// A model can roll if gravity is along z and the model is one body with two wheels on it, balls or cylinders that are symmetric about
// parallel, horizontal axles without limits and springs, and with any number of balls in ball joints; and if no fluid, wind, belt,
// slip or weld is on it. Balls without friction go along and keep turning as they did; others roll. Everything else of it that touches the
// ground slides.
//
// State                     transitions
// watched                   ODE steps it. It rolls after 0.5 s in which each step found it rolling alone, or when it falls asleep alone.
//                           Its posture on the ground, the places of its contacts and the rates of its wheels are then those of ODE.
// rolling                   its bodies are disabled in ODE. Each step sets their poses and velocities, so that sensors, encoders,
//                           contacts and hashes find the same state as after a step of ODE.
// rolling, asleep           its bodies have no velocity; nothing is done until a motor starts.
//
// It rolls alone if the ground, a level plane or the top of a box, is the only object that it touches, and everything else is further away
// than both need to stop. It is watched again at once, from where it is:
//   when that ends, or when a wheel would slip or a contact would lift off in the step, which ODE then makes;
//   when a client sets its pose, velocity or gravity, pushes it, attaches something to it, or gives a motor a controller;
//   when a static model is changed, or anything is deleted.
// A model that cannot roll stays watched forever, and costs nothing.
// The decisions depend on the states of models of the same shard before the step, and on nothing else.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "physics/hash.h"
#include "physics/ode.h"
#include "physics/rolling_motion.h"
#include "physics/shapes.h"
#include "world/world_def.h"

namespace sim {

class JointInstance;
class ModelInstance;

class Rolling {
 public:
  using Statics = std::vector<ShapeInstance*>;

  // Null: the model cannot roll.
  static std::unique_ptr<Rolling> of(const ModelInstance& model, const PhysicsDef& physics);

  bool is_rolling() const { return motion_.has_value(); }
  bool is_asleep() const { return is_asleep_; }
  void wake() { is_asleep_ = false; }

  // After a step of ODE: whether it rolls from now on.
  void watch(ModelInstance& model, const Statics& statics);
  // Of one that rolls, before a step: nothing has come near.
  bool is_alone(const ModelInstance& model, const Statics& statics) const;
  // False: ODE must make this step, after stop().
  bool step(ModelInstance& model);
  // ODE makes its steps from now on. Also of one that does not roll: it is watched from the beginning.
  void stop(ModelInstance& model);

  // How far from the model something may come [m].
  static double reach(double speed, double dt);
  void add_to(StateHash& hash) const;

 private:
  struct Wheel {
    std::size_t joint = 0;  // among the joints of the model
    std::uint32_t assembly = 0;
    double fastest = infinite, friction = 0, damping = 0;       // [rad/s], [N m], [N m s]; of the joint
    Eigen::Vector3d center{0, 0, 0}, axle{0, 1, 0};             // in the body [m]; unit vector
    Eigen::Quaterniond start = Eigen::Quaterniond::Identity();  // against the body
    double cosine = 1, sine = 0;                                // of half the angle that it has turned by since
  };
  // In a ball joint.
  struct Ball {
    std::size_t joint = 0;
    std::uint32_t assembly = 0;
    double radius = 0, friction = 0;
    Eigen::Vector3d center{0, 0, 0};  // in the body [m]
    Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
    Eigen::Vector3d spin{0, 0, 0};  // [rad/s]
  };
  struct Foot {
    Eigen::Vector3d place;    // in the body
    std::size_t contact = 0;  // among those of RollingMotion
  };
  explicit Rolling(const PhysicsDef& physics) : dt_(physics.step), gravity_(-physics.gravity.z()) {}
  bool find_wheels(const ModelInstance& model);
  bool is_round(const ModelInstance& model, const Wheel& wheel) const;
  bool add_ball(const ModelInstance& model, std::size_t joint);
  void move_balls(const ModelInstance& model, const Eigen::Vector3d& linear, const Eigen::Vector3d& spin, const Eigen::Quaterniond& middle,
                  const Eigen::Quaterniond& now);
  bool is_settled(const ModelInstance& model) const;
  // What the contacts of the last step touch, when that is one level thing.
  const ShapeInstance* ground_of(const ModelInstance& model, const Statics& statics) const;
  void find_feet(const ModelInstance& model);
  std::optional<RollingMotion> motion_of(const ModelInstance& model);
  std::optional<double> friction_of(const ModelInstance& model, const Contact& contact) const;
  RollingMass mass_of(const ModelInstance& model) const;
  void start(ModelInstance& model, RollingMotion motion);
  void measure(const ModelInstance& model);
  bool is_on_ground(double reach) const;
  void move(ModelInstance& model);
  void set_contacts(ModelInstance& model, const Eigen::Quaterniond& turn) const;
  void set_box(ModelInstance& model) const;

  double dt_, gravity_;
  std::uint32_t body_ = 0;  // assembly
  std::array<Wheel, 2> wheels_;
  std::vector<Ball> balls_;
  std::uint32_t ready_steps_ = 0;  // in a row
  const ShapeInstance* ground_ = nullptr;
  bool is_asleep_ = false;
  double speed_ = 0;                     // [m/s] of its fastest point
  double radius_ = 0;                    // of the upright cylinder about the body's place that it is in
  double low_ = 0, high_ = 0;            // ends of that, in the world
  Eigen::Vector3d place_{0, 0, 0};       // of the body
  std::optional<RollingMotion> motion_;  // while it rolls; all that follows counts then
  Eigen::Vector3d origin_{0, 0, 0};      // of RollingMotion, in the body
  Eigen::Vector3d forward_{1, 0, 0};     // its x axis, in the world at the start
  Eigen::Quaterniond start_ = Eigen::Quaterniond::Identity();
  double cosine_ = 1, sine_ = 0;  // of half the angle that it has turned by since the start
  std::vector<Foot> feet_;        // as the contacts of the model
};

}  // namespace sim
