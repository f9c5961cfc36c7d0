// A component that calls the JARA services when it is activated: what its parameter `calls` says, "servoON; movePTPJointAbs 0 0.5 1 0 1 0".
// Each answer is one line of its log, "answer CALL: ID COMMENT VALUES". Included by a source for each text of the interface, which names
// the component (CALLER), the interfaces' module for types (JARA) and for type names (MODULE).
#include <rtm/CorbaConsumer.h>
#include <rtm/CorbaPort.h>
#include <rtm/DataFlowComponentBase.h>
#include <rtm/Manager.h>

#include <functional>
#include <map>
#include <sstream>
#include <string>
#include <vector>

class CALLER : public RTC::DataFlowComponentBase {
 public:
  explicit CALLER(RTC::Manager* manager) : RTC::DataFlowComponentBase(manager), common_port_("common"), middle_port_("middle") {}

  RTC::ReturnCode_t onInitialize() override {
    common_port_.registerConsumer("common", MODULE "ManipulatorCommonInterface_Common", common_);
    middle_port_.registerConsumer("middle", MODULE "ManipulatorCommonInterface_Middle", middle_);
    addPort(common_port_);
    addPort(middle_port_);
    bindParameter("calls", calls_, "");
    return RTC::RTC_OK;
  }

  RTC::ReturnCode_t onActivated(RTC::UniqueId) override {
    std::istringstream all(calls_);
    try {
      for (std::string call; std::getline(all, call, ';');) RTC_WARN(("answer %s", answer(call).c_str()));
      return RTC::RTC_OK;
    } catch (const CORBA::Exception& e) {
      RTC_ERROR(("no answer: %s", e._name()));
    } catch (const std::out_of_range&) {
      RTC_ERROR(("no such call in: %s", calls_.c_str()));
    }
    return RTC::RTC_ERROR;
  }

 private:
  using Answer = JARA::RETURN_ID*;
  using Position = JARA::CarPosWithElbow;
  std::vector<double> in_;
  std::ostringstream out_;

  double value(std::size_t i) const { return i < in_.size() ? in_[i] : 0; }
  JARA::ULONG ratio() const { return static_cast<JARA::ULONG>(value(0)); }
  template <class Sequence>
  Sequence sequence() const {
    Sequence made;
    made.length(static_cast<CORBA::ULong>(in_.size()));
    for (CORBA::ULong i = 0; i < made.length(); ++i) made[i] = in_[i];
    return made;
  }
  // Twelve numbers, row by row.
  Position position(std::size_t first = 0) const {
    Position made{};
    for (std::size_t k = 0; k < 12; ++k) made.carPos[k / 4][k % 4] = value(first + k);
    return made;
  }
  template <class Sequence>
  void show(const Sequence& values) {
    for (CORBA::ULong i = 0; i < values.length(); ++i) out_ << " " << values[i];
  }
  void show_matrix(const JARA::HgMatrix matrix) {
    for (int k = 0; k < 12; ++k) out_ << " " << matrix[k / 4][k % 4];
  }
  // lower, upper for each.
  JARA::LimitValue limit(std::size_t i) const {
    JARA::LimitValue made;
    made.lower = value(2 * i), made.upper = value(2 * i + 1);
    return made;
  }
  JARA::LimitSeq limits() const {
    JARA::LimitSeq made;
    made.length(static_cast<CORBA::ULong>(in_.size() / 2));
    for (CORBA::ULong i = 0; i < made.length(); ++i) made[i] = limit(i);
    return made;
  }

  Answer state() {
    JARA::ULONG state = 0;
    Answer answer = common_->getState(state);
    out_ << " " << state;
    return answer;
  }
  Answer joints() {
    JARA::JointPos_var joints;
    Answer answer = common_->getFeedbackPosJoint(joints.out());
    show(joints.in());
    return answer;
  }
  Answer alarms() {
    JARA::AlarmSeq_var alarms;
    Answer answer = common_->getActiveAlarm(alarms.out());
    for (CORBA::ULong i = 0; i < alarms->length(); ++i) out_ << " " << alarms[i].code << " " << alarms[i].description.in();
    return answer;
  }
  Answer information() {
    JARA::ManipInfo_var info;
    Answer answer = common_->getManipInfo(info.out());
    out_ << " " << info->manufactur.in() << " " << info->axisNum << " " << info->cmdCycle << " " << (info->isGripper ? 1 : 0);
    return answer;
  }
  Answer soft_limits() {
    JARA::LimitSeq_var all;
    Answer answer = common_->getSoftLimitJoint(all.out());
    for (CORBA::ULong i = 0; i < all->length(); ++i) out_ << " " << all[i].lower << " " << all[i].upper;
    return answer;
  }
  Answer cartesian_limits() {
    JARA::LimitValue all[3];
    Answer answer = middle_->getSoftLimitCartesian(all[0], all[1], all[2]);
    for (const auto& one : all) out_ << " " << one.lower << " " << one.upper;
    return answer;
  }
  Answer pose() {
    Position pose;
    Answer answer = middle_->getFeedbackPosCartesian(pose);
    show_matrix(pose.carPos);
    return answer;
  }
  Answer base() {
    JARA::HgMatrix matrix;
    Answer answer = middle_->getBaseOffset(matrix);
    show_matrix(matrix);
    return answer;
  }
  Answer max_joint_speeds() {
    JARA::DoubleSeq_var speeds;
    Answer answer = middle_->getMaxSpeedJoint(speeds.out());
    show(speeds.in());
    return answer;
  }
  Answer max_cartesian_speed() {
    JARA::CartesianSpeed speed;
    Answer answer = middle_->getMaxSpeedCartesian(speed);
    out_ << " " << speed.translation << " " << speed.rotation;
    return answer;
  }
  Answer set_max_cartesian_speed() {
    JARA::CartesianSpeed speed;
    speed.translation = value(0), speed.rotation = value(1);
    return middle_->setMaxSpeedCartesian(speed);
  }
  Answer min_joint_time() {
    CORBA::Double time = 0;
    Answer answer = middle_->getMinAccelTimeJoint(time);
    out_ << " " << time;
    return answer;
  }
  Answer min_cartesian_time() {
    CORBA::Double time = 0;
    Answer answer = middle_->getMinAccelTimeCartesian(time);
    out_ << " " << time;
    return answer;
  }
#ifdef HAS_HOME
  Answer home() {
    JARA::JointPos_var joints;
    Answer answer = middle_->getHome(joints.out());
    show(joints.in());
    return answer;
  }
#endif

  std::string answer(const std::string& call) {
    std::istringstream words(call);
    std::string name;
    words >> name;
    in_.clear();
    out_.str("");
    for (std::string word; words >> word;) in_.push_back(std::stod(word));
    const JARA::RETURN_ID_var answer(calls().at(name)());
    std::ostringstream line;
    line << name << ": " << answer->id << " " << answer->comment.in() << out_.str();
    return line.str();
  }

  using Calls = std::map<std::string, std::function<Answer()>>;
  Calls calls() {
    Calls all{{"clearAlarms", [this] { return common_->clearAlarms(); }},
              {"getActiveAlarm", [this] { return alarms(); }},
              {"getFeedbackPosJoint", [this] { return joints(); }},
              {"getManipInfo", [this] { return information(); }},
              {"getSoftLimitJoint", [this] { return soft_limits(); }},
              {"getState", [this] { return state(); }},
              {"servoOFF", [this] { return common_->servoOFF(); }},
              {"servoON", [this] { return common_->servoON(); }},
              {"setSoftLimitJoint", [this] { return common_->setSoftLimitJoint(limits()); }},
              {"closeGripper", [this] { return middle_->closeGripper(); }},
              {"getBaseOffset", [this] { return base(); }},
              {"getFeedbackPosCartesian", [this] { return pose(); }},
              {"getMaxSpeedCartesian", [this] { return max_cartesian_speed(); }},
              {"getMaxSpeedJoint", [this] { return max_joint_speeds(); }},
              {"getMinAccelTimeCartesian", [this] { return min_cartesian_time(); }},
              {"getMinAccelTimeJoint", [this] { return min_joint_time(); }},
              {"getSoftLimitCartesian", [this] { return cartesian_limits(); }},
              {"moveGripper", [this] { return middle_->moveGripper(ratio()); }},
              {"moveLinearCartesianAbs", [this] { return middle_->moveLinearCartesianAbs(position()); }},
              {"moveLinearCartesianRel", [this] { return middle_->moveLinearCartesianRel(position()); }},
              {"movePTPCartesianAbs", [this] { return middle_->movePTPCartesianAbs(position()); }},
              {"movePTPCartesianRel", [this] { return middle_->movePTPCartesianRel(position()); }},
              {"movePTPJointAbs", [this] { return middle_->movePTPJointAbs(sequence<JARA::JointPos>()); }},
              {"movePTPJointRel", [this] { return middle_->movePTPJointRel(sequence<JARA::JointPos>()); }},
              {"openGripper", [this] { return middle_->openGripper(); }},
              {"pause", [this] { return middle_->pause(); }},
              {"resume", [this] { return middle_->resume(); }},
              {"stop", [this] { return middle_->stop(); }}};
    all.merge(settings());
    return all;
  }
  Calls settings() {
    return {{"setAccelTimeCartesian", [this] { return middle_->setAccelTimeCartesian(value(0)); }},
            {"setAccelTimeJoint", [this] { return middle_->setAccelTimeJoint(value(0)); }},
            {"setBaseOffset", [this] { return middle_->setBaseOffset(position().carPos); }},
            {"setControlPointOffset", [this] { return middle_->setControlPointOffset(position().carPos); }},
            {"setMaxSpeedCartesian", [this] { return set_max_cartesian_speed(); }},
            {"setMaxSpeedJoint", [this] { return middle_->setMaxSpeedJoint(sequence<JARA::DoubleSeq>()); }},
            {"setMinAccelTimeCartesian", [this] { return middle_->setMinAccelTimeCartesian(value(0)); }},
            {"setMinAccelTimeJoint", [this] { return middle_->setMinAccelTimeJoint(value(0)); }},
            {"setSoftLimitCartesian", [this] { return middle_->setSoftLimitCartesian(limit(0), limit(1), limit(2)); }},
            {"setSpeedCartesian", [this] { return middle_->setSpeedCartesian(ratio()); }},
#ifdef HAS_HOME
            {"moveCircularCartesianAbs", [this] { return middle_->moveCircularCartesianAbs(position(), position(12)); }},
            {"moveCircularCartesianRel", [this] { return middle_->moveCircularCartesianRel(position(), position(12)); }},
            {"setHome", [this] { return middle_->setHome(sequence<JARA::JointPos>()); }},
            {"getHome", [this] { return home(); }},
            {"goHome", [this] { return middle_->goHome(); }},
#endif
            {"setSpeedJoint", [this] { return middle_->setSpeedJoint(ratio()); }}};
  }

  std::string calls_;
  RTC::CorbaPort common_port_, middle_port_;
  RTC::CorbaConsumer<JARA::ManipulatorCommonInterface_Common> common_;
  RTC::CorbaConsumer<JARA::ManipulatorCommonInterface_Middle> middle_;
};

inline coil::Properties caller_profile(const char* name) {
  coil::Properties profile;
  profile["implementation_id"] = profile["type_name"] = name;
  profile["description"] = "Calls the JARA services of an arm";
  profile["version"] = "1.0.0";
  profile["vendor"] = "rtm-sim";
  profile["category"] = "test";
  profile["activity_type"] = "PERIODIC";
  profile["kind"] = "DataFlowComponent";
  profile["max_instance"] = "0";
  profile["language"] = "C++";
  profile["lang_type"] = "compile";
  profile["exec_cxt.periodic.rate"] = "10";
  profile["conf.default.calls"] = "getState";
  return profile;
}
