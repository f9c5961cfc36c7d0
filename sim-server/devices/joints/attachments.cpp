#include "devices/joints/attachments.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <map>
#include <utility>

#include "base/log.h"
#include "base/text.h"
#include "devices/device.h"
#include "world/plugin_kind.h"

namespace sim {
namespace {

constexpr std::chrono::milliseconds check_period{10};
constexpr double hardly_moved = 1e-3;  // [m] against the palm, between two checks

std::string name_of_link(const Physics& physics, LinkId link) {
  const ModelDef& def = physics.def(link.model);
  return def.name + "::" + def.links[link.link].name;
}

void say(base::Level level, const std::string& line) { base::log(level, "attachments", "{}", line); }

bool is_held_still(const Physics& physics, LinkId by, LinkId link) {
  return physics.exists(by.model) && physics.exists(link.model) && physics.are_attached(by, link);
}

}  // namespace

void Attachments::add(const Physics& physics, ModelId model, std::vector<std::string>& left_out) {
  const ModelDef& def = physics.def(model);
  for (const PluginDef& plugin : def.plugins) {
    if (kind_of(plugin) != PluginKind::detachable_joint) continue;
    const auto text = [&](std::string_view name) { return plugin.parameters.text_of({name}).value_or(""); };
    const auto fail = [&](const std::string& why) {
      left_out.push_back(fmt::format("{}: plugin {}: {}; it attaches nothing", plugin.source, plugin.name, why));
    };
    const auto parent = link_of(def, plugin.scope, text("parent_link"));
    Detachable joint{.model = model, .child_model = text("child_model"), .child_link = text("child_link")};
    if (!parent) {
      fail(fmt::format("model {} has no link {}", def.name, base::in_quotes(text("parent_link"))));
    } else if (joint.child_model.empty() || joint.child_link.empty() || joint.child_model == def.name || joint.child_model == "__model__") {
      fail("child_model and child_link must name a link of another model");
    } else {
      joint.parent = *parent;
      joint.name = def.name + "::" + joint.child_model;
      for (int number = 2; knows(joint.name); ++number) joint.name = def.name + "::" + joint.child_model + "_" + std::to_string(number);
      joints_.push_back(std::move(joint));
    }
  }
  for (const GripperDef& one : def.grippers) {
    const auto palm = link_of(def, {}, one.palm);
    if (!palm) continue;
    Grip grip{.name = def.name + "::" + one.name, .model = model, .def = one, .palm = *palm, .is_on = one.attaches};
    for (const std::string& finger : one.fingers) {
      if (const auto link = link_of(def, {}, finger)) grip.fingers.push_back(*link);
    }
    grips_.push_back(std::move(grip));
  }
  // A deleted model that a reset brings back has its old place.
  std::ranges::stable_sort(joints_, {}, &Detachable::model);
  std::ranges::stable_sort(grips_, {}, &Grip::model);
}

void Attachments::remove(ModelId model) {
  std::erase_if(joints_, [&](const Detachable& one) { return one.model == model; });
  std::erase_if(grips_, [&](const Grip& one) { return one.model == model; });
}

void Attachments::reset(ModelId first_spawned) {
  std::erase_if(joints_, [&](const Detachable& one) { return one.model >= first_spawned; });
  std::erase_if(grips_, [&](const Grip& one) { return one.model >= first_spawned; });
  next_ = std::chrono::nanoseconds(0);
  for (Detachable& one : joints_) one.is_on = true, one.held.reset(), one.is_told = false;
  for (Grip& one : grips_) one.is_on = one.def.attaches, one.held.reset(), one.touched.reset(), one.checks = 0;
}

bool Attachments::knows(std::string_view name) const {
  return std::ranges::any_of(joints_, [&](const Detachable& one) { return one.name == name; }) ||
         std::ranges::any_of(grips_, [&](const Grip& one) { return one.name == name; });
}

std::vector<Attachments::State> Attachments::states(const Physics& physics) const {
  std::vector<State> states;
  const auto add = [&](const auto& one) {
    const bool is_held = one.held && is_held_still(physics, one.held->by, one.held->link);
    states.push_back({one.name, one.is_on, is_held ? name_of_link(physics, one.held->link) : ""});
  };
  for (const Detachable& one : joints_) add(one);
  for (const Grip& one : grips_) add(one);
  return states;
}

base::Result<void> Attachments::hold(Physics& physics, Detachable& joint) {
  const auto child = physics.find(joint.child_model);
  if (!child) return base::Error{fmt::format("{}: there is no model {}", joint.name, base::in_quotes(joint.child_model))};
  const auto link = link_of(physics.def(*child), {}, joint.child_link);
  if (!link)
    return base::Error{fmt::format("{}: model {} has no link {}", joint.name, joint.child_model, base::in_quotes(joint.child_link))};
  const Held held{{joint.model, joint.parent}, {*child, *link}};
  if (const auto done = physics.attach(held.by, held.link); !done) return base::Error{joint.name + ": " + done.error().message};
  joint.held = held;
  say(base::Level::info, fmt::format("{}: {} holds {}", joint.name, name_of_link(physics, held.by), name_of_link(physics, held.link)));
  return {};
}

base::Result<void> Attachments::turn(Physics& physics, std::string_view name, bool is_on) {
  for (Detachable& one : joints_) {
    if (one.name != name) continue;
    if (one.held && !is_held_still(physics, one.held->by, one.held->link)) one.held.reset();
    if (is_on && !one.held) {
      if (const auto done = hold(physics, one); !done) return done;
    } else if (!is_on && one.held) {
      physics.detach(one.held->by, one.held->link);
      one.held.reset();
    }
    one.is_on = is_on;
    return {};
  }
  for (Grip& one : grips_) {
    if (one.name != name) continue;
    if (!is_on && one.held && is_held_still(physics, one.held->by, one.held->link)) physics.detach(one.held->by, one.held->link);
    if (!is_on) one.held.reset(), one.touched.reset(), one.checks = 0;
    one.is_on = is_on;
    return {};
  }
  return base::Error{"there is no gripper or detachable joint " + base::in_quotes(name)};
}

void Attachments::before_step(Physics& physics, std::chrono::nanoseconds time) {
  if (time < next_ || (joints_.empty() && grips_.empty())) return;
  next_ = time + check_period;
  for (Detachable& one : joints_) {
    if (one.is_on) check(physics, one);
  }
  for (Grip& one : grips_) {
    if (one.is_on) check(physics, one);
  }
}

// What was put elsewhere, or is gone, is not held any more.
void Attachments::check(Physics& physics, Detachable& joint) {
  if (joint.held && is_held_still(physics, joint.held->by, joint.held->link)) return;
  if (joint.held) {
    joint.held.reset();
    joint.is_on = false;
    say(base::Level::warn, fmt::format("{}: one of the models was moved or deleted; it is detached", joint.name));
    return;
  }
  const auto done = hold(physics, joint);
  if (!done && !std::exchange(joint.is_told, true)) say(base::Level::warn, done.error().message + "; it is attached as soon as it can be");
}

std::optional<LinkId> Attachments::max_touched(const Physics& physics, const Grip& grip) {
  std::map<std::pair<ModelId, std::uint32_t>, int> counts;
  for (const Contact& contact : physics.contacts(grip.model)) {
    if (std::ranges::find(grip.fingers, contact.link.link) == grip.fingers.end() || contact.other.model == grip.model) continue;
    if (physics.exists(contact.other.model) && physics.can_move(contact.other)) ++counts[{contact.other.model, contact.other.link}];
  }
  const auto most = std::ranges::max_element(counts, {}, [](const auto& one) { return one.second; });
  if (most == counts.end() || most->second < grip.def.contacts) return std::nullopt;
  return LinkId{most->first.first, most->first.second};
}

bool Attachments::touches(const Physics& physics, const Grip& grip) {
  return std::ranges::any_of(physics.contacts(grip.model), [&](const Contact& contact) {
    return std::ranges::find(grip.fingers, contact.link.link) != grip.fingers.end() && contact.other == grip.held->link;
  });
}

void Attachments::check(Physics& physics, Grip& grip) {
  if (!grip.held) return seek(physics, grip);
  if (!is_held_still(physics, grip.held->by, grip.held->link)) {
    grip.held.reset(), grip.checks = 0;
    return;
  }
  grip.checks = touches(physics, grip) ? 0 : grip.checks + 1;
  if (grip.checks < grip.def.detach_checks) return;
  physics.detach(grip.held->by, grip.held->link);
  say(base::Level::info, fmt::format("{}: lets go of {}", grip.name, name_of_link(physics, grip.held->link)));
  grip.held.reset(), grip.touched.reset(), grip.checks = 0;
}

void Attachments::seek(Physics& physics, Grip& grip) {
  const LinkId palm{grip.model, grip.palm};
  const auto touched = max_touched(physics, grip);
  const bool is_same = touched && grip.touched && *touched == *grip.touched;
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
  if (touched) place = physics.link_pose(palm).inverse() * physics.link_pose(*touched).translation();
  grip.checks = is_same && (place - grip.place).norm() < hardly_moved ? grip.checks + 1 : 0;
  grip.touched = touched;
  grip.place = place;
  if (!touched || grip.checks < grip.def.attach_checks) return;
  grip.checks = 0;
  if (const auto done = physics.attach(palm, *touched); !done) return;
  grip.held = Held{palm, *touched};
  say(base::Level::info, fmt::format("{}: holds {}", grip.name, name_of_link(physics, *touched)));
}

void Attachments::add_to(StateHash& hash) const {
  for (const Detachable& one : joints_) {
    if (one.is_on || one.held) hash.add_all(std::uint64_t{one.model}, std::uint64_t{one.is_on}, std::uint64_t{one.held.has_value()});
  }
  for (const Grip& one : grips_) {
    if (!one.is_on) continue;
    hash.add_all(std::uint64_t{one.model}, std::uint64_t{one.held.has_value()}, static_cast<std::uint64_t>(one.checks));
    if (one.touched)
      hash.add_all(std::uint64_t{one.touched->model}, std::uint64_t{one.touched->link}, one.place.x(), one.place.y(), one.place.z());
  }
}

}  // namespace sim
