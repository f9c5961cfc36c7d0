// The two services of the common manipulator interface of JARA, in the units of their clients. Repository ids with and without the module
// JARA_ARM are answered alike. Calls from any thread; all are answered at once, also while simulated time stands still. Only a Cartesian
// path is computed in the call, on the caller's thread.
#pragma once

#include <arms/manipulator.h>
#include <rtm/ext/ManipulatorCommonInterface_CommonSkel.h>
#include <rtm/ext/ManipulatorCommonInterface_MiddleSkel.h>

#include <cmath>
#include <functional>
#include <vector>

namespace iface {

using arms::FingerCommand;
using arms::Manipulator;
using arms::Plan;
using arms::Planner;
using arms::Range;
using arms::Reply;

// Between the units of clients and rad, m.
struct ClientUnits {
  bool is_deg_mm = false;
  std::vector<bool> slides;  // per joint
  double angle() const { return is_deg_mm ? M_PI / 180 : 1; }
  double length() const { return is_deg_mm ? 1e-3 : 1; }
  double joint(std::size_t i) const { return i < slides.size() && slides[i] ? length() : angle(); }
  std::vector<double> to_ours(const JARA_ARM::JointPos& joints) const;
  Eigen::Isometry3d to_ours(const JARA_ARM::HgMatrix matrix) const;
  void to_clients(const Eigen::Isometry3d& pose, JARA_ARM::HgMatrix matrix) const;
};

// The component that has the arm. Any thread.
class ManipulatorOwner {
 public:
  using Work = std::function<Reply(Manipulator& arm, const ClientUnits& units)>;
  using Planned = std::function<Plan(const Planner& planner, const std::vector<double>& from, const ClientUnits& units)>;
  virtual ~ManipulatorOwner() = default;
  // Answers NG while there is no arm.
  virtual Reply call(const Work& work) = 0;
  virtual Reply move(const Planned& plan) = 0;
};

class ManipulatorCommon : public virtual POA_JARA_ARM::ManipulatorCommonInterface_Common,
                          public virtual PortableServer::RefCountServantBase {
 public:
  using Result = JARA_ARM::RETURN_ID*;
  explicit ManipulatorCommon(ManipulatorOwner& owner) : owner_(owner) {}
  CORBA::Boolean _is_a(const char* id) override;
  Result clearAlarms() override;
  Result getActiveAlarm(JARA_ARM::AlarmSeq_out alarms) override;
  Result getFeedbackPosJoint(JARA_ARM::JointPos_out pos) override;
  Result getManipInfo(JARA_ARM::ManipInfo_out info) override;
  Result getSoftLimitJoint(JARA_ARM::LimitSeq_out limits) override;
  Result getState(JARA_ARM::ULONG& state) override;
  Result servoOFF() override;
  Result servoON() override;
  Result setSoftLimitJoint(const JARA_ARM::LimitSeq& limits) override;

 private:
  ManipulatorOwner& owner_;
};

class ManipulatorMiddle : public virtual POA_JARA_ARM::ManipulatorCommonInterface_Middle,
                          public virtual PortableServer::RefCountServantBase {
 public:
  using Result = JARA_ARM::RETURN_ID*;
  using Position = JARA_ARM::CarPosWithElbow;
  explicit ManipulatorMiddle(ManipulatorOwner& owner) : owner_(owner) {}
  CORBA::Boolean _is_a(const char* id) override;
  Result closeGripper() override;
  Result getBaseOffset(JARA_ARM::HgMatrix offset) override;
  Result getFeedbackPosCartesian(Position& pos) override;
  Result getMaxSpeedCartesian(JARA_ARM::CartesianSpeed& speed) override;
  Result getMaxSpeedJoint(JARA_ARM::DoubleSeq_out speed) override;
  Result getMinAccelTimeCartesian(CORBA::Double& time) override;
  Result getMinAccelTimeJoint(CORBA::Double& time) override;
  Result getSoftLimitCartesian(JARA_ARM::LimitValue& x, JARA_ARM::LimitValue& y, JARA_ARM::LimitValue& z) override;
  Result moveGripper(JARA_ARM::ULONG ratio) override;
  Result moveLinearCartesianAbs(const Position& point) override;
  Result moveLinearCartesianRel(const Position& point) override;
  Result movePTPCartesianAbs(const Position& point) override;
  Result movePTPCartesianRel(const Position& point) override;
  Result movePTPJointAbs(const JARA_ARM::JointPos& joints) override;
  Result movePTPJointRel(const JARA_ARM::JointPos& joints) override;
  Result openGripper() override;
  Result pause() override;
  Result resume() override;
  Result stop() override;
  Result setAccelTimeCartesian(CORBA::Double time) override;
  Result setAccelTimeJoint(CORBA::Double time) override;
  Result setBaseOffset(const JARA_ARM::HgMatrix offset) override;
  Result setControlPointOffset(const JARA_ARM::HgMatrix offset) override;
  Result setMaxSpeedCartesian(const JARA_ARM::CartesianSpeed& speed) override;
  Result setMaxSpeedJoint(const JARA_ARM::DoubleSeq& speed) override;
  Result setMinAccelTimeCartesian(CORBA::Double time) override;
  Result setMinAccelTimeJoint(CORBA::Double time) override;
  Result setSoftLimitCartesian(const JARA_ARM::LimitValue& x, const JARA_ARM::LimitValue& y, const JARA_ARM::LimitValue& z) override;
  Result setSpeedCartesian(JARA_ARM::ULONG ratio) override;
  Result setSpeedJoint(JARA_ARM::ULONG ratio) override;
  Result moveCircularCartesianAbs(const Position& via, const Position& goal) override;
  Result moveCircularCartesianRel(const Position& via, const Position& goal) override;
  Result setHome(const JARA_ARM::JointPos& joints) override;
  Result getHome(JARA_ARM::JointPos_out joints) override;
  Result goHome() override;

 private:
  Result call(const std::function<Reply(Manipulator& arm)>& work);
  ManipulatorOwner& owner_;
};

}  // namespace iface
