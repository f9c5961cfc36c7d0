// Looks inside: list, info, echo, stats, participants, tree, dump, clean.
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <iostream>
#include <nlohmann/json.hpp>
#include <thread>

#include "base/text.h"
#include "shm/iface_json.h"
#include "shm/lockstep.h"
#include "simctl/simctl.h"

namespace simctl {

using Json = nlohmann::ordered_json;

namespace {

void print_scan(const shm::Iface& iface, const Json& sample) {
  if (iface.type() != shm::IfaceType::laser || !isatty(1)) {
    std::cout << sample.dump() << '\n';
    return;
  }
  winsize window{};
  const bool known = ioctl(1, TIOCGWINSZ, &window) == 0 && window.ws_col > 20 && window.ws_row > 10;
  std::cout << polar_plot(iface.info<shm::LaserInfo>(), iface.laser_scan().ranges, known ? window.ws_col - 1 : 79,
                          known ? window.ws_row - 3 : 30)
            << "t = " << sample["stamp"]["sim_time"] << " s\n";
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
  for (const auto& found : all_servers ? shm::find_segments() : shm::find_segments(control.server_id())) {
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
    std::printf("%-14s %-40s %s, %u subscribers%s\n", std::string(shm::to_text(found.name.type)).c_str(), found.name.iface.c_str(),
                state.c_str(), found.subscribers, found.problem.empty() ? "" : (", " + found.problem).c_str());
  }
  if (control.json()) control.print(json);
  if (!any && !all_servers)
    control.fail("server " + std::to_string(control.server_id()) +
                 ": does not exist; simctl list --all shows all simulators; start one with: sim-server -s " +
                 std::to_string(control.server_id()) + " WORLD");
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
  // Ends when the output takes no more; the end of the program says so.
  std::uint64_t missed = 0;
  for (int printed = 0; (count <= 0 || printed < count) && !is_interrupted() && std::cout.good();) {
    const auto what = iface->wait(last, std::chrono::milliseconds(200));
    if (what == shm::Wait::closed) return control.fail("iface " + name + ": the simulator has exited");
    if (what == shm::Wait::timed_out) {
      // Time stands still and somebody else listens already: what he has got is the present.
      if (printed == 0 && is_paused(control.server_id())) last = std::max<std::uint64_t>(iface->sequence(), 1) - 1;
      continue;
    }
    Json sample;
    if (shm::has_frames(iface->type())) {
      const auto frame = iface->hold();
      if (!frame) continue;
      last = frame->sequence();
      sample = frame_json(*frame);
    } else {
      if (!iface->read_after(last)) continue;
      const auto number = iface->sample<shm::Stamp>().sequence;
      if (printed > 0) missed += number - last - 1;
      last = number;
      sample = sample_json(*iface);
    }
    if (control.json()) {
      std::cout << sample.dump() << '\n';
    } else {
      print_scan(*iface, sample);
    }
    ++printed;
    // While samples wait they come first: a call of the system for each would cost the next ones.
    if (iface->sequence() == last) std::cout.flush();
  }
  std::cout.flush();
  if (missed > 0 && std::cout.good())
    std::cerr << "simctl: warning: iface " << name << ": " << missed << " samples were overwritten before they could be printed\n";
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
  std::printf("%d models (%d in the rolling step), %d bodies (%d awake), %d joints, %d contacts, %d ifaces (%d subscribed), %.0f MiB\n\n",
              json.value("models", 0), json.value("rolling", 0), json.value("bodies", 0), json.value("awake", 0), json.value("joints", 0),
              json.value("contacts", 0), json.value("ifaces", 0), json.value("subscribed", 0), json.value("memory_mib", 0.0));
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

void wait(Control& control, const std::vector<std::string>& ifaces, double seconds) {
  catch_interrupts();
  const auto begin = std::chrono::steady_clock::now();
  const auto is_over = [&] { return std::chrono::steady_clock::now() - begin > std::chrono::duration<double>(seconds); };
  for (;;) {
    std::vector<std::string> missing = ifaces;
    bool is_there = false;
    for (const auto& found : shm::find_segments(control.server_id())) {
      if (!found.is_alive) continue;
      is_there |= found.name.type == shm::IfaceType::simulation;
      std::erase_if(missing, [&](const std::string& name) {
        return name == found.name.iface || name == std::string(shm::to_text(found.name.type)) + ":" + found.name.iface;
      });
    }
    if (is_there && missing.empty()) return void(control.ask(shm::StatsRequest{}));
    if (is_interrupted() || is_over()) {
      const std::string server = "server " + std::to_string(control.server_id());
      const std::string end = is_interrupted() ? " before the interrupt" : " after " + base::format_number(seconds) + " s";
      return control.fail(is_there ? server + " has no " + base::join(missing, ", ") + end : server + " is not there" + end);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

void participants(Control& control) {
  const auto simulation = control.open(shm::IfaceType::simulation, "world");
  if (!simulation) return;
  const auto records = shm::read_participants(*simulation);
  if (!records) return control.fail(records.error().message);
  if (control.json()) return control.print(simctl::participants_json(*records));
  std::printf("%-24s %8s %5s %10s %10s %8s %10s %10s %s\n", "NAME", "PID", "PHASE", "RATE Hz", "TICKS", "MISSED", "MEAN us", "MAX us", "");
  for (const auto& p : *records) {
    const double rate = p.period_ns > 0 ? 1e9 / static_cast<double>(p.period_ns) : 0;
    std::printf("%-24s %8d %5u %10.3f %10llu %8llu %10.1f %10.1f %s\n", p.name.c_str(), p.pid, p.phase, rate,
                static_cast<unsigned long long>(p.ticks), static_cast<unsigned long long>(p.missed), static_cast<double>(p.mean_ns) * 1e-3,
                static_cast<double>(p.max_ns) * 1e-3,
                p.is_late     ? "late"
                : p.is_active ? ""
                              : "joining");
  }
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
    for (const auto& gripper : entry.value("grippers", Json::array()))
      std::cout << "  gripper " << gripper.value("name", "?") << ": palm " << gripper.value("palm", "?") << ", fingers "
                << base::join(gripper.value("fingers", std::vector<std::string>()), ", ") << '\n';
    for (const auto& plugin : entry.value("plugins", Json::array()))
      std::cout << "  plugin " << plugin.value("name", "?") << " (" << plugin.value("filename", "?") << ")\n";
  }
}

void models(Control& control) {
  const auto reply = control.ask(shm::ModelsRequest{});
  if (!reply) return;
  const auto json = Json::parse(reply->text, nullptr, false);
  if (control.json() || !json.is_object()) return control.print(json);
  for (const auto& model : json.value("models", Json::array())) std::cout << model.value("name", "?") << '\n';
}

void dump(Control& control, const std::string& name) {
  const auto iface = control.open(name);
  if (!iface) return;
  const auto& facts = iface->segment().facts();
  Json json{{"segment", iface->segment().name().text()},
            {"magic", std::string(facts.magic, strnlen(facts.magic, sizeof facts.magic))},
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
