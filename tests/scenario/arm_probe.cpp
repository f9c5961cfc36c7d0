// A component that calls the services of arms and hands: what its parameter `call` says, when it is activated. It goes to the error state
// at an answer that is not as expected, which its log names.
#include <rtm/CorbaConsumer.h>
#include <rtm/CorbaPort.h>
#include <rtm/DataFlowComponentBase.h>
#include <rtm/Manager.h>
#include <rtm/ext/ActArraySkel.h>
#include <rtm/ext/GripperSkel.h>
#include <rtm/ext/LimbSkel.h>
#include <rtm/ext/RobotHardwareServiceSkel.h>

#include <cmath>
#include <functional>
#include <map>
#include <string>

class ArmProbe : public RTC::DataFlowComponentBase {
 public:
  explicit ArmProbe(RTC::Manager* manager)
      : RTC::DataFlowComponentBase(manager),
        array_port_("act_array"),
        gripper_port_("gripper"),
        hardware_port_("hardware"),
        limb_port_("limb") {}

  RTC::ReturnCode_t onInitialize() override {
    array_port_.registerConsumer("act_array", "RTC::ActArray", array_);
    gripper_port_.registerConsumer("gripper", "RTC::Gripper", gripper_);
    hardware_port_.registerConsumer("service0", "RobotHardwareService", hardware_);
    addPort(array_port_);
    addPort(gripper_port_);
    addPort(hardware_port_);
    limb_port_.registerConsumer("limb", "RTC::Limb", limb_);
    addPort(limb_port_);
    bindParameter("call", call_, "");
    return RTC::RTC_OK;
  }

  RTC::ReturnCode_t onActivated(RTC::UniqueId) override {
    const std::map<std::string, std::function<bool()>> calls{
        {"geometry", [this] { return has_geometry(); }},
        {"home", [this] { return array_->GoHome(65535), true; }},
        {"brakes_on", [this] { return array_->Brakes(true), true; }},
        {"brakes_off", [this] { return array_->Brakes(false), true; }},
        {"slow", [this] { return array_->ConfigSpeed(0, 0.1), true; }},
        {"too_fast", [this] { return array_->ConfigSpeed(0, 1000), true; }},
        {"no_joint", [this] { return array_->GoHome(77), true; }},
        {"servo_off",
         [this] { return hardware_->servo("all", Hardware::SWITCH_OFF) && !hardware_->servo("nobody", Hardware::SWITCH_OFF); }},
        {"servo_on", [this] { return hardware_->servo("waist", Hardware::SWITCH_ON) && has_status(); }},
        {"half_gain", [this] { return hardware_->setServoGainPercentage("shoulder", 50), true; }},
        {"too_much_gain", [this] { return hardware_->setServoGainPercentage("shoulder", 1000), true; }},
        {"torque_mode", [this] { return hardware_->setJointControlMode("twist", Hardware::TORQUE), true; }},
        {"free_mode", [this] { return hardware_->setJointControlMode("twist", Hardware::FREE), true; }},
        {"position_mode", [this] { return hardware_->setJointControlMode("twist", Hardware::POSITION), true; }},
        {"error_limit", [this] { return hardware_->setServoErrorLimit("waist", 0.05), true; }},
        {"limb_brakes_on", [this] { return limb_->Brakes(true), true; }},
        {"limb_brakes_off", [this] { return limb_->Brakes(false), true; }},
        {"limb_power_off", [this] { return limb_->Power(false), true; }},
        {"limb_speed", [this] { return limb_->SetSpeed(-1), std::abs(limb_->GetGeometry().pose.position.z - 0.1) < 1e-9; }},
        {"open", [this] { return gripper_->Open(), true; }},
        {"close", [this] { return gripper_->Close(), true; }},
    };
    try {
      return calls.at(call_)() ? RTC::RTC_OK : RTC::RTC_ERROR;
    } catch (const CORBA::Exception& e) {
      RTC_ERROR(("no answer: %s", e._name()));
    }
    return RTC::RTC_ERROR;
  }

 private:
  using Hardware = OpenHRP::RobotHardwareService;

  bool has_status() {
    Hardware::RobotState_var state;
    hardware_->getStatus(state.out());
    const bool is_good = state->angle.length() == 6 && state->servoState.length() == 6 && state->servoState[0].length() == 1 &&
                         state->servoState[1][0] == 5 && std::abs(state->angle[2] - 1.4) < 0.01;
    if (!is_good) RTC_ERROR(("the status of %u joints is not that of the arm", state->angle.length()));
    return is_good;
  }

  bool has_geometry() {
    const RTC::ActArrayGeometry_var geometry = array_->GetGeometry();
    const auto& all = geometry->actuatorGeometry;
    if (all.length() != 6 || all[1].type != RTC::ACTARRAY_ACTUATORTYPE_ROTARY || std::abs(all[1].length - 0.35) > 1e-9 ||
        std::abs(all[1].maxRange - 1.9) > 1e-9 || std::abs(all[1].axis.y - 1) > 1e-9 || !all[1].hasBrakes ||
        std::abs(all[2].homePosition - 1.75) > 1e-9 || std::abs(geometry->arrayGeometry.pose.position.z - 0.1) > 1e-9) {
      RTC_ERROR(("geometry of %u joints is not that of the arm", all.length()));
      return false;
    }
    const RTC::GripperGeometry gripper = gripper_->GetGeometry();
    if (std::abs(gripper.interior.size.w - 0.08) > 1e-9) RTC_ERROR(("the gripper opens %g m", gripper.interior.size.w));
    return std::abs(gripper.interior.size.w - 0.08) < 1e-9;
  }

  std::string call_;
  RTC::CorbaPort array_port_, gripper_port_, hardware_port_, limb_port_;
  RTC::CorbaConsumer<RTC::ActArray> array_;
  RTC::CorbaConsumer<RTC::Gripper> gripper_;
  RTC::CorbaConsumer<Hardware> hardware_;
  RTC::CorbaConsumer<RTC::Limb> limb_;
};

// clang-format off
static const char* const armprobe_spec[] = {
    "implementation_id", "ArmProbe",
    "type_name", "ArmProbe",
    "description", "Calls the services of arms and hands",
    "version", "1.0.0",
    "vendor", "rtm-sim",
    "category", "test",
    "activity_type", "PERIODIC",
    "kind", "DataFlowComponent",
    "max_instance", "0",
    "language", "C++",
    "lang_type", "compile",
    "exec_cxt.periodic.rate", "10",
    "conf.default.call", "geometry",
    ""};
// clang-format on

extern "C" {
DLL_EXPORT void ArmProbeInit(RTC::Manager* manager) {
  coil::Properties profile(armprobe_spec);
  manager->registerFactory(profile, RTC::Create<ArmProbe>, RTC::Delete<ArmProbe>);
}
}
