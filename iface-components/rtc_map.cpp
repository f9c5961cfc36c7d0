#include "rtc_map.h"

#include <base/text.h>
#include <shm/control.h>
#include <shm/map_path.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "conversions.h"

static const iface::Specification specification{
    .type_name = "RTCMap",
    .description = "Occupancy grid map of the simulated world",
    .phase = iface::sensor_phase,
    .parameters = {{"resolution", "0.05", "double", "text", "0.001<=x<=100"},
                   {"lowest", "0.05", "double", "text"},
                   {"highest", "0.5", "double", "text"},
                   {"area", "", "string", "text"},
                   {"movable", "0", "int", "radio", "(0,1)"},
                   {"radius", "0.3", "double", "text", "0<x<=100"},
                   {"row_order", "bottom_up", "string", "radio", "(bottom_up,top_down)"},
                   {"values", "grey", "string", "radio", "(grey,percent)"}},
};

namespace {

constexpr std::chrono::minutes map_timeout{1};
constexpr std::uint8_t grey_occupied = 0, grey_unknown = 205;

std::uint8_t in_percent(std::uint8_t grey) {
  constexpr std::uint8_t occupied = 100, unknown = 255;
  return grey == grey_occupied ? occupied : grey == grey_unknown ? unknown : 0;
}

RTC::OGMapConfig config_of(const shm::MapArea& area) {
  return {area.resolution,
          area.resolution,
          static_cast<CORBA::ULong>(area.width),
          static_cast<CORBA::ULong>(area.height),
          {{area.x, area.y}, 0}};
}

// Empty: it is no area. None is one, too.
std::optional<std::vector<double>> area_of(const std::string& text) {
  std::vector<double> area;
  for (const auto& word : base::split_list(text)) {
    const auto number = base::parse_number(word);
    if (!number) return std::nullopt;
    area.push_back(*number);
  }
  if (area.empty() || (area.size() == 4 && area[2] > area[0] && area[3] > area[1])) return area;
  return std::nullopt;
}

// `pixels` have the row of the highest y first.
void fill_tile(const shm::WorldMap& map, bool is_top_down, bool is_percent, RTC::OGMapTile& tile) {
  const auto columns = static_cast<CORBA::ULong>(map.area.width), rows = static_cast<CORBA::ULong>(map.area.height);
  tile.width = std::min(tile.width, columns - std::min(tile.column, columns));
  tile.height = std::min(tile.height, rows - std::min(tile.row, rows));
  tile.cells.length(tile.width * tile.height);
  for (CORBA::ULong y = 0; y < tile.height; ++y) {
    const CORBA::ULong row = is_top_down ? tile.row + y : rows - 1 - (tile.row + y);
    for (CORBA::ULong x = 0; x < tile.width; ++x) {
      const std::uint8_t grey = map.pixels[std::size_t{row} * columns + tile.column + x];
      tile.cells[y * tile.width + x] = is_percent ? in_percent(grey) : grey;
    }
  }
}

}  // namespace

MapSource::Map MapSource::fresh() {
  const MapSettings wanted = settings();
  auto requester = shm::Requester::open(static_cast<std::uint32_t>(wanted.server_id));
  auto made = requester ? shm::world_map(*requester, wanted.options, map_timeout) : base::Result<shm::WorldMap>(requester.error());
  if (!made) {
    say_(made.error().message);
    return nullptr;
  }
  auto map = std::make_shared<const shm::WorldMap>(std::move(*made));
  *latest_.lock() = map;
  return map;
}

namespace {

// In front of the target: the places of the way to it, which may be passed in any heading.
void append_way(const std::vector<shm::MapPlace>& way, const RTC::Waypoint2D& target, RTC::Waypoint2DList& path) {
  constexpr double near_a_corner = 0.15, any_heading = 4;  // [m], [rad]
  for (std::size_t i = 0; i < way.size(); ++i) {
    RTC::Waypoint2D point = target;
    if (i + 1 < way.size()) {
      point.target = {{way[i][0], way[i][1]}, std::atan2(way[i + 1][1] - way[i][1], way[i + 1][0] - way[i][0])};
      point.distanceTolerance = near_a_corner;
      point.headingTolerance = any_heading;
    }
    const CORBA::ULong at = path.length();
    path.length(at + 1);
    path[at] = point;
  }
}

}  // namespace

base::Result<RTC::Path2D> MapSource::plan(const RTC::Waypoint2DList& task) const {
  constexpr CORBA::ULong most = 1000;
  constexpr double farthest = 1e5;  // [m]
  if (task.length() < 2 || task.length() > most)
    return base::Error{"planner: expected 2 to 1000 way points, got " + std::to_string(task.length())};
  MapSettings wanted = settings();
  wanted.options.max_cells = 2000;
  wanted.options.may_coarsen = true;
  for (CORBA::ULong i = 0; i < task.length(); ++i) {
    const auto& [position, heading] = task[i].target;
    if (!(std::abs(position.x) <= farthest && std::abs(position.y) <= farthest && std::isfinite(heading)))
      return base::Error{"planner: way point " + std::to_string(i) + " is no pose within 1e5 m"};
    wanted.options.places.push_back({position.x, position.y});
  }
  auto requester = shm::Requester::open(static_cast<std::uint32_t>(wanted.server_id));
  if (!requester) return requester.error();
  const auto reply = shm::ask_for(*requester, shm::ExportRequest{true}, map_timeout);
  if (!reply) return reply.error();
  const auto map = shm::make_map(reply->text, wanted.options);
  if (!map) return map.error();
  RTC::Path2D path;
  path.tm = iface::to_time(reply->sim_time_ns);
  for (CORBA::ULong i = 1; i < task.length(); ++i) {
    const auto way = shm::plan_path(*map, wanted.options.places[i - 1], wanted.options.places[i], wanted.radius);
    if (!way) return base::Error{"planner: " + way.error().message};
    append_way(*way, task[i], path.waypoints);
  }
  return path;
}

void PathPlannerService::SetTask(const RTC::Waypoint2DList& task) {
  auto path = source_.plan(task);
  if (path) {
    *path_.lock() = std::move(*path);
    return;
  }
  say_(path.error().message);
  throw CORBA::BAD_PARAM();
}

MapSource::Map MapSource::latest() {
  if (Map known = *latest_.lock()) return known;
  return fresh();
}

RTC::OGMapConfig OGMapService::GetConfig() {
  const MapSource::Map map = source_.fresh();
  if (!map) throw CORBA::TRANSIENT();  // the operation has no other way to say no
  return config_of(map->area);
}

RTC::OGMapTile* OGMapService::GetTile(const RTC::OGMapTile& tile) {
  const MapSource::Map map = source_.latest();
  if (!map) throw CORBA::TRANSIENT();
  RTC::OGMapTile_var filled = new RTC::OGMapTile(tile);
  const MapSettings settings = source_.settings();
  fill_tile(*map, settings.is_top_down, settings.is_percent, filled.inout());
  return filled._retn();
}

MobileRobot::RETURN_VALUE OGMapServerService::requestCurrentBuiltMap(MobileRobot::OGMap_out map) {
  MobileRobot::OGMap_var out = new MobileRobot::OGMap();
  out->tm = {0, 0};
  const MapSource::Map made = source_.fresh();
  if (made) {
    out->config = config_of(made->area);
    out->map.column = out->map.row = 0;
    out->map.width = out->config.width;
    out->map.height = out->config.height;
    fill_tile(*made, true, false, out->map);
  }
  map = out._retn();
  return made ? MobileRobot::RETVAL_OK : MobileRobot::RETVAL_EMPTY_MAP;
}

RTCMap::RTCMap(RTC::Manager* manager)
    : RTC::DataFlowComponentBase(manager),
      source_([this](const std::string& line) { RTC_ERROR(("%s", line.c_str())); }),
      map_(source_),
      server_(source_),
      planner_(source_, [this](const std::string& line) { RTC_WARN(("%s", line.c_str())); }),
      path_out_("path", path_),
      service_port_("map") {}

RTC::ReturnCode_t RTCMap::onInitialize() {
  service_port_.registerProvider("map", "RTC::OGMap", map_);
  service_port_.registerProvider("server", "RTC::OGMapServer", server_);
  service_port_.registerProvider("planner", "RTC::PathPlanner2D", planner_);
  addOutPort("path", path_out_);
  addPort(service_port_);
  bindParameter("server_id", settings_.server_id, std::to_string(iface::default_server()).c_str());
  bindParameter("resolution", settings_.options.resolution, specification.value_of("resolution"));
  bindParameter("lowest", lowest_, specification.value_of("lowest"));
  bindParameter("highest", highest_, specification.value_of("highest"));
  bindParameter("area", area_, specification.value_of("area"));
  bindParameter("movable", movable_, specification.value_of("movable"));
  bindParameter("radius", settings_.radius, specification.value_of("radius"));
  bindParameter("row_order", row_order_, specification.value_of("row_order"));
  bindParameter("values", values_, specification.value_of("values"));
  follow_configuration();
  return RTC::RTC_OK;
}

void RTCMap::follow_configuration() {
  settings_.options.heights = {lowest_, highest_};
  settings_.options.area = area_of(area_).value_or(std::vector<double>());
  settings_.options.with_movable = movable_ != 0;
  settings_.is_top_down = row_order_ == "top_down";
  settings_.is_percent = values_ == "percent";
  source_.set(settings_);
}

RTC::ReturnCode_t RTCMap::onActivated(RTC::UniqueId) {
  follow_configuration();
  if (!area_of(area_)) {
    return reject("area must be four numbers, xmin,ymin,xmax,ymax [m], got " + base::in_quotes(area_));
  }
  if (highest_ > lowest_) return RTC::RTC_OK;
  return reject("highest must be above lowest (" + base::format_number(lowest_) + " m), got " + base::format_number(highest_));
}

RTC::ReturnCode_t RTCMap::reject(const std::string& why) {
  if (const auto line = limit_.next(why)) RTC_ERROR(("%s", line->c_str()));
  return RTC::RTC_ERROR;
}

RTC::ReturnCode_t RTCMap::onExecute(RTC::UniqueId) {
  follow_configuration();
  if (auto path = planner_.take()) {
    path_ = std::move(*path);
    path_out_.write();
  }
  return RTC::RTC_OK;
}

extern "C" {
void RTCMapInit(RTC::Manager* manager) { iface::register_type<RTCMap>(manager, specification); }
}
