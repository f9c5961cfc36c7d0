#include "manipulator_services.h"

#include <string_view>

namespace iface {
namespace {

JARA_ARM::RETURN_ID* wire(const Reply& reply) {
  auto* out = new JARA_ARM::RETURN_ID();
  out->id = static_cast<CORBA::Long>(reply.answer);
  out->comment = CORBA::string_dup(reply.comment.c_str());
  return out;
}

template <class Sequence>
void set_length(Sequence& sequence, std::size_t length) {
  sequence.length(static_cast<CORBA::ULong>(length));
}

// Joint positions or speeds.
template <class Sequence>
void fill(Sequence& out, const std::vector<double>& values, const ClientUnits& units) {
  set_length(out, values.size());
  for (std::size_t i = 0; i < values.size(); ++i) out[static_cast<CORBA::ULong>(i)] = values[i] / units.joint(i);
}

}  // namespace

std::vector<double> ClientUnits::to_ours(const JARA_ARM::JointPos& joints) const {
  std::vector<double> ours;
  for (CORBA::ULong i = 0; i < joints.length(); ++i) ours.push_back(joints[i] * joint(i));
  return ours;
}

Eigen::Isometry3d ClientUnits::to_ours(const JARA_ARM::HgMatrix matrix) const {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) pose.linear()(row, column) = matrix[row][column];
    pose.translation()[row] = matrix[row][3] * length();
  }
  return pose;
}

void ClientUnits::to_clients(const Eigen::Isometry3d& pose, JARA_ARM::HgMatrix matrix) const {
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) matrix[row][column] = pose.linear()(row, column);
    matrix[row][3] = pose.translation()[row] / length();
  }
}

// --- common level

CORBA::Boolean ManipulatorCommon::_is_a(const char* id) {
  return std::string_view(id) == "IDL:ManipulatorCommonInterface_Common:1.0" || POA_JARA_ARM::ManipulatorCommonInterface_Common::_is_a(id);
}

JARA_ARM::RETURN_ID* ManipulatorCommon::clearAlarms() {
  return wire(owner_.call([](Manipulator& arm, const auto&) { return arm.clear_alarms(); }));
}

JARA_ARM::RETURN_ID* ManipulatorCommon::getActiveAlarm(JARA_ARM::AlarmSeq_out alarms) {
  alarms = new JARA_ARM::AlarmSeq();
  return wire(owner_.call([&](Manipulator& arm, const auto&) {
    set_length(*alarms.ptr(), arm.alarms().size());
    for (CORBA::ULong i = 0; i < alarms->length(); ++i) {
      auto& out = (*alarms.ptr())[i];
      out.code = arm.alarms()[i].code;
      out.type = arm.alarms()[i].is_fault ? JARA_ARM::FAULT : JARA_ARM::WARNING;
      out.description = CORBA::string_dup(arm.alarms()[i].description.c_str());
    }
    return Reply{};
  }));
}

// The gripper's ratio in % follows the joints, as moveGripper has it.
JARA_ARM::RETURN_ID* ManipulatorCommon::getFeedbackPosJoint(JARA_ARM::JointPos_out pos) {
  pos = new JARA_ARM::JointPos();
  return wire(owner_.call([&](Manipulator& arm, const ClientUnits& units) {
    fill(*pos.ptr(), arm.feedback().positions, units);
    const CORBA::ULong count = pos->length();
    if (!arm.has_fingers()) return Reply{};
    pos->length(count + 1);
    (*pos.ptr())[count] = 100 * arm.feedback().finger_ratio;
    return Reply{};
  }));
}

JARA_ARM::RETURN_ID* ManipulatorCommon::getManipInfo(JARA_ARM::ManipInfo_out info) {
  info = new JARA_ARM::ManipInfo();
  info->axisNum = info->cmdCycle = 0;
  info->isGripper = false;
  return wire(owner_.call([&](Manipulator& arm, const auto&) {
    info->manufactur = CORBA::string_dup("rtm-sim");
    info->type = CORBA::string_dup("simulated arm");
    info->axisNum = static_cast<JARA_ARM::ULONG>(arm.feedback().positions.size());
    info->cmdCycle = static_cast<JARA_ARM::ULONG>(arm.settings().command_cycle_ms);
    info->isGripper = arm.has_fingers();
    return Reply{};
  }));
}

JARA_ARM::RETURN_ID* ManipulatorCommon::getSoftLimitJoint(JARA_ARM::LimitSeq_out limits) {
  limits = new JARA_ARM::LimitSeq();
  return wire(owner_.call([&](Manipulator& arm, const ClientUnits& units) {
    const auto& ours = arm.settings().limits;
    set_length(*limits.ptr(), ours.size());
    for (CORBA::ULong i = 0; i < limits->length(); ++i) {
      (*limits.ptr())[i].lower = ours[i].low / units.joint(i);
      (*limits.ptr())[i].upper = ours[i].high / units.joint(i);
    }
    return Reply{};
  }));
}

JARA_ARM::RETURN_ID* ManipulatorCommon::getState(JARA_ARM::ULONG& state) {
  state = 0;
  return wire(owner_.call([&](Manipulator& arm, const auto&) {
    state = arm.state();
    return Reply{};
  }));
}

JARA_ARM::RETURN_ID* ManipulatorCommon::servoOFF() {
  return wire(owner_.call([](Manipulator& arm, const auto&) { return arm.set_servo(false); }));
}

JARA_ARM::RETURN_ID* ManipulatorCommon::servoON() {
  return wire(owner_.call([](Manipulator& arm, const auto&) { return arm.set_servo(true); }));
}

JARA_ARM::RETURN_ID* ManipulatorCommon::setSoftLimitJoint(const JARA_ARM::LimitSeq& limits) {
  return wire(owner_.call([&](Manipulator& arm, const ClientUnits& units) {
    std::vector<Range> ours;
    for (CORBA::ULong i = 0; i < limits.length(); ++i) ours.push_back({limits[i].lower * units.joint(i), limits[i].upper * units.joint(i)});
    return arm.set_soft_limits(ours);
  }));
}

// --- middle level

CORBA::Boolean ManipulatorMiddle::_is_a(const char* id) {
  return std::string_view(id) == "IDL:ManipulatorCommonInterface_Middle:1.0" || POA_JARA_ARM::ManipulatorCommonInterface_Middle::_is_a(id);
}

JARA_ARM::RETURN_ID* ManipulatorMiddle::call(const std::function<Reply(Manipulator& arm)>& work) {
  return wire(owner_.call([&](Manipulator& arm, const auto&) { return work(arm); }));
}

// --- gripper

JARA_ARM::RETURN_ID* ManipulatorMiddle::closeGripper() {
  return call([](Manipulator& arm) { return arm.move_fingers({FingerCommand::Kind::close, 0}); });
}

JARA_ARM::RETURN_ID* ManipulatorMiddle::openGripper() {
  return call([](Manipulator& arm) { return arm.move_fingers({FingerCommand::Kind::move, 1}); });
}

// 0: closed, with the gripper's force.
JARA_ARM::RETURN_ID* ManipulatorMiddle::moveGripper(JARA_ARM::ULONG ratio) {
  if (ratio == 0) return closeGripper();
  return call([=](Manipulator& arm) { return arm.move_fingers({FingerCommand::Kind::move, ratio / 100.0}); });
}

// --- motions

JARA_ARM::RETURN_ID* ManipulatorMiddle::moveLinearCartesianAbs(const Position& point) {
  return wire(owner_.move([&](const Planner& planner, const auto& from, const auto& units) {
    return planner.along_line(from, units.to_ours(point.carPos), false);
  }));
}

JARA_ARM::RETURN_ID* ManipulatorMiddle::moveLinearCartesianRel(const Position& point) {
  return wire(owner_.move([&](const Planner& planner, const auto& from, const auto& units) {
    return planner.along_line(from, units.to_ours(point.carPos), true);
  }));
}

JARA_ARM::RETURN_ID* ManipulatorMiddle::movePTPCartesianAbs(const Position& point) {
  return wire(owner_.move([&](const Planner& planner, const auto& from, const auto& units) {
    return planner.to_pose(from, units.to_ours(point.carPos), false);
  }));
}

JARA_ARM::RETURN_ID* ManipulatorMiddle::movePTPCartesianRel(const Position& point) {
  return wire(owner_.move([&](const Planner& planner, const auto& from, const auto& units) {
    return planner.to_pose(from, units.to_ours(point.carPos), true);
  }));
}

JARA_ARM::RETURN_ID* ManipulatorMiddle::movePTPJointAbs(const JARA_ARM::JointPos& joints) {
  return wire(owner_.move(
      [&](const Planner& planner, const auto& from, const auto& units) { return planner.to_joints(from, units.to_ours(joints), false); }));
}

JARA_ARM::RETURN_ID* ManipulatorMiddle::movePTPJointRel(const JARA_ARM::JointPos& joints) {
  return wire(owner_.move(
      [&](const Planner& planner, const auto& from, const auto& units) { return planner.to_joints(from, units.to_ours(joints), true); }));
}

JARA_ARM::RETURN_ID* ManipulatorMiddle::moveCircularCartesianAbs(const Position& via, const Position& goal) {
  return wire(owner_.move([&](const Planner& planner, const auto& from, const auto& units) {
    return planner.along_arc(from, units.to_ours(via.carPos), units.to_ours(goal.carPos), false);
  }));
}

JARA_ARM::RETURN_ID* ManipulatorMiddle::moveCircularCartesianRel(const Position& via, const Position& goal) {
  return wire(owner_.move([&](const Planner& planner, const auto& from, const auto& units) {
    return planner.along_arc(from, units.to_ours(via.carPos), units.to_ours(goal.carPos), true);
  }));
}

JARA_ARM::RETURN_ID* ManipulatorMiddle::goHome() {
  std::vector<double> home;
  const Reply reply = owner_.call([&](Manipulator& arm, const auto&) {
    home = arm.home();
    return Reply{};
  });
  if (!reply.is_ok()) return wire(reply);
  return wire(owner_.move([&](const Planner& planner, const auto& from, const auto&) { return planner.to_joints(from, home, false); }));
}

JARA_ARM::RETURN_ID* ManipulatorMiddle::pause() {
  return call([](Manipulator& arm) { return arm.pause(); });
}

JARA_ARM::RETURN_ID* ManipulatorMiddle::resume() {
  return call([](Manipulator& arm) { return arm.resume(); });
}

JARA_ARM::RETURN_ID* ManipulatorMiddle::stop() {
  return call([](Manipulator& arm) { return arm.stop(); });
}

// --- poses and offsets

JARA_ARM::RETURN_ID* ManipulatorMiddle::getFeedbackPosCartesian(Position& pos) {
  ClientUnits{}.to_clients(Eigen::Isometry3d::Identity(), pos.carPos);
  pos.elbow = 0, pos.structFlag = 0;
  return wire(owner_.call([&](Manipulator& arm, const ClientUnits& units) {
    units.to_clients(arm.pose(), pos.carPos);
    return Reply{};
  }));
}

JARA_ARM::RETURN_ID* ManipulatorMiddle::getBaseOffset(JARA_ARM::HgMatrix offset) {
  ClientUnits{}.to_clients(Eigen::Isometry3d::Identity(), offset);
  return wire(owner_.call([&](Manipulator& arm, const ClientUnits& units) {
    units.to_clients(arm.settings().base, offset);
    return Reply{};
  }));
}

JARA_ARM::RETURN_ID* ManipulatorMiddle::setBaseOffset(const JARA_ARM::HgMatrix offset) {
  return wire(owner_.call([&](Manipulator& arm, const ClientUnits& units) { return arm.set_base(units.to_ours(offset)); }));
}

JARA_ARM::RETURN_ID* ManipulatorMiddle::setControlPointOffset(const JARA_ARM::HgMatrix offset) {
  return wire(owner_.call([&](Manipulator& arm, const ClientUnits& units) { return arm.set_tool(units.to_ours(offset)); }));
}

// --- speeds and acceleration times

JARA_ARM::RETURN_ID* ManipulatorMiddle::getMaxSpeedCartesian(JARA_ARM::CartesianSpeed& speed) {
  speed.translation = speed.rotation = 0;
  return wire(owner_.call([&](Manipulator& arm, const ClientUnits& units) {
    speed.translation = arm.settings().max_translation / units.length();
    speed.rotation = arm.settings().max_rotation / units.angle();
    return Reply{};
  }));
}

JARA_ARM::RETURN_ID* ManipulatorMiddle::getMaxSpeedJoint(JARA_ARM::DoubleSeq_out speed) {
  speed = new JARA_ARM::DoubleSeq();
  return wire(owner_.call([&](Manipulator& arm, const ClientUnits& units) {
    fill(*speed.ptr(), arm.settings().max_speeds, units);
    return Reply{};
  }));
}

JARA_ARM::RETURN_ID* ManipulatorMiddle::setMaxSpeedCartesian(const JARA_ARM::CartesianSpeed& speed) {
  return wire(owner_.call([&](Manipulator& arm, const ClientUnits& units) {
    return arm.set_max_cartesian_speed(speed.translation * units.length(), speed.rotation * units.angle());
  }));
}

JARA_ARM::RETURN_ID* ManipulatorMiddle::setMaxSpeedJoint(const JARA_ARM::DoubleSeq& speed) {
  return wire(owner_.call([&](Manipulator& arm, const ClientUnits& units) {
    std::vector<double> ours;
    for (CORBA::ULong i = 0; i < speed.length(); ++i) ours.push_back(speed[i] * units.joint(i));
    return arm.set_max_joint_speeds(ours);
  }));
}

JARA_ARM::RETURN_ID* ManipulatorMiddle::setSpeedCartesian(JARA_ARM::ULONG ratio) {
  return call([=](Manipulator& arm) { return arm.set_cartesian_speed(ratio); });
}

JARA_ARM::RETURN_ID* ManipulatorMiddle::setSpeedJoint(JARA_ARM::ULONG ratio) {
  return call([=](Manipulator& arm) { return arm.set_joint_speed(ratio); });
}

JARA_ARM::RETURN_ID* ManipulatorMiddle::getMinAccelTimeCartesian(CORBA::Double& time) {
  time = 0;
  return call([&](Manipulator& arm) { return time = arm.settings().min_cartesian_time, Reply{}; });
}

JARA_ARM::RETURN_ID* ManipulatorMiddle::getMinAccelTimeJoint(CORBA::Double& time) {
  time = 0;
  return call([&](Manipulator& arm) { return time = arm.settings().min_joint_time, Reply{}; });
}

JARA_ARM::RETURN_ID* ManipulatorMiddle::setAccelTimeCartesian(CORBA::Double time) {
  return call([=](Manipulator& arm) { return arm.set_cartesian_time(time); });
}

JARA_ARM::RETURN_ID* ManipulatorMiddle::setAccelTimeJoint(CORBA::Double time) {
  return call([=](Manipulator& arm) { return arm.set_joint_time(time); });
}

JARA_ARM::RETURN_ID* ManipulatorMiddle::setMinAccelTimeCartesian(CORBA::Double time) {
  return call([=](Manipulator& arm) { return arm.set_min_cartesian_time(time); });
}

JARA_ARM::RETURN_ID* ManipulatorMiddle::setMinAccelTimeJoint(CORBA::Double time) {
  return call([=](Manipulator& arm) { return arm.set_min_joint_time(time); });
}

// --- limits and home

JARA_ARM::RETURN_ID* ManipulatorMiddle::getSoftLimitCartesian(JARA_ARM::LimitValue& x, JARA_ARM::LimitValue& y, JARA_ARM::LimitValue& z) {
  x = y = z = {0, 0};
  return wire(owner_.call([&](Manipulator& arm, const ClientUnits& units) {
    JARA_ARM::LimitValue* out[] = {&x, &y, &z};
    for (std::size_t k = 0; k < 3; ++k) {
      out[k]->lower = arm.settings().box[k].low / units.length();
      out[k]->upper = arm.settings().box[k].high / units.length();
    }
    return Reply{};
  }));
}

JARA_ARM::RETURN_ID* ManipulatorMiddle::setSoftLimitCartesian(const JARA_ARM::LimitValue& x, const JARA_ARM::LimitValue& y,
                                                              const JARA_ARM::LimitValue& z) {
  return wire(owner_.call([&](Manipulator& arm, const ClientUnits& units) {
    std::array<Range, 3> box;
    const JARA_ARM::LimitValue* values[] = {&x, &y, &z};
    for (std::size_t k = 0; k < 3; ++k) box[k] = {values[k]->lower * units.length(), values[k]->upper * units.length()};
    return arm.set_box(box);
  }));
}

JARA_ARM::RETURN_ID* ManipulatorMiddle::setHome(const JARA_ARM::JointPos& joints) {
  return wire(owner_.call([&](Manipulator& arm, const ClientUnits& units) { return arm.set_home(units.to_ours(joints)); }));
}

JARA_ARM::RETURN_ID* ManipulatorMiddle::getHome(JARA_ARM::JointPos_out joints) {
  joints = new JARA_ARM::JointPos();
  return wire(owner_.call([&](Manipulator& arm, const ClientUnits& units) {
    fill(*joints.ptr(), arm.home(), units);
    return Reply{};
  }));
}

}  // namespace iface
