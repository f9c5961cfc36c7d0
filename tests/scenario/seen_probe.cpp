// A component that calls the services of devices that look: what its parameter `call` says, when it is activated. It goes to the error
// state at an answer that is not as expected.
#include <rtm/CorbaConsumer.h>
#include <rtm/CorbaPort.h>
#include <rtm/DataFlowComponentBase.h>
#include <rtm/DataInPort.h>
#include <rtm/Manager.h>
#include <rtm/ext/FiducialSkel.h>
#include <rtm/ext/MulticameraSkel.h>
#include <rtm/ext/OGMapServerSkel.h>
#include <rtm/ext/OGMapSkel.h>
#include <rtm/ext/PathPlannerSkel.h>

#include <chrono>
#include <cmath>
#include <functional>
#include <map>
#include <string>
#include <thread>

namespace {

bool is_near(double got, double wanted) { return std::abs(got - wanted) < 1e-6; }

}  // namespace

class SeenProbe : public RTC::DataFlowComponentBase {
 public:
  explicit SeenProbe(RTC::Manager* manager)
      : RTC::DataFlowComponentBase(manager),
        fiducial_port_("fiducial"),
        multicamera_port_("multicamera"),
        map_port_("map"),
        path_in_("path", path_) {}

  RTC::ReturnCode_t onInitialize() override {
    fiducial_port_.registerConsumer("fiducial", "RTC::Fiducial", fiducial_);
    multicamera_port_.registerConsumer("multicamera", "RTC::Multicamera", multicamera_);
    map_port_.registerConsumer("map", "RTC::OGMap", map_);
    map_port_.registerConsumer("server", "RTC::OGMapServer", server_);
    map_port_.registerConsumer("planner", "RTC::PathPlanner2D", planner_);
    addInPort("path", path_in_);
    for (auto* port : {&fiducial_port_, &multicamera_port_, &map_port_}) addPort(*port);
    bindParameter("call", call_, "");
    return RTC::RTC_OK;
  }

  RTC::ReturnCode_t onActivated(RTC::UniqueId) override {
    const std::map<std::string, std::function<bool()>> calls{
        {"view", [this] { return has_view(0, 6, 1.2) && is_near(fiducial_->GetGeometry().pose.position.z, 0.9); }},
        {"near",
         [this] {
           return fiducial_->SetFOV({0, 2.6, 9}), has_view(0, 2.6, 1.2);
         }},
        {"nan",
         [this] {
           return fiducial_->SetFOV({std::nan(""), std::nan(""), std::nan("")}), has_view(0, 6, 1.2);
         }},
        {"stereo", [this] { return is_stereo(); }},
        {"map", [this] { return is_map(); }},
        {"plan", [this] { return planner_->SetTask(a_task(4)), is_planned(); }},
        {"plan_into_the_box", [this] { return refuses(a_task(2)); }},
        {"plan_nan", [this] { return refuses(a_task(std::nan(""))); }},
        {"plan_nothing", [this] { return refuses({}); }},
        {"server", [this] { return is_served_map(); }},
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
  bool has_view(double least, double most, double angle) {
    const RTC::FiducialFOV view = fiducial_->GetFOV();
    return is_near(view.minRange, least) && is_near(view.maxRange, most) && is_near(view.viewAngle, angle);
  }

  bool is_stereo() {
    const RTC::MulticameraGeometry_var geometry = multicamera_->GetGeometry();
    RTC::MulticameraInfoList_var infos = multicamera_->GetCameraInfos();
    const auto& cameras = geometry->cameraGeometries;
    const double focal = 160 / std::tan(0.6);  // 320 pixels see 1.2 rad
    return cameras.length() == 2 && infos->length() == 2 && is_near(cameras[0].pose.position.y - cameras[1].pose.position.y, 0.12) &&
           is_near(infos[0].focalLength.x, focal) && is_near(infos[1].principalPoint.y, 120);
  }

  // The box of 1 m at (2, 3): 400 cells of 0.05 m.
  static bool has_box(const RTC::OGMapTile& tile, const RTC::OGMapConfig& config, bool is_top_down) {
    int occupied = 0, inside = 0;
    for (CORBA::ULong y = 0; y < tile.height; ++y) {
      for (CORBA::ULong x = 0; x < tile.width; ++x) {
        if (tile.cells[y * tile.width + x] != 0) continue;
        const double row = is_top_down ? config.height - 1.0 - y : y;
        const double px = config.origin.position.x + (x + 0.5) * config.xScale, py = config.origin.position.y + (row + 0.5) * config.yScale;
        ++occupied;
        if (std::abs(px - 2) < 0.5 && std::abs(py - 3) < 0.5) ++inside;
      }
    }
    return occupied == 400 && inside == 400;
  }

  bool is_map() {
    const RTC::OGMapConfig config = map_->GetConfig();
    RTC::OGMapTile wanted;
    wanted.column = wanted.row = 0;
    wanted.width = config.width + 7;  // what is beyond the map is left out
    wanted.height = config.height;
    const RTC::OGMapTile_var tile = map_->GetTile(wanted);
    return is_near(config.xScale, 0.05) && tile->width == config.width && has_box(tile.in(), config, false);
  }

  // Past the box at (2, 3).
  static RTC::Waypoint2DList a_task(double x) {
    RTC::Waypoint2DList task;
    task.length(2);
    task[0] = {{{0, 3}, 0}, 0, 0, {0, 0}, {0, 0, 0}};
    task[1] = {{{x, 3}, 0.7}, 0.02, 0.03, {0, 0}, {0.2, 0, 0}};
    return task;
  }
  bool refuses(const RTC::Waypoint2DList& task) {
    try {
      planner_->SetTask(task);
      return false;
    } catch (const CORBA::BAD_PARAM&) {
      return true;
    }
  }
  bool is_planned() {
    const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    while (!path_in_.isNew()) {
      if (std::chrono::steady_clock::now() > until) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    path_in_.read();
    const auto& points = path_.waypoints;
    if (points.length() < 2) return false;
    const RTC::Waypoint2D &corner = points[0], &last = points[points.length() - 1];
    return std::abs(corner.target.position.y - 3) > 0.75 && corner.headingTolerance > 3 && last.target.position.x == 4 &&
           last.target.heading == 0.7 && last.distanceTolerance == 0.02 && last.maxSpeed.vx == 0.2;
  }

  bool is_served_map() {
    MobileRobot::OGMap_var map;
    return server_->requestCurrentBuiltMap(map.out()) == MobileRobot::RETVAL_OK && has_box(map->map, map->config, true);
  }

  std::string call_;
  RTC::CorbaPort fiducial_port_, multicamera_port_, map_port_;
  RTC::CorbaConsumer<RTC::Fiducial> fiducial_;
  RTC::CorbaConsumer<RTC::Multicamera> multicamera_;
  RTC::CorbaConsumer<RTC::OGMap> map_;
  RTC::CorbaConsumer<RTC::PathPlanner2D> planner_;
  RTC::Path2D path_;
  RTC::InPort<RTC::Path2D> path_in_;
  RTC::CorbaConsumer<MobileRobot::OGMapServer> server_;
};

// clang-format off
static const char* const seenprobe_spec[] = {
    "implementation_id", "SeenProbe",
    "type_name", "SeenProbe",
    "description", "Calls the services of devices that look",
    "version", "1.0.0",
    "vendor", "rtm-sim",
    "category", "test",
    "activity_type", "PERIODIC",
    "kind", "DataFlowComponent",
    "max_instance", "0",
    "language", "C++",
    "lang_type", "compile",
    "exec_cxt.periodic.rate", "10",
    "conf.default.call", "view",
    ""};
// clang-format on

extern "C" {
DLL_EXPORT void SeenProbeInit(RTC::Manager* manager) {
  coil::Properties profile(seenprobe_spec);
  manager->registerFactory(profile, RTC::Create<SeenProbe>, RTC::Delete<SeenProbe>);
}
}
