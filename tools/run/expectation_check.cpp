#include "run/expectation_check.h"

#include <algorithm>

#include "base/text.h"
#include "run/verdict_time.h"
#include "system/value_codec.h"

namespace tools {
namespace {

using base::Error;
using base::Result;
using Kind = Expectation::Kind;

Error about(const Expectation& expectation, const std::string& what) { return {expectation.text + ": " + what}; }

std::string list(const std::vector<std::string>& names) { return names.empty() ? "none" : base::join(names, ", "); }

bool is_among(const std::vector<std::string>& names, const std::string& name) { return std::ranges::find(names, name) != names.end(); }

}  // namespace

Result<void> check_components(const std::vector<Expectation>& expectations, const SavedSystem& system) {
  std::vector<std::string> names;
  for (const auto& component : system.components) names.push_back(component.instance);
  for (const auto& expectation : expectations) {
    if (expectation.kind != Kind::state && expectation.kind != Kind::value) continue;
    const auto name = failed_object(expectation);
    if (!is_among(names, name))
      return about(expectation, "the system has no component " + base::in_quotes(name) + "; it has " + list(names));
  }
  return {};
}

Result<void> check_models(const std::vector<Expectation>& expectations, const std::vector<std::string>& models) {
  for (const auto& expectation : expectations) {
    auto names = expectation.except;
    std::erase(names, usually_touched);  // as it is the default, it may be missing
    if (!expectation.model.empty()) names.insert(names.begin(), expectation.model);
    for (const auto& name : names) {
      if (!is_among(models, name))
        return about(expectation, "the world has no model " + base::in_quotes(name) + "; it has " + list(models));
    }
  }
  return {};
}

Result<void> check_parts(const std::vector<Expectation>& expectations, const std::vector<ModelParts>& parts) {
  for (const auto& expectation : expectations) {
    const auto joint = expectation.kind == Kind::joint ? find_joint(parts, expectation.model, expectation.joint) : Result<void>();
    if (!joint) return about(expectation, joint.error().message);
    if (expectation.kind != Kind::holds) continue;
    const auto gripper = find_gripper(parts, expectation.gripper);
    if (!gripper) return about(expectation, gripper.error().message);
    if (gripper->model == expectation.model) return about(expectation, "gripper " + gripper->name + " is of this model itself");
  }
  return {};
}

Result<void> check_value(const Session& session, const Expectation& expectation) {
  const auto port = session.port(expectation.port);
  if (!port) return about(expectation, port.error().message);
  if (port->port.port_type() != "DataOutPort")
    return about(expectation, "port " + expectation.port + ": is not an OutPort, so it has no values");
  const auto type = port->port.data_type();
  if (CORBA::is_nil(type_code_of(type)))
    return about(expectation, "port " + expectation.port + ": carries " + type + ", which rtse does not know");
  if (expectation.member.empty()) return {};
  const auto path = member_path(expectation.member);
  if (!path) return about(expectation, path.error().message);
  const auto there = member_problem(type, *path);
  if (there.empty()) return {};
  return about(expectation, "the samples of " + expectation.port + " have no number " + expectation.member + "; they have " + there);
}

Result<void> check_values(const Session& session, const std::vector<Expectation>& expectations) {
  for (const auto& expectation : expectations) {
    if (expectation.kind != Kind::value) continue;
    if (const auto good = check_value(session, expectation); !good) return good;
  }
  return {};
}

}  // namespace tools
