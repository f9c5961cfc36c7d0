// Looks inside: list, info, echo, stats, participants, tree, dump, clean.
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <iostream>
#include <nlohmann/json.hpp>

#include "base/text.h"
#include "shm/lockstep.h"
#include "simctl.h"

namespace simctl {

using Json = nlohmann::ordered_json;

namespace {

Json to_json(const shm::Pose& p) { return Json{{"position", {p.x, p.y, p.z}}, {"orientation", {p.qw, p.qx, p.qy, p.qz}}}; }
template <std::size_t n>
Json to_json(const double (&values)[n]) {
  Json array = Json::array();
  for (const double value : values) array.push_back(value);
  return array;
}
// The shortest decimal that is this float, not the double next to it: 1.56 instead of 1.5600000619888306.
double shortest(float value) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value);
  double result = value;
  std::from_chars(text, end.ptr, result);
  return result;
}
// JSON has no infinity: null stands for "nothing hit", -1 for "too near".
Json to_json(std::span<const float> ranges) {
  Json array = Json::array();
  for (const float range : ranges) array.push_back(std::isfinite(range) ? Json(shortest(range)) : range < 0 ? Json(-1) : Json());
  return array;
}
std::string text_of(const char* text, std::size_t size) { return {text, strnlen(text, size)}; }

Json stamp_json(const shm::Stamp& stamp) {
  return {{"sequence", stamp.sequence},
          {"sim_time", static_cast<double>(stamp.sim_time_ns) / 1e9},
          {"wall_time", static_cast<double>(stamp.wall_time_ns) / 1e9},
          {"valid", stamp.valid != 0}};
}

Json info_json(const shm::Iface& iface) {
  using shm::IfaceType;
  switch (iface.type()) {
    case IfaceType::simulation: {
      const auto& i = iface.info<shm::SimulationInfo>();
      return {{"world", text_of(i.world, sizeof i.world)},
              {"file", text_of(i.file, sizeof i.file)},
              {"step", static_cast<double>(i.step_ns) / 1e9},
              {"seed", i.seed},
              {"lockstep", i.lockstep != 0},
              {"version", text_of(i.version, sizeof i.version)}};
    }
    case IfaceType::laser: {
      const auto& i = iface.info<shm::LaserInfo>();
      return {{"model", i.model},
              {"beams", i.beams},
              {"layers", i.layers},
              {"min_angle", i.min_angle},
              {"max_angle", i.max_angle},
              {"angle_step", i.angle_step},
              {"min_vertical", i.min_vertical},
              {"max_vertical", i.max_vertical},
              {"min_range", i.min_range},
              {"max_range", i.max_range},
              {"resolution", i.range_step},
              {"rate", i.rate},
              {"noise", i.noise},
              {"pose", to_json(i.pose)}};
    }
    case IfaceType::sonar: {
      const auto& i = iface.info<shm::SonarInfo>();
      Json poses = Json::array();
      for (const auto& pose : iface.sonar_poses()) poses.push_back(to_json(pose));
      return {{"model", i.model}, {"count", i.count}, {"min_range", i.min_range}, {"max_range", i.max_range},
              {"cone", i.cone},   {"rate", i.rate},   {"noise", i.noise},         {"poses", poses}};
    }
    case IfaceType::position2d: {
      const auto& i = iface.info<shm::Position2dInfo>();
      return {{"model", i.model},
              {"drive", i.drive},
              {"size", to_json(i.size)},
              {"max_speed", i.max_speed},
              {"max_yaw_rate", i.max_yaw_rate},
              {"max_acceleration", i.max_acceleration},
              {"max_yaw_acceleration", i.max_yaw_acceleration},
              {"wheel_separation", i.wheel_separation},
              {"wheel_radius", i.wheel_radius},
              {"rate", i.rate},
              {"pose", to_json(i.pose)}};
    }
    case IfaceType::position3d: {
      const auto& i = iface.info<shm::Position3dInfo>();
      return {{"model", i.model},
              {"drive", i.drive},
              {"size", to_json(i.size)},
              {"max_speed", i.max_speed},
              {"max_yaw_rate", i.max_yaw_rate},
              {"rate", i.rate},
              {"pose", to_json(i.pose)}};
    }
    case IfaceType::camera:
    case IfaceType::depth:
    case IfaceType::points: {
      const auto& i = iface.info<shm::CameraInfo>();
      return {{"model", i.model},
              {"width", i.width},
              {"height", i.height},
              {"format", i.format},
              {"stride", i.stride},
              {"hfov", i.hfov},
              {"near", i.near_clip},
              {"far", i.far_clip},
              {"fx", i.fx},
              {"fy", i.fy},
              {"cx", i.cx},
              {"cy", i.cy},
              {"distortion", to_json(i.distortion)},
              {"rate", i.rate},
              {"noise", i.noise},
              {"pose", to_json(i.pose)}};
    }
    case IfaceType::imu: {
      const auto& i = iface.info<shm::ImuInfo>();
      return {{"model", i.model},
              {"rate", i.rate},
              {"angular_velocity_noise", i.angular_velocity_noise},
              {"acceleration_noise", i.acceleration_noise},
              {"pose", to_json(i.pose)}};
    }
    case IfaceType::gps: {
      const auto& i = iface.info<shm::GpsInfo>();
      return {{"model", i.model},
              {"rate", i.rate},
              {"latitude", i.latitude},
              {"longitude", i.longitude},
              {"altitude", i.altitude},
              {"heading", i.heading},
              {"position_noise", i.position_noise},
              {"altitude_noise", i.altitude_noise},
              {"pose", to_json(i.pose)}};
    }
    case IfaceType::bumper: {
      const auto& i = iface.info<shm::BumperInfo>();
      return {{"model", i.model}, {"rate", i.rate}, {"capacity", i.capacity}, {"pose", to_json(i.pose)}};
    }
    case IfaceType::force_torque:
    case IfaceType::altimeter:
    case IfaceType::magnetometer:
    case IfaceType::air_pressure: {
      const auto& i = iface.info<shm::MeterInfo>();
      Json json{{"model", i.model}, {"rate", i.rate}, {"noise", to_json(i.noise)}, {"reference", i.reference}, {"pose", to_json(i.pose)}};
      if (iface.type() == IfaceType::force_torque) json["joint"] = text_of(i.joint, sizeof i.joint);
      return json;
    }
    case IfaceType::truth:
      return {{"model", iface.info<shm::TruthInfo>().model}};
  }
  return {};
}

// Only after the iface has been read.
Json sample_json(const shm::Iface& iface) {
  using shm::IfaceType;
  switch (iface.type()) {
    case IfaceType::simulation: {
      const auto& s = iface.sample<shm::SimulationSample>();
      return {{"stamp", stamp_json(s.stamp)}, {"steps", s.steps}, {"paused", s.paused != 0}, {"waiting_for", s.waiting_for},
              {"rtf", s.rtf_reached},         {"load", s.load},   {"contacts", s.contacts},  {"participants", s.participants}};
    }
    case IfaceType::laser: {
      const auto scan = iface.laser_scan();
      return {{"stamp", stamp_json(scan.sample->stamp)},
              {"ranges", to_json(scan.ranges)},
              {"intensities", to_json(scan.intensities)},
              {"pose", to_json(scan.sample->pose)}};
    }
    case IfaceType::sonar: {
      const auto scan = iface.sonar_scan();
      return {{"stamp", stamp_json(scan.sample->stamp)}, {"ranges", to_json(scan.ranges)}};
    }
    case IfaceType::position2d: {
      const auto& s = iface.sample<shm::Position2dSample>();
      return {{"stamp", stamp_json(s.stamp)},      {"odometry", to_json(s.odometry)},           {"velocity", to_json(s.velocity)},
              {"true_pose", to_json(s.true_pose)}, {"true_velocity", to_json(s.true_velocity)}, {"command", to_json(s.command)},
              {"stalled", s.stalled != 0},         {"motors_enabled", s.motors_enabled != 0},   {"commanded", s.commanded != 0}};
    }
    case IfaceType::position3d: {
      const auto& s = iface.sample<shm::Position3dSample>();
      return {{"stamp", stamp_json(s.stamp)},      {"odometry", to_json(s.odometry)}, {"velocity", to_json(s.velocity)},
              {"true_pose", to_json(s.true_pose)}, {"command", to_json(s.command)},   {"commanded", s.commanded != 0}};
    }
    case IfaceType::imu: {
      const auto& s = iface.sample<shm::ImuSample>();
      return {{"stamp", stamp_json(s.stamp)},
              {"orientation", to_json(s.orientation)},
              {"angular_velocity", to_json(s.angular_velocity)},
              {"acceleration", to_json(s.acceleration)}};
    }
    case IfaceType::gps: {
      const auto& s = iface.sample<shm::GpsSample>();
      return {{"stamp", stamp_json(s.stamp)},
              {"latitude", s.latitude},
              {"longitude", s.longitude},
              {"altitude", s.altitude},
              {"velocity", to_json(s.velocity)}};
    }
    case IfaceType::bumper: {
      const auto view = iface.bumper();
      Json contacts = Json::array();
      for (const auto& c : view.contacts)
        contacts.push_back({{"other", text_of(c.other, sizeof c.other)},
                            {"position", to_json(c.position)},
                            {"normal", to_json(c.normal)},
                            {"force", to_json(c.force)},
                            {"depth", c.depth}});
      return {{"stamp", stamp_json(view.sample->stamp)}, {"total", view.sample->total}, {"contacts", contacts}};
    }
    case IfaceType::force_torque: {
      const auto& s = iface.sample<shm::ForceTorqueSample>();
      return {{"stamp", stamp_json(s.stamp)}, {"force", to_json(s.force)}, {"torque", to_json(s.torque)}};
    }
    case IfaceType::altimeter: {
      const auto& s = iface.sample<shm::AltimeterSample>();
      return {{"stamp", stamp_json(s.stamp)}, {"height", s.height}, {"climb", s.climb}};
    }
    case IfaceType::magnetometer: {
      const auto& s = iface.sample<shm::MagnetometerSample>();
      return {{"stamp", stamp_json(s.stamp)}, {"field", to_json(s.field)}};
    }
    case IfaceType::air_pressure: {
      const auto& s = iface.sample<shm::AirPressureSample>();
      return {{"stamp", stamp_json(s.stamp)}, {"pressure", s.pressure}};
    }
    case IfaceType::truth: {
      const auto& s = iface.sample<shm::TruthSample>();
      return {{"stamp", stamp_json(s.stamp)}, {"pose", to_json(s.pose)}, {"velocity", to_json(s.velocity)}};
    }
    default:
      return {};
  }
}

Json frame_json(const shm::HeldFrame& frame) {
  const auto& h = frame.head();
  return {{"stamp", stamp_json(h.stamp)}, {"width", h.width}, {"height", h.height},
          {"format", h.format},           {"size", h.size},   {"pose", to_json(h.pose)}};
}

void print_scan(const shm::Iface& iface, const Json& sample) {
  if (iface.type() != shm::IfaceType::laser || !isatty(1)) {
    std::cout << sample.dump() << std::endl;
    return;
  }
  winsize window{};
  const bool known = ioctl(1, TIOCGWINSZ, &window) == 0 && window.ws_col > 20 && window.ws_row > 10;
  std::cout << polar_plot(iface.info<shm::LaserInfo>(), iface.laser_scan().ranges, known ? window.ws_col - 1 : 79,
                          known ? window.ws_row - 3 : 30)
            << "t = " << sample["stamp"]["sim_time"] << " s" << std::endl;
}

}  // namespace

std::string polar_plot(const shm::LaserInfo& info, std::span<const float> ranges, int columns, int rows) {
  std::vector<std::string> picture(static_cast<std::size_t>(rows), std::string(static_cast<std::size_t>(columns), ' '));
  double farthest = 0.1;
  for (const float range : ranges) {
    if (std::isfinite(range)) farthest = std::max(farthest, static_cast<double>(range));
  }
  // A character is about twice as high as it is wide.
  const double scale = std::min((rows - 1) / 1.5 / farthest, columns / 4.0 / farthest);
  const int middle = columns / 2;
  const int origin = static_cast<int>(std::lround(farthest * scale));
  const auto mark = [&](double forward, double left, char c) {
    const auto row = origin - static_cast<int>(std::lround(forward * scale));
    const auto column = middle - static_cast<int>(std::lround(left * scale * 2));
    if (row >= 0 && row < rows && column >= 0 && column < columns)
      picture[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)] = c;
  };
  for (std::size_t i = 0; i < ranges.size() && i < info.beams; ++i) {
    const double angle = info.min_angle + static_cast<double>(i) * info.angle_step;
    if (std::isfinite(ranges[i])) mark(ranges[i] * std::cos(angle), ranges[i] * std::sin(angle), '#');
  }
  mark(0, 0, '^');
  std::string text;
  for (const auto& line : picture) text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
  return text;
}

void list(Control& control, bool all_servers) {
  Json json = Json::array();
  bool any = false;
  for (const auto& found : shm::find_segments()) {
    if (!all_servers && found.name.server_id != control.server_id()) continue;
    any = true;
    const std::string state = !found.is_readable ? "unreadable" : found.is_alive ? "alive" : "dead";
    json.push_back({{"server", found.name.server_id},
                    {"type", std::string(shm::to_text(found.name.type))},
                    {"name", found.name.iface},
                    {"state", state},
                    {"pid", found.server.pid},
                    {"subscribers", found.subscribers},
                    {"sequence", found.sequence},
                    {"size", found.size}});
    if (control.json()) continue;
    if (all_servers) std::printf("%-6u ", found.name.server_id);
    std::printf("%-12s %-40s %s, %u subscribers%s\n", std::string(shm::to_text(found.name.type)).c_str(), found.name.iface.c_str(),
                state.c_str(), found.subscribers, found.problem.empty() ? "" : (", " + found.problem).c_str());
  }
  if (control.json()) control.print(json);
  if (!any && !all_servers)
    control.fail("server " + std::to_string(control.server_id()) +
                 ": is not there; simctl list --all shows others, start one with: sim-server -s " + std::to_string(control.server_id()) +
                 " WORLD");
}

void info(Control& control, const std::string& name) {
  const auto iface = control.open(name);
  if (!iface) return;
  Json json{{"type", std::string(shm::to_text(iface->type()))}, {"name", iface->name()}, {"server", iface->server_id()}};
  const auto details = info_json(*iface);
  for (const auto& [key, value] : details.items()) json[key] = value;
  if (control.json()) return control.print(json);
  for (const auto& [key, value] : json.items())
    std::cout << key << "  " << (value.is_string() ? value.get<std::string>() : value.dump()) << '\n';
}

bool is_paused(std::uint32_t server_id) {
  auto clock = shm::Iface::open(server_id, shm::IfaceType::simulation, "world");
  return clock && clock->read() &&
         (clock->sample<shm::SimulationSample>().paused != 0 || clock->sample<shm::SimulationSample>().waiting_for != 0);
}

void echo(Control& control, const std::string& name, int count) {
  auto iface = control.open(name);
  if (!iface) return;
  // What stands there may be old; a sensor that was off makes a sample when it is switched on, even while time stands still.
  std::uint64_t last = iface->sequence();
  if (const auto done = iface->subscribe(); !done) return control.fail(done.error().message);
  catch_interrupts();
  for (int printed = 0; (count <= 0 || printed < count) && !is_interrupted();) {
    const auto what = iface->wait(last, std::chrono::milliseconds(200));
    if (what == shm::Wait::closed) return control.fail("iface " + name + ": the simulator is gone");
    if (what == shm::Wait::timed_out) {
      // Time stands still and somebody else listens already: what he has got is the present.
      if (printed == 0 && is_paused(control.server_id())) last = 0;
      continue;
    }
    Json sample;
    if (shm::has_frames(iface->type())) {
      const auto frame = iface->hold();
      if (!frame) continue;
      last = frame->sequence();
      sample = frame_json(*frame);
    } else {
      last = iface->sample<shm::Stamp>().sequence;
      sample = sample_json(*iface);
    }
    if (control.json()) {
      std::cout << sample.dump() << std::endl;
    } else {
      print_scan(*iface, sample);
    }
    ++printed;
  }
}

static std::string state_text(const Json& stats) {
  const auto missing = stats.value("waiting_for", 0U);
  if (missing > 0) return "waiting for " + std::to_string(missing) + (missing == 1 ? " participant" : " participants");
  return stats.value("paused", false) ? "paused" : "running";
}

void stats(Control& control) {
  const auto reply = control.ask(shm::StatsRequest{});
  if (!reply) return;
  const auto json = Json::parse(reply->text, nullptr, false);
  if (control.json() || !json.is_object()) return control.print(json);
  std::printf("world %s  %.3f s  %llu steps of %g s  %s\n", json.value("world", "?").c_str(), json.value("sim_time", 0.0),
              static_cast<unsigned long long>(json.value("steps", 0ULL)), json.value("step", 0.0), state_text(json).c_str());
  std::printf("real-time factor %.2f (wanted %g)  load %.0f %%  state hash %s\n", json.value("rtf", 0.0), json.value("rtf_wanted", 0.0),
              100 * json.value("load", 0.0), json.value("hash", "?").c_str());
  std::printf("%d models, %d bodies (%d awake), %d joints, %d contacts, %d ifaces (%d subscribed), %.0f MiB\n\n", json.value("models", 0),
              json.value("bodies", 0), json.value("awake", 0), json.value("joints", 0), json.value("contacts", 0), json.value("ifaces", 0),
              json.value("subscribed", 0), json.value("memory_mib", 0.0));
  std::printf("%-12s %12s %12s %12s %8s\n", "PART", "CALLS", "MEAN us", "MAX us", "SHARE");
  for (const auto& part : json.value("parts", Json::array())) {
    std::printf("%-12s %12llu %12.2f %12.1f %7.1f%%\n", part.value("name", "?").c_str(),
                static_cast<unsigned long long>(part.value("calls", 0ULL)), part.value("mean_us", 0.0), part.value("max_us", 0.0),
                100 * part.value("share", 0.0));
  }
  const auto contacts = json.value("contacts_by_model", Json::object());
  if (!contacts.empty()) std::printf("\n%-30s %10s %14s\n", "MODEL", "CONTACTS", "SINCE START");
  for (const auto& [model, count] : contacts.items())
    std::printf("%-30s %10d %14llu\n", model.c_str(), count.value("now", 0), static_cast<unsigned long long>(count.value("total", 0ULL)));
}

void participants(Control& control) {
  const auto simulation = control.open(shm::IfaceType::simulation, "world");
  if (!simulation) return;
  const auto records = shm::read_participants(*simulation);
  if (!records) return control.fail(records.error().message);
  Json json = Json::array();
  if (!control.json())
    std::printf("%-24s %8s %5s %10s %10s %8s %10s %10s %s\n", "NAME", "PID", "PHASE", "RATE Hz", "TICKS", "MISSED", "MEAN us", "MAX us",
                "");
  for (const auto& p : *records) {
    const double rate = p.period_ns > 0 ? 1e9 / static_cast<double>(p.period_ns) : 0;
    json.push_back({{"name", p.name},
                    {"pid", p.pid},
                    {"phase", p.phase},
                    {"rate", rate},
                    {"ticks", p.ticks},
                    {"missed", p.missed},
                    {"mean_us", static_cast<double>(p.mean_ns) * 1e-3},
                    {"max_us", static_cast<double>(p.max_ns) * 1e-3},
                    {"active", p.is_active},
                    {"late", p.is_late}});
    if (control.json()) continue;
    std::printf("%-24s %8d %5u %10.3f %10llu %8llu %10.1f %10.1f %s\n", p.name.c_str(), p.pid, p.phase, rate,
                static_cast<unsigned long long>(p.ticks), static_cast<unsigned long long>(p.missed), static_cast<double>(p.mean_ns) * 1e-3,
                static_cast<double>(p.max_ns) * 1e-3,
                p.is_late     ? "late"
                : p.is_active ? ""
                              : "joining");
  }
  if (control.json()) control.print(json);
}

void tree(Control& control, const std::string& model) {
  const auto reply = control.ask(shm::TreeRequest{model});
  if (!reply) return;
  const auto json = Json::parse(reply->text, nullptr, false);
  if (control.json() || !json.is_object()) return control.print(json);
  for (const auto& entry : json.value("models", Json::array())) {
    std::cout << entry.value("name", "?") << (entry.value("static", false) ? " (static)" : "") << '\n';
    for (const auto& link : entry.value("links", Json::array())) {
      std::cout << "  link " << link.value("name", "?") << "  " << link.value("mass", 0.0) << " kg\n";
      for (const auto& sensor : link.value("sensors", Json::array()))
        std::cout << "    sensor " << sensor.value("name", "?") << " -> " << sensor.value("iface", "?") << '\n';
    }
    for (const auto& joint : entry.value("joints", Json::array()))
      std::cout << "  joint " << joint.value("name", "?") << " (" << joint.value("type", "?") << ") " << joint.value("parent", "?") << " - "
                << joint.value("child", "?") << '\n';
    for (const auto& plugin : entry.value("plugins", Json::array()))
      std::cout << "  plugin " << plugin.value("name", "?") << " (" << plugin.value("filename", "?") << ")\n";
  }
}

void dump(Control& control, const std::string& name) {
  const auto iface = control.open(name);
  if (!iface) return;
  const auto& facts = iface->segment().facts();
  Json json{{"segment", iface->segment().name().text()},
            {"magic", text_of(facts.magic, sizeof facts.magic)},
            {"layout_version", facts.layout_version},
            {"type", facts.type},
            {"total_size", facts.total_size},
            {"generation", facts.generation},
            {"server_pid", facts.server.pid},
            {"state", iface->segment().header().state},
            {"sequence", iface->sequence()},
            {"areas", Json::array()}};
  static constexpr const char* names[] = {"info", "cells", "frames", "leases", "control", "requests", "participants"};
  for (std::size_t i = 0; i < std::size(names); ++i) {
    const auto& area = facts.areas[i];
    if (area.size > 0)
      json["areas"].push_back(
          {{"name", names[i]}, {"offset", area.offset}, {"size", area.size}, {"stride", area.stride}, {"count", area.count}});
  }
  control.print(json);
}

void clean(Control& control, bool is_of_one_server) {
  const auto removed = is_of_one_server ? shm::remove_stale(control.server_id(), control.server_id()) : shm::remove_stale();
  if (control.json()) return control.print(Json(removed));
  for (const auto& name : removed) std::cout << "removed " << name << '\n';
}

}  // namespace simctl
