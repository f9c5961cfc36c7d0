// simctl joints: shows the joints of a model, and commands them.
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "base/text.h"
#include "simctl/simctl.h"

namespace simctl {

using Json = nlohmann::ordered_json;

namespace {

constexpr std::array modes{"none", "position", "velocity", "effort", "free", "brake", "disabled"};
constexpr std::array statuses{"idle", "moving", "braked", "stalled"};

template <std::size_t n>
const char* word_of(const std::array<const char*, n>& words, std::uint32_t number) {
  return number < n ? words[number] : "?";
}

std::span<const shm::Joint> joints_of(const shm::Iface& iface) {
  return {reinterpret_cast<const shm::Joint*>(iface.info_followers(0)), iface.count()};
}
std::span<const shm::JointState> states_of(const shm::Iface& iface) {
  return {reinterpret_cast<const shm::JointState*>(iface.sample_followers(0)), iface.count()};
}
std::string name_of(const shm::Joint& joint) { return {joint.name, strnlen(joint.name, sizeof joint.name)}; }

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json json_of(const shm::Joint& joint, const shm::JointState& state) {
  return {{"name", name_of(joint)},
          {"id", joint.id},
          {"kind", joint.kind == RTMSIM_JOINT_SLIDES ? "slides" : "turns"},
          {"position", state.position},
          {"velocity", state.velocity},
          {"effort", state.effort},
          {"target", state.target},
          {"mode", word_of(modes, state.mode)},
          {"status", word_of(statuses, state.status)},
          {"lower", number(joint.lower)},
          {"upper", number(joint.upper)},
          {"max_velocity", joint.max_velocity},
          {"max_effort", joint.max_effort},
          {"rest", joint.rest},
          {"gains", {{"p", joint.p}, {"i", joint.i}, {"d", joint.d}, {"from", joint.gains_from}, {"compensated", joint.compensated != 0}}}};
}

void show(Control& control, const shm::Iface& iface) {
  const auto joints = joints_of(iface);
  const auto states = states_of(iface);
  if (control.json()) {
    Json all = Json::array();
    for (std::size_t i = 0; i < joints.size(); ++i) all.push_back(json_of(joints[i], states[i]));
    return control.print(all);
  }
  std::size_t width = 5;
  for (const auto& joint : joints) width = std::max(width, name_of(joint).size());
  std::printf("%3s  %-*s  %10s  %10s  %10s  %10s  %-8s  %-6s  %s\n", "id", static_cast<int>(width), "joint", "position", "velocity",
              "effort", "target", "mode", "status", "limits, gains");
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const auto& joint = joints[i];
    const auto& state = states[i];
    std::printf("%3u  %-*s  %10.4f  %10.4f  %10.3f  %10.4f  %-8s  %-6s  %s to %s %s, %s %s, %s %s; p %.6g i %.6g d %.6g %s%s\n", joint.id,
                static_cast<int>(width), name_of(joint).c_str(), state.position, state.velocity, state.effort, state.target,
                word_of(modes, state.mode), word_of(statuses, state.status), base::format_number(joint.lower).c_str(),
                base::format_number(joint.upper).c_str(), joint.kind == RTMSIM_JOINT_SLIDES ? "m" : "rad",
                base::format_number(joint.max_velocity).c_str(), joint.kind == RTMSIM_JOINT_SLIDES ? "m/s" : "rad/s",
                base::format_number(joint.max_effort).c_str(), joint.kind == RTMSIM_JOINT_SLIDES ? "N" : "N m", joint.p, joint.i, joint.d,
                joint.gains_from, joint.compensated != 0 ? ", gravity compensated" : "");
  }
}

// The commands of all joints; nothing when a word is wrong, which is printed.
std::optional<std::vector<double>> commands_of(Control& control, const shm::Iface& iface, const JointOptions& options) {
  const auto joints = joints_of(iface);
  std::vector<double> values(RTMSIM_JOINT_VALUES * joints.size(), 0.0);
  const auto mode = static_cast<double>(std::ranges::find(modes, options.mode) - modes.begin());
  const bool has_value = options.mode != "free" && options.mode != "brake";
  for (const std::string& word : options.settings) {
    const auto at = word.rfind('=');
    const std::string name = word.substr(0, at);
    const auto value = at == std::string::npos ? std::nullopt : base::parse_number(word.substr(at + 1));
    if (has_value != (at != std::string::npos) || (has_value && !value))
      return control.reject("joint " + base::in_quotes(word) + ": expected " + (has_value ? "JOINT=NUMBER" : "JOINT") + " with mode " +
                            options.mode),
             std::nullopt;
    bool is_known = false;
    for (const auto& joint : joints) {
      if (name != "all" && name != name_of(joint)) continue;
      is_known = true;
      values[RTMSIM_JOINT_VALUES * joint.id] = mode + (options.is_compensated ? RTMSIM_JOINT_COMPENSATED : 0);
      values[RTMSIM_JOINT_VALUES * joint.id + 1] = value.value_or(0);
    }
    if (is_known) continue;
    std::vector<std::string> names;
    for (const auto& joint : joints) names.push_back(name_of(joint));
    return control.fail("model " + options.model + " has no joint " + base::in_quotes(name) + "; it has " + base::join(names, ", ")),
           std::nullopt;
  }
  return values;
}

// All that were commanded to a position stand there, or push against something. Those that have another mode now take no command (they
// follow another joint), or are commanded by somebody else.
bool have_arrived(const shm::Iface& iface, const std::vector<double>& values) {
  const auto states = states_of(iface);
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (values[RTMSIM_JOINT_VALUES * i] != 0 && states[i].mode == RTMSIM_JOINT_POSITION && states[i].status == RTMSIM_JOINT_MOVING)
      return false;
  }
  return true;
}

// A joint that has another target than it was given, in words; empty: none.
std::string foreign_target(const shm::Iface& iface, const std::vector<double>& values) {
  constexpr double nearly = 0.01;  // [rad or m]
  const auto joints = joints_of(iface);
  const auto states = states_of(iface);
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (values[RTMSIM_JOINT_VALUES * i] == 0 || states[i].mode == RTMSIM_JOINT_NONE) continue;
    const double wanted = std::max(joints[i].lower, std::min(values[RTMSIM_JOINT_VALUES * i + 1], joints[i].upper));
    const bool is_own = states[i].mode == RTMSIM_JOINT_POSITION && std::abs(states[i].target - wanted) < nearly;
    if (is_own) continue;
    return "joint " + name_of(joints[i]) + ": has mode " + word_of(modes, states[i].mode) + " and target " +
           base::format_number(states[i].target) + ", not position " + base::format_number(wanted) +
           ": another client commands it, or a fault halts it";
  }
  return {};
}

// The simulator has taken the command to brake: a sample shows it. A command of a client that leaves before that is dropped.
bool have_braked(const shm::Iface& iface, const std::vector<double>& values) {
  const auto states = states_of(iface);
  for (std::size_t i = 0; i < states.size(); ++i)
    if (values[RTMSIM_JOINT_VALUES * i] != 0 && states[i].mode != RTMSIM_JOINT_BRAKE && states[i].mode != RTMSIM_JOINT_DISABLED)
      return false;
  return true;
}

void command(Control& control, shm::Iface& iface, const JointOptions& options) {
  const auto values = commands_of(control, iface, options);
  if (!values) return;
  auto simulation = control.open(shm::IfaceType::simulation, "world");
  if (!simulation) return;
  if (is_paused(control.server_id())) return control.fail("the simulation is paused: joints move when time runs (simctl run)");
  if (const auto done = iface.command(shm::CommandKind::joints, *values); !done) return control.fail(done.error().message);
  catch_interrupts();
  const auto now = [&] { return simulation->read() ? simulation->sample<shm::SimulationSample>().stamp.sim_time_ns : 0; };
  const auto begin = now(), end = begin + static_cast<std::int64_t>(options.seconds * 1e9);
  constexpr std::int64_t taken = 50'000'000;  // [ns] after which the simulator has taken the command
  while (!is_interrupted()) {
    if (options.seconds > 0 && now() >= end) break;
    // Somebody else may command the joint at once: then no sample shows the brake.
    if (options.seconds <= 0 && options.mode == "brake" && now() > begin &&
        (now() >= begin + taken || (iface.read() && have_braked(iface, *values))))
      break;
    if (options.seconds <= 0 && options.mode == "position" && now() >= begin + taken && iface.read() && have_arrived(iface, *values)) break;
    if (simulation->wait(simulation->sequence(), std::chrono::milliseconds(100)) == shm::Wait::closed)
      return control.fail("the simulator has exited");
    if (iface.status() != shm::Status::live)
      return control.fail("iface " + iface.name() + ": its model was deleted, which ends the command");
  }
  if (!iface.read()) return;
  show(control, iface);
  if (options.mode != "position" || options.seconds > 0 || is_interrupted()) return;
  if (const std::string lost = foreign_target(iface, *values); !lost.empty()) control.fail(lost);
}

}  // namespace

void joints(Control& control, const JointOptions& options) {
  auto iface = control.open(shm::IfaceType::joints, options.model + "::joints");
  if (!iface) return;
  // A sample of now. While time stands still, a new one comes only if nobody else is subscribed; then the one that is there is of now.
  const std::uint64_t old = iface->sequence();
  if (const auto done = iface->subscribe(); !done) return control.fail(done.error().message);
  const bool stands = is_paused(control.server_id());
  const auto limit = old > 0 && stands ? std::chrono::milliseconds(200) : std::chrono::milliseconds(2000);
  if (iface->wait(old, limit) != shm::Wait::fresh && !iface->read())
    return control.fail("joints of " + options.model + ": no sample arrives");
  // That one may be of a step that had begun before: what another client did last (it left, say, and its joints brake) is in the next.
  if (!stands) static_cast<void>(iface->wait(iface->sequence(), std::chrono::milliseconds(500)));
  if (options.settings.empty()) return show(control, *iface);
  command(control, *iface, options);
}

}  // namespace simctl
