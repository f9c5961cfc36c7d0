#include "server/describe.h"

#include <unistd.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "base/log.h"
#include "devices/joints/joint_groups.h"
#include "devices/joints/joint_list.h"
#include "shm/iface_json.h"
#include "world/iface_names.h"

namespace sim {
namespace {

using Json = nlohmann::ordered_json;

Json numbers(const Eigen::Vector3d& v) { return Json::array({v.x(), v.y(), v.z()}); }

Json numbers(const Eigen::Isometry3d& pose) {
  const Eigen::Quaterniond q(pose.linear());
  const Eigen::Vector3d p = pose.translation();
  return Json::array({p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()});
}

// The three of a box; the radius, and the length; of other shapes nothing.
Json size_of(const GeometryDef& geometry) {
  if (const auto* box = std::get_if<BoxShape>(&geometry)) return numbers(box->size);
  if (const auto* sphere = std::get_if<SphereShape>(&geometry)) return Json::array({sphere->radius});
  if (const auto* cylinder = std::get_if<CylinderShape>(&geometry)) return Json::array({cylinder->radius, cylinder->length});
  if (const auto* capsule = std::get_if<CapsuleShape>(&geometry)) return Json::array({capsule->radius, capsule->length});
  return Json::array();
}

// Names come from files and need not be UTF-8.
std::string text(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

std::string full_name(const Physics& physics, LinkId link, std::uint32_t collision) {
  if (!physics.exists(link.model)) return "?";
  const ModelDef& model = physics.def(link.model);
  return model.name + "::" + model.links[link.link].name + "::" + model.links[link.link].collisions[collision].name;
}

// Of a joints iface.
Json groups_of(const ModelDef& model) {
  Json groups = Json::array();
  for (const JointGroup& group : joint_groups(model, commandable_joints(model))) {
    groups.push_back({{"kind", group.kind}, {"joints", group.joints}});
    if (!group.name.empty()) groups.back()["name"] = group.name;
    if (group.field_of_view > 0) groups.back()["field_of_view"] = group.field_of_view;
  }
  return groups;
}

// Numbers that are not finite become null.
Json bounds_of(const Physics& physics, ModelId id) {
  const Eigen::AlignedBox3d box = physics.shape_box(id);
  if (box.isEmpty()) return Json::array();
  const Eigen::Vector3d &low = box.min(), &high = box.max();
  return Json::array({low.x(), low.y(), low.z(), high.x(), high.y(), high.z()});
}

Json model_tree(const Physics& physics, ModelId id) {
  const ModelDef& model = physics.def(id);
  Json links = Json::array(), joints = Json::array(), plugins = Json::array();
  for (std::uint32_t l = 0; l < model.links.size(); ++l) {
    const LinkDef& link = model.links[l];
    Json sensors = Json::array(), collisions = Json::array();
    for (const auto& sensor : link.sensors) {
      sensors.push_back({{"name", sensor.name}, {"type", sensor.type}, {"iface", iface_name(model, sensor)}});
    }
    for (const auto& collision : link.collisions)
      collisions.push_back({{"name", collision.name},
                            {"shape", std::string(kind_of(collision.geometry))},
                            {"pose", numbers(collision.pose)},
                            {"size", size_of(collision.geometry)}});
    links.push_back({{"name", link.name},
                     {"mass", link.mass},
                     {"pose", numbers(physics.link_pose({id, l}))},
                     {"collisions", collisions},
                     {"sensors", sensors}});
  }
  for (std::uint32_t j = 0; j < model.joints.size(); ++j) {
    const JointDef& joint = model.joints[j];
    const JointState state = physics.joint_state({id, j});
    joints.push_back({{"name", joint.name},
                      {"type", std::string(to_text(joint.kind))},
                      {"parent", joint.parent.empty() ? "world" : joint.parent},
                      {"child", joint.child.empty() ? "world" : joint.child},
                      {"position", state.position},
                      {"velocity", state.velocity}});
  }
  for (const auto& plugin : model.plugins) plugins.push_back({{"name", plugin.name}, {"filename", plugin.filename}});
  Json grippers = Json::array();
  for (const auto& one : model.grippers) grippers.push_back({{"name", one.name}, {"palm", one.palm}, {"fingers", one.fingers}});
  return {{"name", model.name},
          {"static", physics.is_static(id)},
          {"pose", numbers(physics.model_pose(id))},
          {"links", links},
          {"joints", joints},
          {"plugins", plugins},
          {"grippers", grippers}};
}

}  // namespace

std::size_t resident_memory() {
  std::ifstream file("/proc/self/statm");
  std::size_t total = 0, resident = 0;
  file >> total >> resident;
  return resident * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

std::string list_text(Simulation& simulation) {
  const Physics& physics = simulation.physics();
  Json models = Json::array(), ifaces = Json::array();
  for (ModelId id = 0; id < physics.model_slots(); ++id) {
    if (!physics.exists(id)) continue;
    models.push_back({{"name", physics.def(id).name}, {"static", physics.is_static(id)}, {"pose", numbers(physics.model_pose(id))}});
  }
  for (const auto& device : simulation.devices()) {
    const auto& iface = device->iface();
    ifaces.push_back({{"type", std::string(shm::to_text(iface.type()))},
                      {"name", iface.name()},
                      {"model", physics.def(device->model()).name},
                      {"subscribed", iface.is_subscribed()}});
    if (iface.type() == shm::IfaceType::joints) ifaces.back()["groups"] = groups_of(physics.def(device->model()));
  }
  Json attachments = Json::array();
  for (const auto& one : simulation.attachments().states(physics))
    attachments.push_back({{"name", one.name}, {"on", one.is_on}, {"holds", one.holds}});
  return text({{"world", simulation.world().name}, {"models", models}, {"ifaces", ifaces}, {"attachments", attachments}});
}

namespace {

Json tree_of(const Simulation& simulation, const std::string& model, bool with_bounds) {
  const Physics& physics = simulation.physics();
  Json models = Json::array();
  for (ModelId id = 0; id < physics.model_slots(); ++id) {
    if (!physics.exists(id) || (!model.empty() && physics.def(id).name != model)) continue;
    models.push_back(model_tree(physics, id));
    if (with_bounds) models.back()["bounds"] = bounds_of(physics, id);
  }
  Json actors = Json::array();
  for (const auto& actor : simulation.world().actors) {
    if (model.empty()) actors.push_back({{"name", actor.name}});
  }
  return {{"models", models}, {"actors", actors}};
}

}  // namespace

std::string tree_text(const Simulation& simulation, const std::string& model, bool with_bounds) {
  return text(tree_of(simulation, model, with_bounds));
}

std::string check_text(const Simulation& simulation, const FoundFiles& found, const std::vector<std::string>& spawned,
                       const ModelPath& model_path) {
  Json json = tree_of(simulation, "", false);
  json["found"] = Json::array();
  for (const auto& [named, file] : found) json["found"].push_back({{"folder", named.first}, {"uri", named.second}, {"file", file}});
  json["spawned"] = Json::array();
  for (const auto& model : spawned) {
    const auto loaded = load_model(model, "", std::nullopt, model_path);
    Json one = {{"model", model}};
    if (!loaded) one["error"] = loaded.error().message;
    for (const auto& [named, file] : loaded ? loaded->found : FoundFiles{}) one["files"].push_back(file);
    json["spawned"].push_back(one);
  }
  return text(json);
}

std::string models_text(const ModelPath& path) {
  Json models = Json::array();
  for (const auto& name : path.models()) models.push_back({{"name", name}});
  return text({{"models", models}});
}

std::string stats_text(Simulation& simulation, const LoopState& loop) {
  const Physics& physics = simulation.physics();
  const PhysicsStatistics s = physics.statistics();
  std::uint32_t models = 0, subscribed = 0;
  Json contacts = Json::object();
  for (ModelId id = 0; id < physics.model_slots(); ++id) {
    if (!physics.exists(id)) continue;
    ++models;
    if (!physics.is_static(id))
      contacts[physics.def(id).name] = {{"now", physics.contacts(id).size()}, {"total", physics.contacts_so_far(id)}};
  }
  for (const auto& device : simulation.devices()) subscribed += device->iface().is_subscribed() ? 1U : 0U;
  Json parts = Json::array();
  double all = 0;
  for (const auto& entry : loop.times->entries()) all += static_cast<double>(entry.total.count());
  for (std::size_t i = 0; i < part_names.size(); ++i) {
    const auto& entry = loop.times->entries()[i];
    const double total = static_cast<double>(entry.total.count());
    parts.push_back({{"name", std::string(part_names[i])},
                     {"calls", entry.calls},
                     {"total_ms", total * 1e-6},
                     {"mean_us", entry.calls > 0 ? total * 1e-3 / static_cast<double>(entry.calls) : 0.0},
                     {"max_us", static_cast<double>(entry.longest.count()) * 1e-3},
                     {"share", all > 0 ? total / all : 0.0}});
  }
  return text({{"world", simulation.world().name},
               {"pid", getpid()},
               {"sim_time", static_cast<double>(simulation.time().count()) / 1e9},
               {"steps", simulation.steps()},
               {"step", simulation.world().physics.step},
               {"paused", loop.is_paused},
               {"waiting_for", loop.waiting_for},
               {"rtf_wanted", loop.rtf_wanted},
               {"rtf", loop.rtf_reached},
               {"load", loop.load},
               {"hash", fmt::format("{:016x}", simulation.hash())},
               {"models", models},
               {"bodies", s.bodies},
               {"awake", s.awake},
               {"rolling", s.rolling},
               {"joints", s.joints},
               {"contacts", s.contacts},
               {"shards", s.shards},
               {"ifaces", simulation.devices().size()},
               {"subscribed", subscribed},
               {"memory_mib", static_cast<double>(resident_memory()) / (1 << 20)},
               {"parts", parts},
               {"participants", simctl::participants_json(loop.participants)},
               {"contacts_by_model", contacts}});
}

std::string contacts_text(const Simulation& simulation, ModelId model) {
  const Physics& physics = simulation.physics();
  Json contacts = Json::array();
  for (const Contact& contact : physics.contacts(model)) {
    contacts.push_back({{"link", full_name(physics, contact.link, contact.collision)},
                        {"other", full_name(physics, contact.other, contact.other_collision)},
                        {"position", numbers(contact.position)},
                        {"normal", numbers(contact.normal)},
                        {"depth", contact.depth}});
  }
  return text({{"model", physics.def(model).name}, {"total", physics.contacts_so_far(model)}, {"contacts", contacts}});
}

std::string faults_text(const Simulation& simulation, const std::string& iface) {
  const auto seconds = [](std::chrono::nanoseconds time) { return static_cast<double>(time.count()) / 1e9; };
  Json faults = Json::array();
  for (const FaultOrder& fault : simulation.faults()) {
    if (!iface.empty() && fault.iface != iface && !fault.iface.starts_with(iface + "::")) continue;
    const auto& row = shm::row_of(fault.kind);
    const bool has_end = fault.until != std::chrono::nanoseconds::max();
    faults.push_back({{"iface", fault.iface},
                      {"kind", std::string(row.name)},
                      {"amount", row.amount ? Json(fault.amount) : Json()},
                      {"from", seconds(fault.from)},
                      {"until", has_end ? Json(seconds(fault.until)) : Json()},
                      {"on", fault.is_at(simulation.time())}});
  }
  return text({{"time", seconds(simulation.time())}, {"faults", faults}});
}

}  // namespace sim
