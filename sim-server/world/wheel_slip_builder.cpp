#include "world/wheel_slip_builder.h"

#include <algorithm>
#include <variant>

#include "base/text.h"
#include "world/checks.h"
#include "world/joint_builder.h"
#include "world/xml_file.h"
#include "world/xml_values.h"

namespace sim {
namespace {

double radius_of(const LinkDef& link) {
  for (const CollisionDef& collision : link.collisions) {
    if (const auto* cylinder = std::get_if<CylinderShape>(&collision.geometry)) return cylinder->radius;
    if (const auto* sphere = std::get_if<SphereShape>(&collision.geometry)) return sphere->radius;
  }
  return 0;
}

// What the file says for a number that must be positive; empty: it is.
std::string problem_of(pugi::xml_node wheel, const char* element, double number) {
  if (number > 0) return "";
  const pugi::xml_node child = wheel.child(element);
  return std::string("needs a positive ") + element + ", got " + (child ? base::in_quotes(base::trim(child.text().get())) : "none");
}

}  // namespace

void add_wheel_slips(pugi::xml_node plugin, const std::string& scope, ModelDef& model, Complaints& complaints) {
  if (!plugin.child("wheel")) complaints.warn(plugin, describe_in_context(plugin) + " needs a <wheel>; it does nothing");
  for (pugi::xml_node wheel : plugin.children("wheel")) {
    const std::string name = wheel.attribute("link_name").value();
    const LinkDef* link = model.link(scoped(scope, name));
    if (link == nullptr) {
      complaints.warn(wheel,
                      describe_in_context(plugin) + " names the link " + base::in_quotes(name) + ", which does not exist; it is left out");
      continue;
    }
    if (std::any_of(model.slips.begin(), model.slips.end(), [&](const WheelSlipDef& other) { return other.link == link->name; })) {
      complaints.warn(wheel, describe_in_context(plugin) + ": wheel " + base::in_quotes(name) + " slips already; it is left out");
      continue;
    }
    WheelSlipDef slip;
    slip.link = link->name;
    slip.lateral = std::max(0.0, number_at(wheel, "slip_compliance_lateral", 0));
    slip.longitudinal = std::max(0.0, number_at(wheel, "slip_compliance_longitudinal", 0));
    slip.normal_force = number_at(wheel, "wheel_normal_force", 0);
    slip.radius = number_at(wheel, "wheel_radius", 0);
    if (!(slip.radius > 0)) slip.radius = radius_of(*link);
    auto problem = problem_of(wheel, "wheel_normal_force", slip.normal_force);
    if (problem.empty()) problem = problem_of(wheel, "wheel_radius", slip.radius);
    if (!problem.empty()) {
      complaints.warn(wheel, describe_in_context(plugin) + ": wheel " + base::in_quotes(name) + " " + problem + "; it does not slip");
      continue;
    }
    model.slips.push_back(std::move(slip));
  }
}

}  // namespace sim
