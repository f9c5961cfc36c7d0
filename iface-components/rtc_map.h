// RTCMap: the occupancy grid of the simulated world, as it is when it is asked for: static shapes that something as high as the robot would
// meet. Service port `map`: RTC::OGMap of the interface guidelines, and RTC::OGMapServer of the public navigation components
// (idl/ext/OGMapServer.idl; grey values, the row of the highest y first); RTC::PathPlanner2D, whose ways leave by the OutPort `path`
// (RTC::Path2D) with the next execution. Configuration: server_id; radius of the robot that ways are for [m]; resolution [m]; lowest,
// highest: z between which a shape occupies cells [m]; area: xmin,ymin,xmax,ymax [m], empty: where something is; movable: 1 counts models
// that can move; row_order: bottom_up or top_down, values: grey (0 occupied, 254 free, 205 unknown) or percent (0 free, 100 occupied, 255
// unknown), both of RTC::OGMap. A change takes effect while the component is active.
#pragma once

#include <rtm/ext/OGMapServerSkel.h>
#include <rtm/ext/OGMapSkel.h>
#include <rtm/ext/PathPlannerSkel.h>

#include <rtm/CorbaPort.h>
#include <rtm/DataFlowComponentBase.h>
#include <rtm/DataOutPort.h>
#include <rtm/Manager.h>

#include <base/guarded.h>
#include <shm/world_map.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "line_limit.h"
#include "specification.h"

struct MapSettings {
  int server_id = 0;
  shm::MapOptions options;
  double radius = 0.3;
  bool is_top_down = false, is_percent = false;
};

// Asks the simulator. Calls from any thread.
class MapSource {
 public:
  using Say = std::function<void(const std::string& line)>;
  using Map = std::shared_ptr<const shm::WorldMap>;  // null: there is none
  explicit MapSource(Say say) : say_(std::move(say)) {}

  void set(const MapSettings& settings) { *settings_.lock() = settings; }
  MapSettings settings() const { return *settings_.lock(); }
  // As it is now. A failure is said.
  Map fresh();
  // A way along all targets of a task, the first of which is where the robot is, with this time; also where nothing is on the map.
  base::Result<RTC::Path2D> plan(const RTC::Waypoint2DList& task) const;
  // The one of the last call, which a client reads in tiles; a fresh one if there is none.
  Map latest();

 private:
  Say say_;
  mutable base::Guarded<MapSettings, base::Rank::details> settings_;
  base::Guarded<Map, base::Rank::details> latest_;
};

// A client that no map can be sent to gets CORBA::TRANSIENT.
class OGMapService : public virtual POA_RTC::OGMap, public virtual PortableServer::RefCountServantBase {
 public:
  explicit OGMapService(MapSource& source) : source_(source) {}
  RTC::OGMapConfig GetConfig() override;
  // The part of the tile that lies in the map.
  RTC::OGMapTile* GetTile(const RTC::OGMapTile& tile) override;

 private:
  MapSource& source_;
};

class OGMapServerService : public virtual POA_MobileRobot::OGMapServer, public virtual PortableServer::RefCountServantBase {
 public:
  explicit OGMapServerService(MapSource& source) : source_(source) {}
  MobileRobot::RETURN_VALUE requestCurrentBuiltMap(MobileRobot::OGMap_out map) override;

 private:
  MapSource& source_;
};

// SetTask plans at once. Fewer than two way points, numbers that are not finite, or no way: CORBA::BAD_PARAM, and a line in the log.
class PathPlannerService : public virtual POA_RTC::PathPlanner2D, public virtual PortableServer::RefCountServantBase {
 public:
  PathPlannerService(MapSource& source, MapSource::Say say) : source_(source), say_(std::move(say)) {}
  void SetTask(const RTC::Waypoint2DList& task) override;
  // The newest way since the last call.
  std::optional<RTC::Path2D> take() { return std::exchange(*path_.lock(), std::nullopt); }

 private:
  MapSource& source_;
  MapSource::Say say_;
  base::Guarded<std::optional<RTC::Path2D>, base::Rank::details> path_;
};

class RTCMap : public RTC::DataFlowComponentBase {
 public:
  explicit RTCMap(RTC::Manager* manager);
  RTC::ReturnCode_t onInitialize() override;
  RTC::ReturnCode_t onActivated(RTC::UniqueId ec_id) override;
  RTC::ReturnCode_t onExecute(RTC::UniqueId ec_id) override;

 private:
  void follow_configuration();
  // Logs why the configuration makes no map; RTC_ERROR.
  RTC::ReturnCode_t reject(const std::string& why);

  MapSettings settings_;
  double lowest_ = 0.05, highest_ = 0.5;
  std::string area_, row_order_ = "bottom_up", values_ = "grey";
  int movable_ = 0;
  iface::LineLimit limit_;
  MapSource source_;
  OGMapService map_;
  OGMapServerService server_;
  PathPlannerService planner_;
  RTC::Path2D path_;
  RTC::OutPort<RTC::Path2D> path_out_;
  RTC::CorbaPort service_port_;
};

extern "C" {
DLL_EXPORT void RTCMapInit(RTC::Manager* manager);
}
