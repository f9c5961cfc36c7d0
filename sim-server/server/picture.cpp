#include "server/picture.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "base/text.h"
#include "devices/sensors/camera.h"
#include "devices/sensors/laser.h"

namespace sim {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double usual_fov = 1.0, widest_fov = 2.8;  // [rad]

// A camera that looks from one place to another, level.
Isometry3d look_at(const Vector3d& from, const Vector3d& to) {
  const Vector3d forward = (to - from).normalized();
  const Vector3d other = std::abs(forward.z()) < 0.999 ? Vector3d::UnitZ() : Vector3d::UnitX();
  const Vector3d left = other.cross(forward).normalized();
  Isometry3d pose = Isometry3d::Identity();
  pose.linear() << forward, left, forward.cross(left);
  pose.translation() = from;
  return pose;
}

Eigen::AlignedBox3d bounds_of(const Snapshot& world) {
  Eigen::AlignedBox3d box = world.scene->bounds(*world.poses);
  if (box.isEmpty()) box = Eigen::AlignedBox3d(Vector3d(-3, -3, 0), Vector3d(3, 3, 1));
  return box;
}

// From above, without perspective; up in the picture is y. `across` metres fit into the width.
View from_above(const Vector3d& middle, double top, double across, int width, int height) {
  View view;
  view.is_parallel = true;
  view.width = width;
  view.height = height;
  view.right = 0.5 * across;
  view.left = -view.right;
  view.top = view.right * height / width;
  view.bottom = -view.top;
  view.pose.translation() = Vector3d(middle.x(), middle.y(), top + 5);
  view.pose.linear() << Vector3d(0, 0, -1), Vector3d(-1, 0, 0), Vector3d(0, 1, 0);
  view.near_clip = 1;
  view.far_clip = top + 1000;
  return view;
}

// Everything, obliquely from the south-west, as near as it fits into the picture.
View of_everything(const Eigen::AlignedBox3d& box, int width, int height) {
  const Vector3d direction = Vector3d(0.35, 0.8, -0.62).normalized();
  const Vector3d middle = box.center();
  double near = 0.5, far = 20 * box.diagonal().norm() + 10;
  View view;
  const auto fits = [&](double distance) {
    view = View::pinhole(look_at(middle - direction * distance, middle), usual_fov, width, height);
    for (int i = 0; i < 8; ++i) {
      const Vector3d p = view.pose.inverse() * box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i));
      if (p.x() < 0.1 || std::abs(p.y()) > 0.96 * view.right * p.x() || std::abs(p.z()) > 0.94 * view.top * p.x()) return false;
    }
    return true;
  };
  for (int i = 0; i < 40; ++i) (fits(0.5 * (near + far)) ? far : near) = 0.5 * (near + far);
  fits(far);
  return view;
}

// From behind and above, as one walks after it.
View behind(const Isometry3d& pose, double radius, double span, int width, int height) {
  const double yaw = yaw_of(pose), distance = 1.2 + 4.5 * std::max(radius, 0.1);
  const Vector3d ahead(std::cos(yaw), std::sin(yaw), 0);
  const Vector3d eye = pose.translation() - ahead * distance + Vector3d(0, 0, 0.75 * distance);
  return View::pinhole(look_at(eye, pose.translation() + 0.6 * radius * ahead + Vector3d(0, 0, 0.3 * radius)), span > 0 ? span : usual_fov,
                       width, height);
}

const CameraPlaceSource* find_camera(Simulation& simulation, const std::string& name) {
  for (const auto& device : simulation.devices()) {
    const auto* camera = dynamic_cast<const CameraPlaceSource*>(device.get());
    if (camera != nullptr && device->iface().name() == name) return camera;
  }
  return nullptr;
}

std::vector<std::string> camera_names(Simulation& simulation) {
  std::vector<std::string> names;
  for (const auto& device : simulation.devices()) {
    if (dynamic_cast<const CameraPlaceSource*>(device.get()) != nullptr) names.push_back(device->iface().name());
  }
  return names;
}

}  // namespace

base::Result<View> view_of(Simulation& simulation, const Snapshot& world, const shm::ScreenshotRequest& request) {
  using Kind = shm::ScreenshotRequest::View;
  const int width = static_cast<int>(request.width), height = static_cast<int>(request.height);
  const Eigen::AlignedBox3d box = bounds_of(world);
  const Vector3d middle = box.center();
  const bool has_angle = request.view == Kind::from || request.view == Kind::follow;
  if (has_angle && request.span > widest_fov)
    return base::Error{fmt::format("field of view {}, expected at most {} rad", request.span, widest_fov)};
  if (request.view == Kind::camera) {
    const auto* camera = find_camera(simulation, request.follow);
    if (camera == nullptr) {
      const auto names = camera_names(simulation);
      return base::Error{"no camera " + base::in_quotes(request.follow) + (names.empty() ? "" : "; there is " + base::join(names, ", "))};
    }
    const CameraDef& def = camera->camera_def();
    View view = View::pinhole(camera->camera_pose(), std::min(def.horizontal_fov, widest_fov), width, height);
    view.near_clip = def.near_clip;
    view.far_clip = def.far_clip;
    view.visibility_mask = def.visibility_mask;
    return view;
  }
  if (request.view == Kind::from) return View::pinhole(from_pose(request.pose), request.span > 0 ? request.span : usual_fov, width, height);
  if (request.view == Kind::follow) {
    const auto found =
        std::find_if(world.scene->models.begin(), world.scene->models.end(), [&](const auto& m) { return m.name == request.follow; });
    if (found == world.scene->models.end()) return base::Error{"no model " + request.follow};
    return behind((*world.poses)[found->canonical_link], found->radius, request.span, width, height);
  }
  if (request.view == Kind::top) {
    const bool has_middle = request.span > 0;
    const double fit = 1.06 * std::max({box.sizes().x(), box.sizes().y() * width / height, 1.0});
    return from_above(has_middle ? Vector3d(request.pose.x, request.pose.y, 0) : middle, box.max().z(), has_middle ? request.span : fit,
                      width, height);
  }
  return of_everything(box, width, height);
}

Overlay overlay_of(Simulation& simulation, const Snapshot& world) {
  Overlay overlay;
  simulation.rays().update();
  // A robot has the colour of its first scanner; those without one get the colours after.
  std::map<ModelId, Color> colors;
  std::size_t next = 0;
  for (const auto& device : simulation.devices()) {
    const auto* laser = dynamic_cast<const Laser*>(device.get());
    if (laser == nullptr) continue;
    const Color color = colors.try_emplace(laser->model(), overlay_color(next)).first->second;
    ++next;
    Overlay::Fan fan;
    fan.points = laser->look(fan.origin);
    fan.color = color;
    overlay.fans.push_back(std::move(fan));
  }
  for (const auto& device : simulation.devices()) {
    const auto type = device->iface().type();
    if (type != shm::IfaceType::position2d && type != shm::IfaceType::position3d) continue;
    if (colors.try_emplace(device->model(), overlay_color(next)).second) ++next;
  }
  for (std::size_t i = 0; i < world.models.size(); ++i) {
    const auto color = colors.find(world.models[i]);
    if (color == colors.end()) continue;
    const SceneModel& model = world.scene->models[i];
    const Vector3d middle = (*world.poses)[model.canonical_link].translation() + Vector3d(0, 0, 0.5 * model.height);
    overlay.labels.push_back({middle, model.radius, model.name, {1, 1, 1, 1}, 13});
    if (world.models[i] >= simulation.trails().size()) continue;
    Overlay::Trail trail;
    trail.color = color->second;
    for (const auto& point : simulation.trails()[world.models[i]].points)
      trail.points.push_back(point.cast<double>() + Vector3d(0, 0, 0.01));
    overlay.trails.push_back(std::move(trail));
  }
  return overlay;
}

base::Result<PicturePlan> plan_picture(Simulation& simulation, const shm::ScreenshotRequest& request) {
  const auto content = request.with_collisions ? Scene::Content::collisions : Scene::Content::visuals;
  PicturePlan plan{simulation.pictures().snapshot(simulation.time(), content), {}, {}};
  auto view = view_of(simulation, plan.world, request);
  if (!view) return view.error();
  if (!view->is_parallel && request.view != shm::ScreenshotRequest::View::camera) {
    // The nearest thing may be the ground below. What lies close together far away needs a near plane that is not too near.
    const Eigen::AlignedBox3d box = bounds_of(plan.world);
    const Vector3d eye = view->pose.translation();
    view->near_clip = std::clamp(0.3 * std::min(box.exteriorDistance(eye), std::abs(eye.z() - box.min().z())), 0.05, 5.0);
    view->far_clip = std::max(200.0, 3 * box.diagonal().norm());
  }
  view->grid = simulation.world().scene.grid && request.view != shm::ScreenshotRequest::View::camera;
  plan.view = *view;
  if (request.with_scans) plan.overlay = overlay_of(simulation, plan.world);
  // A picture that lacks something says so: else it is taken for the whole world, or is a blank that tells nothing.
  const std::size_t missing = simulation.world().missing_parts;
  if (missing > 0 && request.view != shm::ScreenshotRequest::View::camera) {
    if (!plan.overlay) plan.overlay.emplace();
    const bool is_blank = plan.world.scene->bounds(*plan.world.poses).isEmpty();
    plan.overlay->notice =
        fmt::format("{}{} part{} of this world {} missing; the simulator's log names {}", is_blank ? "nothing to show: " : "", missing,
                    missing == 1 ? "" : "s", missing == 1 ? "is" : "are", missing == 1 ? "it" : "them");
    plan.overlay->is_notice_central = is_blank;
  }
  return plan;
}

base::Result<Image> draw_picture(Renderer& renderer, const PicturePlan& plan) {
  return draw_smooth(renderer, plan.world.scene, *plan.world.poses, plan.view, plan.overlay ? &*plan.overlay : nullptr);
}

}  // namespace sim
