// Requests and commands: step, pose, velocity, spawn, screenshot, contacts.
#include <poll.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>

#include "base/name_list.h"
#include "base/plain_file.h"
#include "base/suggestion.h"
#include "base/text.h"
#include "base/whole_file.h"
#include "shm/control.h"
#include "simctl/simctl.h"

namespace simctl {

using Json = nlohmann::ordered_json;

namespace {

volatile std::sig_atomic_t interrupted = 0;

}  // namespace

bool is_interrupted() { return interrupted != 0; }
void catch_interrupts() {
  const auto handler = [](int) { interrupted = 1; };
  std::signal(SIGINT, handler);
  std::signal(SIGTERM, handler);
}

void Control::fail(const std::string& message) {
  std::cout.flush();
  std::fprintf(stderr, "simctl: %s\n", message.c_str());
  failed_ = true;
}

void Control::reject(const std::string& message) {
  fail(message);
  is_rejected_ = true;
}

void Control::print(const Json& value) const { std::cout << value.dump(2, ' ', false, Json::error_handler_t::replace) << '\n'; }

std::optional<shm::Reply> Control::ask(const shm::Request& request, std::chrono::seconds limit, const std::string& command) {
  auto requester = shm::Requester::open(server_id_);
  if (!requester) return fail(requester.error().message), std::nullopt;
  auto reply = shm::ask_for(*requester, request, limit);
  if (reply) return std::move(*reply);
  const std::string& message = reply.error().message;
  const std::string own = std::string(shm::request_name(request)) + ": ";
  fail(command.empty() || !message.starts_with(own) ? message : command + ": " + message.substr(own.size()));
  return std::nullopt;
}

std::optional<shm::Iface> Control::open(shm::IfaceType type, const std::string& name) {
  auto iface = shm::Iface::open(server_id_, type, name);
  if (!iface) return fail(iface.error().message), std::nullopt;
  return std::move(*iface);
}

std::optional<shm::Iface> Control::open(const std::string& text, std::optional<shm::IfaceType> preferred) {
  // TYPE:NAME has one colon; names of models inside models have two in a row.
  const auto colon = text.find(':');
  if (colon != std::string::npos && text.compare(colon, 2, "::") != 0) {
    if (const auto type = shm::parse_type(text.substr(0, colon))) return open(*type, text.substr(colon + 1));
  }
  std::vector<shm::Found> matches;
  std::vector<std::string> names, known;
  for (const auto& found : shm::find_segments(server_id_)) {
    if (found.name.iface == text) matches.push_back(found);
    names.push_back(std::string(shm::to_text(found.name.type)) + ":" + found.name.iface);
    known.push_back(found.name.iface);
  }
  if (matches.size() == 1) return open(matches.front().name.type, text);
  for (const auto& match : matches) {
    if (match.name.type == preferred) return open(match.name.type, text);
  }
  if (matches.size() > 1) {
    std::vector<std::string> choices;
    for (const auto& match : matches) choices.push_back(std::string(shm::to_text(match.name.type)) + ":" + match.name.iface);
    return fail("iface " + base::in_quotes(text) + ": several types have this name, name one: " + base::join(choices, ", ")), std::nullopt;
  }
  const auto meant = base::suggestion(text, known);
  constexpr std::size_t most = 12;
  if (names.size() > most) {
    names.resize(most);
    names.emplace_back("...");
  }
  fail("server " + std::to_string(server_id_) + ": " +
       (names.empty() ? "is not there" : "has no iface " + base::in_quotes(text) + "; there are " + base::join(names, ", ") + meant));
  return std::nullopt;
}

void step(Control& control, std::int64_t steps, bool is_paced) {
  // Steps take as long as the world needs; a dead server is noticed anyway.
  const auto reply = control.ask(shm::StepRequest{steps, is_paced}, std::chrono::hours(24));
  if (reply && control.json()) control.print({{"sim_time", static_cast<double>(reply->sim_time_ns) / 1e9}, {"steps", reply->steps}});
}

void pose(Control& control, const std::string& model, const std::vector<double>& values) {
  if (!values.empty()) {
    const auto request = shm::set_pose_request(model, values);
    if (!request) return control.reject(request.error().message);
    control.ask(*request);
    return;
  }
  const auto reply = control.ask(shm::GetPoseRequest{model});
  if (!reply) return;
  const auto& v = reply->values;
  const shm::Pose p{v[0], v[1], v[2], v[3], v[4], v[5], v[6]};
  if (control.json())
    return control.print(
        {{"model", model}, {"position", {p.x, p.y, p.z}}, {"orientation", {p.qw, p.qx, p.qy, p.qz}}, {"yaw", shm::yaw_of(p)}});
  std::printf("%.6f %.6f %.6f  yaw %.6f\n", p.x, p.y, p.z, shm::yaw_of(p));
}

namespace {

// Until the command is over; without a duration, until an interrupt. The simulator counts from the step that first sees the command: the
// one after the time on the clock, or the one after that. Without a duration no step is waited for: the simulator would have to wake each
// such client at each of them.
void await_end(Control& control, const shm::Iface& iface, shm::Iface& simulation, std::chrono::nanoseconds duration) {
  const auto stamp = [&] { return simulation.read() ? simulation.sample<shm::SimulationSample>().stamp : shm::Stamp{}; };
  const auto begin = stamp();
  const auto end = begin.sim_time_ns + duration.count() + simulation.info<shm::SimulationInfo>().step_ns;
  while (!is_interrupted()) {
    const auto now = stamp();
    if (duration.count() > 0 && now.sim_time_ns >= end) return;
    if (now.resets != begin.resets) return control.fail("iface " + iface.name() + ": the world was reset, which ends the command");
    if (!iface.is_commanding()) return control.fail("iface " + iface.name() + ": another client commands it now");
    constexpr std::chrono::milliseconds pause(100);
    if (duration.count() > 0) {
      simulation.wait(now.sequence, pause);
    } else {
      ::poll(nullptr, 0, pause.count());  // ends early at an interrupt
    }
    if (simulation.status() != shm::Status::live) return control.fail("the simulator has exited");
    if (iface.status() != shm::Status::live)
      return control.fail("iface " + iface.name() + ": its model was deleted, which ends the command");
  }
}

}  // namespace

void velocity(Control& control, const std::string& name, const std::vector<double>& values, double seconds) {
  auto iface = control.open(name);
  if (!iface) return;
  std::vector<double> command = values;
  if (iface->type() == shm::IfaceType::position3d) {
    // vx vy vz and the yaw rate, as people fly.
    if (values.size() != 4 && values.size() != 6) return control.reject("velocity of a position3d: expected VX VY VZ YAWRATE, or all six");
    if (values.size() == 4) command = {values[0], values[1], values[2], 0, 0, values[3]};
  } else if (iface->type() != shm::IfaceType::position2d) {
    return control.fail("iface " + name + ": is a " + std::string(shm::to_text(iface->type())) + ", which takes no velocity");
  } else if (values.size() != 3) {
    return control.reject("velocity of a position2d: expected VX VY VA, got " + std::to_string(values.size()) + " numbers");
  }
  auto simulation = control.open(shm::IfaceType::simulation, "world");
  if (!simulation) return;
  catch_interrupts();
  const std::chrono::nanoseconds duration(std::llround(seconds * 1e9));
  if (const auto done = iface->command(shm::CommandKind::velocity, command, duration); !done) return control.fail(done.error().message);
  await_end(control, *iface, *simulation, duration);
}

namespace {

// Number `number` in a square grid whose first is at `first`.
shm::Pose in_grid(shm::Pose first, std::size_t number, std::size_t count, double spacing) {
  const auto columns = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(count))));
  first.x += spacing * static_cast<double>(number % columns);
  first.y += spacing * static_cast<double>(number / columns);
  return first;
}

std::optional<std::string> spawn_one(Control& control, const shm::Iface& simulation, const SpawnOptions& options,
                                     const std::optional<shm::Pose>& pose) {
  auto request = shm::spawn_request(options.file, simulation.segment().is_shared());
  if (!request) return control.reject(request.error().message), std::nullopt;
  request->name = options.name;
  request->has_pose = pose.has_value();
  if (pose) request->pose = *pose;
  if (!options.gains.empty()) {
    constexpr std::uintmax_t largest = std::uintmax_t{1} << 20U;
    auto text = base::read_plain_file(options.gains, largest);
    if (!text) return control.reject("gains " + base::in_quotes(options.gains) + ": " + text.error().message), std::nullopt;
    request->gains = std::move(*text);
  }
  request->joints = base::join(options.joints, "\n");
  const auto reply = control.ask(*request);
  return reply ? std::optional(reply->message) : std::nullopt;
}

}  // namespace

void spawn(Control& control, const SpawnOptions& options) {
  const auto simulation = control.open(shm::IfaceType::simulation, "world");
  if (!simulation) return;
  std::optional<shm::Pose> pose;
  if (!options.pose.empty()) {
    const auto given = shm::pose_of(options.pose);
    if (!given) return control.reject(given.error().message);
    pose = *given;
  }
  if (options.list.empty()) {
    const auto name = spawn_one(control, *simulation, options, pose);
    if (name && control.json()) return control.print({{"name", *name}});
    if (name) std::cout << *name << '\n';
    return;
  }
  const auto list = base::NameList::parse(options.list);
  if (!list) return control.reject(list.error().message);
  Json names = Json::array();
  for (std::size_t i = 0; i < list->values.size() && !is_interrupted(); ++i) {
    SpawnOptions one = options;
    one.file = list->filled(options.file, i);
    one.name = options.name.empty() ? list->values[i] : list->filled(options.name, i);
    const auto name =
        spawn_one(control, *simulation, one, in_grid(pose.value_or(shm::identity_pose), i, list->values.size(), options.spacing));
    if (!name) return;  // the others would fail as well
    names.push_back(*name);
    if (!control.json()) std::cout << *name << '\n';
  }
  if (control.json()) control.print({{"names", names}});
}

void attach(Control& control, const std::string& name, bool is_on) {
  constexpr std::chrono::seconds limit(10);
  if (!name.empty()) return static_cast<void>(control.ask(shm::SetMotorsRequest{name, is_on}, limit, is_on ? "attach" : "detach"));
  const auto reply = control.ask(shm::ListRequest{});
  if (!reply) return;
  const auto json = Json::parse(reply->text, nullptr, false);
  const auto all = json.is_object() ? json.value("attachments", Json::array()) : Json::array();
  if (control.json()) return control.print(all);
  if (all.empty()) return static_cast<void>(std::printf("no grippers or detachable joints\n"));
  std::printf("%-40s %-4s %s\n", "NAME", "ON", "HOLDS");
  for (const auto& one : all)
    std::printf("%-40s %-4s %s\n", one.value("name", "?").c_str(), one.value("on", false) ? "on" : "off", one.value("holds", "").c_str());
}

std::optional<std::pair<std::uint32_t, std::uint32_t>> parse_size(const std::string& text) {
  const auto x = text.find('x');
  const auto width = base::parse_integer(text.substr(0, x));
  const auto height = x == std::string::npos ? std::nullopt : base::parse_integer(text.substr(x + 1));
  if (!width || !height || *width < 1 || *height < 1 || *width > 8192 || *height > 8192) return std::nullopt;
  return std::pair(static_cast<std::uint32_t>(*width), static_cast<std::uint32_t>(*height));
}

void screenshot(Control& control, const ScreenshotOptions& options) {
  shm::ScreenshotRequest request;
  const auto size = parse_size(options.size);
  if (!size) return control.fail("size " + base::in_quotes(options.size) + ": expected WIDTHxHEIGHT, each from 1 to 8192");
  request.width = size->first;
  request.height = size->second;
  request.with_scans = options.with_scans;
  request.with_collisions = options.with_collisions;
  request.span = options.span;
  using View = shm::ScreenshotRequest::View;
  if (!options.camera.empty()) {
    request.view = View::camera;
    request.follow = options.camera;
  } else if (!options.follow.empty()) {
    request.view = View::follow;
    request.follow = options.follow;
  } else if (options.from_top) {
    request.view = View::top;
    if (options.at.size() == 2) request.pose = shm::planar_pose(options.at[0], options.at[1], 0, 0);
  } else if (!options.from.empty()) {
    request.view = View::from;
    const auto pose = shm::pose_of(options.from);
    if (!pose) return control.fail(pose.error().message);
    request.pose = *pose;
  }
  auto requester = shm::Requester::open(control.server_id());
  if (!requester) return control.fail(requester.error().message);
  if (const auto written = shm::write_screenshot(*requester, request, options.file); !written) control.fail(written.error().message);
}

void export_world(Control& control, const std::string& file, bool with_collisions) {
  const auto reply = control.ask(shm::ExportRequest{with_collisions}, std::chrono::minutes(10));
  if (!reply) return;
  if (const auto written = base::write_whole_file(file, reply->text); !written) control.fail(written.error().message);
}

void contacts(Control& control, const std::string& model) {
  const auto reply = control.ask(shm::ContactsRequest{model});
  if (!reply) return;
  const auto json = Json::parse(reply->text, nullptr, false);
  if (control.json()) return control.print(json);
  std::cout << reply->count << " contacts since the last time\n";
  if (!json.is_object()) return;
  for (const auto& contact : json.value("contacts", Json::array()))
    std::cout << contact.value("link", "?") << " touches " << contact.value("other", "?") << '\n';
}

}  // namespace simctl
