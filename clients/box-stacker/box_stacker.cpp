#include "box_stacker.h"

#include <sstream>

// clang-format off
static const char* const boxstacker_spec[] = {
    "implementation_id", "BoxStacker",
    "type_name", "BoxStacker",
    "description", "Stacks boxes with an arm",
    "version", "1.0.0",
    "vendor", "rtm-sim",
    "category", "manipulation",
    "activity_type", "PERIODIC",
    "kind", "DataFlowComponent",
    "max_instance", "0",
    "language", "C++",
    "lang_type", "compile",
    "exec_cxt.periodic.rate", "10",
    "exec_cxt.sim_time.phase", "1",
    "conf.default.boxes", "0.45,-0.2;0.45,0.2",
    "conf.default.stack", "0.45,0",
    "conf.default.size", "0.05",
    "conf.default.approach", "0.12",
    "conf.default.tool", "0.09",
    "conf.default.speed", "60",
    "conf.__type__.boxes", "string",
    "conf.__type__.stack", "string",
    "conf.__type__.size", "double",
    "conf.__type__.approach", "double",
    "conf.__type__.tool", "double",
    "conf.__type__.speed", "int",
    "conf.__widget__.boxes", "text",
    "conf.__widget__.stack", "text",
    "conf.__widget__.size", "text",
    "conf.__widget__.approach", "text",
    "conf.__widget__.tool", "text",
    "conf.__widget__.speed", "spin",
    "conf.__constraints__.speed", "1<=x<=100",
    ""};
// clang-format on

namespace {

constexpr JARA_ARM::ULONG is_moving = JARA_ARM::CONST_BINARY_00000010, has_alarm = JARA_ARM::CONST_BINARY_00000100;
constexpr double gap = 0.001;  // [m] under a box that the arm lets go

// The hand points down, the fingers move along y.
JARA_ARM::CarPosWithElbow pointing_down(double x, double y, double z) {
  JARA_ARM::CarPosWithElbow pose{};
  pose.carPos[0][0] = -1, pose.carPos[1][1] = 1, pose.carPos[2][2] = -1;
  pose.carPos[0][3] = x, pose.carPos[1][3] = y, pose.carPos[2][3] = z;
  return pose;
}

}  // namespace

BoxStacker::BoxStacker(RTC::Manager* manager)
    : RTC::DataFlowComponentBase(manager), stacked_out_("stacked", stacked_), common_port_("common"), middle_port_("middle") {}

RTC::ReturnCode_t BoxStacker::onInitialize() {
  addOutPort("stacked", stacked_out_);
  common_port_.registerConsumer("common", "JARA_ARM::ManipulatorCommonInterface_Common", common_);
  middle_port_.registerConsumer("middle", "JARA_ARM::ManipulatorCommonInterface_Middle", middle_);
  addPort(common_port_);
  addPort(middle_port_);
  bindParameter("boxes", boxes_, "0.45,-0.2;0.45,0.2");
  bindParameter("stack", stack_, "0.45,0");
  bindParameter("size", size_, "0.05");
  bindParameter("approach", approach_, "0.12");
  bindParameter("tool", tool_, "0.09");
  bindParameter("speed", speed_, "60");
  return RTC::RTC_OK;
}

std::vector<BoxStacker::Place> BoxStacker::places_of(const std::string& text) {
  std::vector<Place> places;
  std::istringstream all(text);
  for (std::string one; std::getline(all, one, ';');) {
    std::istringstream words(one);
    Place place;
    char comma = 0;
    if (!(words >> place.x >> comma >> place.y) || comma != ',') return {};
    places.push_back(place);
  }
  return places;
}

RTC::ReturnCode_t BoxStacker::onActivated(RTC::UniqueId) {
  todo_ = places_of(boxes_);
  const auto target = places_of(stack_);
  if (todo_.empty() || target.size() != 1) {
    RTC_ERROR(("boxes must be x,y;x,y;... and stack x,y, got \"%s\" and \"%s\"", boxes_.c_str(), stack_.c_str()));
    return RTC::RTC_ERROR;
  }
  target_ = target.front();
  done_ = 0;
  has_begun_ = has_finished_ = is_waiting_ = false;
  return RTC::RTC_OK;
}

RTC::ReturnCode_t BoxStacker::onDeactivated(RTC::UniqueId) {
  try {
    if (has_begun_ && !has_finished_) is_ok("stop", middle_->stop());
  } catch (const CORBA::Exception&) {
    // The arm has gone.
  }
  return RTC::RTC_OK;
}

RTC::ReturnCode_t BoxStacker::onExecute(RTC::UniqueId) {
  RTC::ReturnCode_t result = RTC::RTC_OK;
  try {
    if (!has_finished_) result = next();
    is_waiting_ = false;
  } catch (const CORBA::Exception& e) {
    if (!is_waiting_) RTC_WARN(("no answer from the arm: %s; waiting", e._name()));
    is_waiting_ = true;
  }
  setTimestamp(stacked_);
  stacked_.data = static_cast<CORBA::Long>(done_);
  stacked_out_.write();
  return result;
}

RTC::ReturnCode_t BoxStacker::next() {
  if (!has_begun_) {
    if (!begin()) return RTC::RTC_ERROR;
    has_begun_ = true;
    return stack(todo_[0], 1) ? RTC::RTC_OK : RTC::RTC_ERROR;
  }
  JARA_ARM::ULONG state = 0;
  if (!is_ok("getState", common_->getState(state))) return RTC::RTC_ERROR;
  if ((state & has_alarm) != 0) {
    RTC_ERROR(("the arm has an alarm; %zu boxes are stacked", done_));
    return RTC::RTC_ERROR;
  }
  if ((state & is_moving) != 0) return RTC::RTC_OK;
  if (done_ < todo_.size()) ++done_;
  if (done_ < todo_.size()) return stack(todo_[done_], done_ + 1) ? RTC::RTC_OK : RTC::RTC_ERROR;
  RTC_INFO(("%zu boxes are stacked", done_));
  has_finished_ = true;
  return is_ok("goHome", middle_->goHome()) ? RTC::RTC_OK : RTC::RTC_ERROR;
}

bool BoxStacker::begin() {
  JARA_ARM::HgMatrix tool = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, tool_}};
  return is_ok("servoON", common_->servoON()) && is_ok("setControlPointOffset", middle_->setControlPointOffset(tool)) &&
         is_ok("setSpeedJoint", middle_->setSpeedJoint(static_cast<JARA_ARM::ULONG>(speed_))) &&
         is_ok("setSpeedCartesian", middle_->setSpeedCartesian(static_cast<JARA_ARM::ULONG>(speed_)));
}

// The whole way of one box is queued at once.
bool BoxStacker::stack(const Place& box, std::size_t level) {
  const double pick = size_ / 2, place = size_ / 2 + static_cast<double>(level) * size_ + gap;
  return is_ok("openGripper", middle_->openGripper()) && go_above(box, pick + approach_) && go_straight(box, pick) &&
         is_ok("closeGripper", middle_->closeGripper()) && go_straight(box, pick + approach_) && go_above(target_, place + approach_) &&
         go_straight(target_, place) && is_ok("openGripper", middle_->openGripper()) && go_straight(target_, place + approach_);
}

bool BoxStacker::go_above(const Place& place, double height) {
  return is_ok("movePTPCartesianAbs", middle_->movePTPCartesianAbs(pointing_down(place.x, place.y, height)));
}

bool BoxStacker::go_straight(const Place& place, double height) {
  return is_ok("moveLinearCartesianAbs", middle_->moveLinearCartesianAbs(pointing_down(place.x, place.y, height)));
}

bool BoxStacker::is_ok(const char* call, JARA_ARM::RETURN_ID* answer) {
  const JARA_ARM::RETURN_ID_var mine(answer);
  if (mine->id == JARA_ARM::OK) return true;
  RTC_ERROR(("%s: the arm answers %d: %s", call, static_cast<int>(mine->id), mine->comment.in()));
  return false;
}

extern "C" {
void BoxStackerInit(RTC::Manager* manager) {
  coil::Properties profile(boxstacker_spec);
  manager->registerFactory(profile, RTC::Create<BoxStacker>, RTC::Delete<BoxStacker>);
}
}
