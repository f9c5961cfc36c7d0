// Common base of RTCPosition2d and RTCPosition3d: the InPort `velocity` drives the robot, the motors are switched by configuration, the
// robot stops when velocities stop coming, and the service port `drive` has the guidelines' services of odometry and of drives by velocity.
// Configuration: server_id, device_id, motors_enabled; command_timeout [s of simulated time]: the robot stops when no velocity has come for
// so long (0: never).
//
// Threads: in real time a velocity goes to the robot on the thread that brings it; in simulated time in onExecute, in the context's phase.
#pragma once

#include <rtm/idl/ExtendedDataTypesSkel.h>

#include <rtm/DataInPort.h>

#include <rtm/CorbaPort.h>

#include <array>
#include <functional>

#include "async_requests.h"
#include "commanding_client.h"
#include "geometry_service.h"
#include "iface_component.h"
#include "simulated_time.h"

namespace iface {

// In the order of the iface's command values: linear, then angular. The standard type calls the rates of roll, pitch and yaw vr, vp, va.
inline std::array<double, 3> values_of(const RTC::TimedVelocity2D& velocity) {
  return {velocity.data.vx, velocity.data.vy, velocity.data.va};
}
inline std::array<double, 6> values_of(const RTC::TimedVelocity3D& velocity) {
  const auto& v = velocity.data;
  return {v.vx, v.vy, v.vz, v.vr, v.vp, v.va};
}

// Those of every drive, for its specification.
std::vector<Parameter> drive_parameters();

// RTC::Odometry2D or 3D. SetOdometry returns at once; the simulator does it between two ticks.
template <class Skeleton, class Pose>
class OdometryService : public GeometryService<Skeleton> {
 public:
  explicit OdometryService(std::function<void(const Pose&)> set) : set_(std::move(set)) {}
  void SetOdometry(const Pose& pose) override { set_(pose); }

 private:
  std::function<void(const Pose&)> set_;
};

// The part that does not depend on the type of the velocity.
class Drive : public IfaceComponent {
 public:
  Drive(RTC::Manager* manager, const Specification& specification, shm::IfaceType type);

 protected:
  // To be called in onInitialize.
  void bindDrive();
  void attached(const Device& device) override;
  void detaching() override;
  void describe(const shm::Iface& robot) override;
  // Any thread; the iface of the request is filled in.
  void set_odometry(shm::ResetOdometryRequest request);
  void switch_motors();
  void watch_and_publish();
  // No command has come for command_timeout: the robot was stopped.
  virtual void timed_out() {}
  CommandingClient& commanding_client() { return commanding_client_; }
  RTC::CorbaPort& service_port() { return service_port_; }

 private:
  double command_timeout();

  bool motors_enabled_ = true;
  double command_timeout_ = 1;  // [s]; 0: never
  bool timeout_was_good_ = true;
  CommandingClient commanding_client_;  // shared with the threads that bring velocities
  CommandWatch watch_;
  bool motors_ = true;  // as told to the simulator
  std::uint64_t told_attachment_ = 0;
  AsyncRequests async_requests_;
  base::Guarded<Device, base::Rank::details> described_;  // whose odometry services set
  RTC::CorbaPort service_port_;
};

template <class Velocity>
class DriveComponent : public Drive {
 public:
  DriveComponent(RTC::Manager* manager, const Specification& specification, shm::IfaceType type)
      : Drive(manager, specification, type), velocity_in_("velocity", velocity_) {}

  RTC::ReturnCode_t onExecute(RTC::UniqueId) override {
    if (!follow_configuration()) return RTC::RTC_ERROR;
    const bool simulated = in_simulated_time();
    commanding_client().set_simulated_time(simulated);
    if (read_newest_velocity()) {
      // In real time the listener has driven the robot already.
      if (simulated && commanding_client().is_newest_of_this_run()) commanding_client().drive(values_of(velocity_));
      velocity_came();
    }
    read_goals();
    switch_motors();
    watch_and_publish();
    return RTC::RTC_OK;
  }

 protected:
  virtual void velocity_came() {}
  virtual void read_goals() {}  // commands other than velocities

  // To be called in onInitialize.
  void addVelocityPort() {
    addInPort("velocity", velocity_in_);
    velocity_in_.addConnectorDataListener(RTC::ConnectorDataListenerType::ON_RECEIVED, new Received(commanding_client()));
  }

 private:
  class Received : public RTC::ConnectorDataListenerT<Velocity> {
   public:
    USE_CONNLISTENER_STATUS;
    explicit Received(CommandingClient& commanding_client) : commanding_client_(commanding_client) {}
    ReturnCode operator()(RTC::ConnectorInfo&, Velocity& velocity) override {
      commanding_client_.received(values_of(velocity));
      return this->NO_CHANGE;
    }

   private:
    CommandingClient& commanding_client_;
  };

  // What is older than the newest velocity would be driven too late, now and in every tick after this one.
  bool read_newest_velocity() {
    bool is_new = false;
    while (velocity_in_.isNew()) is_new = velocity_in_.read() || is_new;
    return is_new;
  }

  Velocity velocity_;
  RTC::InPort<Velocity> velocity_in_;
};

}  // namespace iface
