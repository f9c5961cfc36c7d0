// A component that calls the services of devices: what its parameter `call` says, when it is activated. It goes to the error state at an
// answer that is not as expected, which its log names.
#include <rtm/CorbaConsumer.h>
#include <rtm/CorbaPort.h>
#include <rtm/DataFlowComponentBase.h>
#include <rtm/Manager.h>
#include <rtm/ext/BumperSkel.h>
#include <rtm/ext/CameraSkel.h>
#include <rtm/ext/DIOSkel.h>
#include <rtm/ext/GPSSkel.h>
#include <rtm/ext/IMUSkel.h>
#include <rtm/ext/OdometrySkel.h>
#include <rtm/ext/PathFollowerSkel.h>
#include <rtm/ext/RFIDSkel.h>
#include <rtm/ext/RangerSkel.h>
#include <rtm/ext/VelocityControlSkel.h>

#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <string>

namespace {

bool is_near(double got, double wanted) { return std::abs(got - wanted) < 1e-6; }

}  // namespace

class DeviceProbe : public RTC::DataFlowComponentBase {
 public:
  explicit DeviceProbe(RTC::Manager* manager)
      : RTC::DataFlowComponentBase(manager),
        ranger_port_("ranger"),
        camera_port_("camera"),
        imu_port_("imu"),
        gps_port_("gps"),
        rfid_port_("rfid"),
        bumper_port_("bumper"),
        drive_port_("drive") {}

  RTC::ReturnCode_t onInitialize() override {
    ranger_port_.registerConsumer("ranger", "RTC::Ranger", ranger_);
    camera_port_.registerConsumer("camera", "RTC::Camera", camera_);
    imu_port_.registerConsumer("imu", "RTC::IMU", imu_);
    gps_port_.registerConsumer("gps", "RTC::GPS", gps_);
    rfid_port_.registerConsumer("rfid", "RTC::RFID", rfid_);
    bumper_port_.registerConsumer("bumper", "RTC::Bumper", bumper_);
    bumper_port_.registerConsumer("dio", "RTC::DIO", dio_);
    drive_port_.registerConsumer("path_follower", "RTC::PathFollower2D", path_);
    drive_port_.registerConsumer("odometry", "RTC::Odometry2D", odometry_);
    drive_port_.registerConsumer("velocity_control", "RTC::VelocityControl2D", velocity_);
    for (auto* port : {&ranger_port_, &camera_port_, &imu_port_, &gps_port_, &rfid_port_, &bumper_port_, &drive_port_}) addPort(*port);
    bindParameter("call", call_, "");
    return RTC::RTC_OK;
  }

  RTC::ReturnCode_t onActivated(RTC::UniqueId) override {
    const std::map<std::string, std::function<bool()>> calls{
        {"laser", [this] { return is_laser(ranger_->GetConfig()); }},
        {"narrow",
         [this] { return asked([](RTC::RangerConfig& c) { c.minAngle = -0.5, c.maxAngle = 0.5, c.angularRes *= 2, c.maxRange = 1; }); }},
        {"nan", [this] { return asked([](RTC::RangerConfig& c) { c.minAngle = std::numeric_limits<double>::quiet_NaN(); }); }},
        {"all", [this] { return asked([](RTC::RangerConfig& c) { c = {}; }) && is_laser(ranger_->GetConfig()); }},
        {"power_off", [this] { return ranger_->Power(false), true; }},
        {"power_on", [this] { return ranger_->Power(true), true; }},
        {"intensities_off", [this] { return ranger_->EnableIntensities(false), true; }},
        {"intensities_on", [this] { return ranger_->EnableIntensities(true), true; }},
        {"sonar", [this] { return is_sonar(); }},
        {"camera", [this] { return is_camera(); }},
        {"place", [this] { return is_at(imu_->GetGeometry(), 0.1) && is_at(gps_->GetGeometry(), 0.2); }},
        {"tag", [this] { return is_tag(); }},
        {"write_tag", [this] { return write_tag(); }},
        {"tag_written", [this] { return is_written(); }},
        {"bumper",
         [this] {
           const RTC::BumperGeometry shape = bumper_->GetGeometry();
           return is_near(shape.size.l, 0.3) && is_near(shape.size.h, 0.3) && is_near(shape.roc, 0);
         }},
        {"pressed", [this] { return is_pressed(); }},
        {"path", [this] { return path_->SetPath(a_path(0.3)), path_->Enable(true), path_->GetCurrentWaypointIndex() == 0; }},
        {"path_on_hold",
         [this] { return path_->Enable(false), path_->SetPath(a_path(0.6)), is_near(path_->GetCurrentWaypoint().target.position.x, 0.6); }},
        {"path_done", [this] { return has_no_path(); }},
        {"path_nan", [this] { return refuses([this] { path_->SetPath(a_path(std::nan(""))); }); }},
        {"path_huge",
         [this] {
           return refuses([this] {
             RTC::Waypoint2DList many;
             many.length(20000);
             path_->SetPath(many);
           });
         }},
        {"odometry",
         [this] {
           return odometry_->SetOdometry({{7, -3}, 1}), true;
         }},
        {"odometry_nan",
         [this] {
           return odometry_->SetOdometry({{std::nan(""), 0}, 0}), true;
         }},
        {"size",
         [this] {
           return odometry_->GetGeometry().size.l > 0.2 && is_near(velocity_->GetGeometry().size.l, odometry_->GetGeometry().size.l);
         }},
    };
    try {
      if (calls.at(call_)()) return RTC::RTC_OK;
      RTC_ERROR(("%s: another answer was expected", call_.c_str()));
    } catch (const CORBA::Exception& e) {
      RTC_ERROR(("no answer: %s", e._name()));
    }
    return RTC::RTC_ERROR;
  }

 private:
  bool asked(const std::function<void(RTC::RangerConfig&)>& change) {
    RTC::RangerConfig config = ranger_->GetConfig();
    change(config);
    ranger_->SetConfig(config);
    return true;
  }

  // A corner that is passed in any heading, and a pose to the left of it.
  static RTC::Waypoint2DList a_path(double x) {
    RTC::Waypoint2DList path;
    path.length(2);
    path[0] = {{{x, 0}, 0}, 0.1, 4, {0, 0}, {0.3, 0, 0}};
    path[1] = {{{x, 0.3}, 1.5}, 0, 0, {0, 0}, {0, 0, 0}};
    return path;
  }
  static bool refuses(const std::function<void()>& act) {
    try {
      act();
      return false;
    } catch (const CORBA::BAD_PARAM&) {
      return true;
    }
  }
  bool has_no_path() {
    if (path_->GetCurrentWaypointIndex() != 65535) return false;
    try {
      path_->GetCurrentWaypoint();
      return false;
    } catch (const CORBA::BAD_INV_ORDER&) {
      return true;
    }
  }
  // The only bit, which cannot be written.
  bool is_pressed() {
    try {
      dio_->SetBit(0, false);
      return false;
    } catch (const CORBA::NO_PERMISSION&) {
    }
    return dio_->NumBits() == 1 && dio_->GetBit(0) && refuses([this] { dio_->GetBit(1); });
  }

  bool is_laser(const RTC::RangerConfig& config) {
    const RTC::RangerGeometry_var geometry = ranger_->GetGeometry();
    return config.maxAngle > 1.5 && is_near(config.minAngle, -config.maxAngle) && config.angularRes > 0 && config.maxRange > 1 &&
           geometry->elementGeometries.length() == 0 && geometry->geometry.pose.position.z > 0;
  }

  bool is_sonar() {
    const RTC::RangerGeometry_var geometry = ranger_->GetGeometry();
    return geometry->elementGeometries.length() == 16;
  }

  bool is_camera() {
    const RTC::CameraInfo info = camera_->GetCameraInfo();
    const double focal = 12 / std::tan(0.6);  // 24 pixels see 1.2 rad
    return is_near(info.focalLength.x, focal) && is_near(info.focalLength.y, focal) && is_near(info.principalPoint.x, 12) &&
           is_near(info.principalPoint.y, 8) && is_near(info.k1, -0.1) && is_near(info.p2, 0.01) && is_at(camera_->GetGeometry(), 0);
  }

  // Of worlds/devices.sdf; there is no other one.
  bool is_tag() {
    const RTC::RFIDTagData_var data = rfid_->Read("E200-0017");
    const std::string text(data->get_buffer(), data->get_buffer() + data->length());
    RTC::RFIDTagData impossible;
    impossible.length(200);
    for (const auto& [id, bytes] : {std::pair{"other", RTC::RFIDTagData(data.in())}, std::pair{"E200-0017", impossible}}) {
      try {
        rfid_->Write(id, bytes);
        return false;
      } catch (const CORBA::BAD_PARAM&) {
      }
    }
    try {
      RTC::RFIDTagData_var other = rfid_->Read("other");
      return false;
    } catch (const CORBA::BAD_PARAM&) {
    }
    return text == "shelf 3" && is_near(rfid_->GetGeometry().pose.position.z, 0.3);
  }

  bool write_tag() {
    RTC::RFIDTagData data;
    const std::string text = "shelf 42";
    data.length(static_cast<CORBA::ULong>(text.size()));
    for (CORBA::ULong i = 0; i < data.length(); ++i) data[i] = static_cast<CORBA::Octet>(text[i]);
    rfid_->Write("E200-0017", data);
    return true;
  }
  bool is_written() {
    const RTC::RFIDTagData_var data = rfid_->Read("E200-0017");
    return std::string(data->get_buffer(), data->get_buffer() + data->length()) == "shelf 42";
  }

  static bool is_at(const RTC::Geometry3D& geometry, double x) { return is_near(geometry.pose.position.x, x); }

  std::string call_;
  RTC::CorbaPort ranger_port_, camera_port_, imu_port_, gps_port_, rfid_port_, bumper_port_, drive_port_;
  RTC::CorbaConsumer<RTC::Ranger> ranger_;
  RTC::CorbaConsumer<RTC::Camera> camera_;
  RTC::CorbaConsumer<RTC::IMU> imu_;
  RTC::CorbaConsumer<RTC::GPS> gps_;
  RTC::CorbaConsumer<RTC::RFID> rfid_;
  RTC::CorbaConsumer<RTC::Bumper> bumper_;
  RTC::CorbaConsumer<RTC::DIO> dio_;
  RTC::CorbaConsumer<RTC::PathFollower2D> path_;
  RTC::CorbaConsumer<RTC::Odometry2D> odometry_;
  RTC::CorbaConsumer<RTC::VelocityControl2D> velocity_;
};

// clang-format off
static const char* const deviceprobe_spec[] = {
    "implementation_id", "DeviceProbe",
    "type_name", "DeviceProbe",
    "description", "Calls the services of devices",
    "version", "1.0.0",
    "vendor", "rtm-sim",
    "category", "test",
    "activity_type", "PERIODIC",
    "kind", "DataFlowComponent",
    "max_instance", "0",
    "language", "C++",
    "lang_type", "compile",
    "exec_cxt.periodic.rate", "10",
    "conf.default.call", "laser",
    ""};
// clang-format on

extern "C" {
DLL_EXPORT void DeviceProbeInit(RTC::Manager* manager) {
  coil::Properties profile(deviceprobe_spec);
  manager->registerFactory(profile, RTC::Create<DeviceProbe>, RTC::Delete<DeviceProbe>);
}
}
