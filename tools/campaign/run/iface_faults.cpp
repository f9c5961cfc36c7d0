#include "campaign/run/iface_faults.h"

#include <algorithm>
#include <array>
#include <chrono>

#include "base/child_process.h"
#include "base/text.h"
#include "campaign/run/action_runner.h"

namespace campaign {
namespace {

using namespace std::chrono_literals;
using Object = Fault::Object;

// Components that command the iface that they name.
constexpr std::array<std::string_view, 8> actuator_types = {":RTCPosition2d:", ":RTCPosition3d:",  ":RTCActArray:", ":RTCGripper:",
                                                            ":RTCLimb:",       ":RTCManipulator:", ":RTCPTZ:",      ":RTCRobotHardware:"};

std::string parameter(const tools::SavedComponent& component, const std::string& name) {
  for (const auto& set : component.configuration_sets) {
    for (const auto& [key, value] : set.values) {
      if (!set.is_hidden() && key == name) return value;
    }
  }
  return "";
}

// Our own components say which iface they stand for.
std::vector<HuntTarget> targets_of(const tools::SavedSystem& system) {
  std::vector<HuntTarget> targets;
  for (const auto& connector : system.connectors) {
    const bool is_push = connector.is_data && !base::equal_ignoring_case(connector.dataflow_type, "pull");
    if (is_push) targets.push_back({Object::connector, connector.id, {}});
  }
  for (const auto& component : system.components) {
    const auto device = parameter(component, "device_id");
    const auto is_a = [&](std::string_view type) { return component.id.find(type) != std::string::npos; };
    const bool is_drive = std::ranges::any_of(actuator_types, is_a);
    const bool is_camera = component.id.find("Camera:") != std::string::npos;
    if (!device.empty() && is_drive) targets.push_back({Object::actuator, device, {}});
    if (!device.empty() && !is_camera) targets.push_back({Object::sensor, device, {}});
    targets.push_back({Object::component, component.instance, {Fault::Kind::error, Fault::Kind::exception}});
  }
  return targets;
}

bool is_of_iface(Object object) { return object == Object::sensor || object == Object::actuator; }

Fault usual_fault(const HuntTarget& target, Fault::Kind kind) {
  return {target.object, kind, target.name, 0, {}, usual_amount(kind).value_or(0)};
}

// What the simulator says of the first that it rejects: "fault KIND of IFACE: ...", "fault KIND: the world has no iface IFACE"; empty:
// none.
Result<std::string> refused(const Plan& plan, std::vector<Fault> faults) {
  constexpr auto limit = 60s;
  const auto options = ActionRunner({.events = {}, .faults = std::move(faults), .never = {}, .eventually = {}}, 1, 0).simulator_options();
  if (options.empty()) return std::string();
  base::ProgramCall call{{base::own_program("sim-server"), plan.run.world, "--check", "-v", "0"}, {}, ""};
  for (const auto& path : plan.run.resource_paths) call.words.insert(call.words.end(), {"--resource-path", path});
  call.words.insert(call.words.end(), options.begin(), options.end());
  auto started = base::ChildProcess::start(call);
  if (!started) return started.error();
  if (!started->wait(limit)) return std::string();  // a world that takes so long is loaded once more, and says so then
  constexpr std::string_view mark = "sim-server: fault ";
  for (const auto& line : base::split_list(started->said(), '\n')) {
    if (line.starts_with(mark)) return line.substr(line.find(' ') + 1);
  }
  return std::string();
}

// Whether that was about this one.
bool is_meant(const std::string& refusal, const HuntTarget& target, Fault::Kind kind) {
  if (!is_of_iface(target.object)) return false;
  if (refusal.ends_with(" has no iface " + target.name)) return true;
  const bool is_drive = target.object == Object::actuator;
  const auto name = is_drive && kind == Fault::Kind::stuck ? "halted" : std::string(to_text(kind));  // as the simulator calls it
  return refusal.starts_with("fault " + name + " of " + target.name + ":");
}

Error wrong(const Plan& plan, const std::string& refusal) { return {"plan " + base::in_quotes(plan.file) + ": " + refusal}; }

}  // namespace

Result<void> check_iface_faults(const Plan& plan) {
  auto faults = plan.faults;
  for (const auto& target : plan.hunt.targets) {
    // Without a word of how it may break, one is enough to see whether it is there: each iface of its kind can have the first.
    const auto kinds = target.kinds.empty() ? std::vector{faults_of(target.object).front()} : target.kinds;
    for (const auto kind : kinds) faults.push_back(usual_fault(target, kind));
  }
  const auto refusal = refused(plan, std::move(faults));
  if (!refusal) return refusal.error();
  return refusal->empty() ? Result<void>() : wrong(plan, *refusal);
}

Result<std::vector<HuntTarget>> hunt_targets(const Campaign& campaign) {
  const auto& hunt = campaign.plan().hunt;
  auto targets = hunt.targets.empty() && hunt.events.empty() ? targets_of(campaign.system()) : hunt.targets;
  std::vector<bool> is_asked;  // for these kinds and no others
  for (auto& target : targets) {
    is_asked.push_back(!target.kinds.empty());
    if (target.kinds.empty()) target.kinds = faults_of(target.object);
  }
  for (;;) {
    std::vector<Fault> faults;
    for (const auto& target : targets) {
      for (const auto kind : target.kinds) faults.push_back(usual_fault(target, kind));
    }
    const auto refusal = refused(campaign.plan(), std::move(faults));
    if (!refusal) return refusal.error();
    if (refusal->empty()) return targets;
    std::size_t dropped = 0;
    for (std::size_t i = 0; i < targets.size(); ++i) {
      if (!is_asked[i]) dropped += std::erase_if(targets[i].kinds, [&](Fault::Kind kind) { return is_meant(*refusal, targets[i], kind); });
    }
    if (dropped == 0) return wrong(campaign.plan(), *refusal);
  }
}

}  // namespace campaign
