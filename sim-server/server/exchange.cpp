#include "server/exchange.h"

#include <array>

#include "world/iface_names.h"

namespace sim {
namespace {

using Numbers = std::vector<std::pair<std::string, double>>;

Numbers numbers_of(const SensorDef& sensor) {
  if (const auto* ray = std::get_if<RayDef>(&sensor.data))
    return {{"min_angle", ray->horizontal.min_angle}, {"max_angle", ray->horizontal.max_angle}, {"range_max", ray->range_max}};
  if (const auto* sonar = std::get_if<SonarDef>(&sensor.data))
    return {{"range_min", sonar->range_min}, {"range_max", sonar->range_max}, {"radius", sonar->radius}};
  const auto* set = std::get_if<CameraSetDef>(&sensor.data);
  if (set == nullptr || set->cameras.empty()) return {};
  const CameraDef& camera = set->cameras.front();
  return {{"fov", camera.horizontal_fov},
          {"width", camera.width},
          {"height", camera.height},
          {"near", camera.near_clip},
          {"far", camera.far_clip}};
}

Eigen::Isometry3d place_of(const SensorDef& sensor) {
  const auto* set = std::get_if<CameraSetDef>(&sensor.data);
  return set != nullptr && !set->cameras.empty() ? sensor.pose * set->cameras.front().pose : sensor.pose;
}

// Positions and velocities, two axes each; 0 where a joint has none.
void add_joints(const Physics& physics, const std::vector<ModelId>& models, shm::Reply& reply) {
  std::size_t count = 0;
  for (const ModelId id : models) {
    for (std::uint32_t j = 0; j < physics.def(id).joints.size(); ++j, ++count) {
      const JointState first = physics.joint_state({id, j}, 0), second = physics.joint_state({id, j}, 1);
      const std::array<float, 4> values = {static_cast<float>(first.position), static_cast<float>(second.position),
                                           static_cast<float>(first.velocity), static_cast<float>(second.velocity)};
      reply.text.append(reinterpret_cast<const char*>(values.data()), sizeof values);
    }
  }
  reply.values[1] = static_cast<double>(count);
}

}  // namespace

ExportPlan plan_export(Simulation& simulation, const shm::ExportRequest& request) {
  ExportPlan plan;
  plan.world = simulation.pictures().snapshot(simulation.time());
  plan.version = plan.world.version;
  if (request.with_collisions) plan.world = simulation.pictures().snapshot(simulation.time(), Scene::Content::collisions);
  plan.camera = simulation.world().gui_camera;
  for (std::size_t i = 0; i < plan.world.models.size(); ++i) {
    const ModelDef& model = simulation.physics().def(plan.world.models[i]);
    std::uint32_t link = plan.world.scene->models[i].first_link;
    for (const auto& def : model.links) {
      for (const auto& sensor : def.sensors)
        plan.sensors.push_back({link, iface_name(model, sensor), std::string(to_text(sensor.kind)), place_of(sensor), numbers_of(sensor)});
      ++link;
    }
  }
  return plan;
}

base::Result<std::string> write_export(const ExportPlan& plan) {
  return write_glb({*plan.world.scene, *plan.world.poses, plan.sensors, plan.camera, plan.version});
}

shm::Reply poses_reply(Simulation& simulation) {
  const Snapshot world = simulation.pictures().snapshot(simulation.time());
  shm::Reply reply;
  reply.count = static_cast<std::int64_t>(world.poses->size());
  reply.values[0] = static_cast<double>(world.version);
  reply.text.reserve(world.poses->size() * 7 * sizeof(float));
  for (const auto& pose : *world.poses) {
    const Eigen::Vector3f p = pose.translation().cast<float>();
    const Eigen::Quaternionf q = Eigen::Quaterniond(pose.linear()).normalized().cast<float>();
    const std::array<float, 7> values = {p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()};
    reply.text.append(reinterpret_cast<const char*>(values.data()), sizeof values);
  }
  add_joints(simulation.physics(), world.models, reply);
  return reply;
}

}  // namespace sim
