#include "devices/render_world.h"

#include <algorithm>
#include <cmath>

#include "base/log.h"

namespace sim {
namespace {

// The way points of all trajectories in turn, each on the clock of the whole.
std::vector<WaypointDef> all_waypoints(const ActorDef& actor) {
  std::vector<WaypointDef> out;
  double start = 0;
  for (const auto& trajectory : actor.trajectories) {
    for (auto waypoint : trajectory.waypoints) {
      waypoint.time += start;
      if (out.empty() || waypoint.time > out.back().time) out.push_back(waypoint);
    }
    if (!out.empty()) start = out.back().time;
  }
  return out;
}

// A smooth curve through p1 and p2 that looks at their neighbours; tension 1 makes it straight.
Eigen::Vector3d curve(const Eigen::Vector3d& p0, const Eigen::Vector3d& p1, const Eigen::Vector3d& p2, const Eigen::Vector3d& p3,
                      double tension, double u) {
  const Eigen::Vector3d m1 = (1 - tension) * 0.5 * (p2 - p0) + tension * (p2 - p1);
  const Eigen::Vector3d m2 = (1 - tension) * 0.5 * (p3 - p1) + tension * (p2 - p1);
  const double u2 = u * u, u3 = u2 * u;
  return (2 * u3 - 3 * u2 + 1) * p1 + (u3 - 2 * u2 + u) * m1 + (3 * u2 - 2 * u3) * p2 + (u3 - u2) * m2;
}

}  // namespace

Eigen::Isometry3d actor_pose(const ActorDef& actor, double seconds) {
  const auto points = all_waypoints(actor);
  seconds -= actor.delay_start;
  if (points.empty() || seconds < 0 || !actor.auto_start) return actor.pose;
  const double length = points.back().time;
  if (actor.loop && length > 0) seconds = std::fmod(seconds, length);
  if (seconds <= points.front().time) return points.front().pose;
  if (seconds >= length) return points.back().pose;
  const auto next = std::upper_bound(points.begin(), points.end(), seconds, [](double t, const WaypointDef& p) { return t < p.time; });
  const auto i = static_cast<std::size_t>(next - points.begin());
  const std::size_t last = points.size() - 1;
  // A path that ends where it begins has no corner there.
  const bool is_closed = actor.loop && (points[0].pose.translation() - points[last].pose.translation()).norm() < 1e-6 && last > 1;
  const auto place = [&](std::size_t k) { return points[k].pose.translation(); };
  const double u = (seconds - points[i - 1].time) / (points[i].time - points[i - 1].time);
  const Eigen::Vector3d before = i >= 2 ? place(i - 2) : is_closed ? place(last - 1) : place(i - 1);
  const Eigen::Vector3d after = i < last ? place(i + 1) : is_closed ? place(1) : place(i);
  const double tension = actor.trajectories.empty() ? 0 : actor.trajectories.front().tension;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = curve(before, place(i - 1), place(i), after, std::clamp(tension, 0.0, 1.0), u);
  pose.linear() = Eigen::Quaterniond(points[i - 1].pose.linear()).slerp(u, Eigen::Quaterniond(points[i].pose.linear())).toRotationMatrix();
  return pose;
}

RenderWorld::RenderWorld(const Physics& physics, const WorldDef& world) : physics_(physics), world_(world) {}

bool RenderWorld::is_current(const Built& built) const {
  if (!built.scene) return false;
  std::size_t count = 0;
  for (ModelId id = 0; id < physics_.model_slots(); ++id) {
    if (!physics_.exists(id)) continue;
    // The definition is compared too: after a reset an id may stand for another model.
    if (count >= built.models.size() || built.models[count] != id || built.defs[count].get() != &physics_.def(id)) return false;
    ++count;
  }
  return count == built.models.size();
}

void RenderWorld::build(Built& built, Scene::Content content) {
  built.models.clear();
  built.defs.clear();
  Scene::Parts parts{world_.scene, {}, {}, {}};
  for (const auto& light : world_.lights) parts.lights.push_back(&light);
  for (ModelId id = 0; id < physics_.model_slots(); ++id) {
    if (!physics_.exists(id)) continue;
    built.models.push_back(id);
    built.defs.push_back(physics_.shared_def(id));
    parts.models.push_back(built.defs.back().get());
  }
  for (const auto& actor : world_.actors) parts.actors.push_back(&actor);
  built.scene = Scene::build(parts, assets_, content);
  for (const auto& complaint : assets_.take_complaints()) base::log(base::Level::warn, "render", "{}", complaint);
}

Snapshot RenderWorld::snapshot(std::chrono::nanoseconds time, Scene::Content content) {
  Built& built = content == Scene::Content::visuals ? visuals_ : collisions_;
  if (!is_current(built)) build(built, content);
  auto poses = std::make_shared<std::vector<Eigen::Isometry3d>>();
  poses->reserve(built.scene->links.size());
  for (const auto id : built.models) {
    const auto links = static_cast<std::uint32_t>(physics_.def(id).links.size());
    for (std::uint32_t link = 0; link < links; ++link) poses->push_back(physics_.link_pose({id, link}));
  }
  const double seconds = std::chrono::duration<double>(time).count();
  for (const auto& actor : world_.actors) poses->push_back(actor_pose(actor, seconds));
  return {built.scene, std::move(poses), built.models};
}

}  // namespace sim
