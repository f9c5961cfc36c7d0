#include "campaign/rows/outlines.h"

#include <cmath>
#include <numbers>
#include <string>

namespace campaign {
namespace {

constexpr int corners_of_circle = 32;
constexpr int deepest = 16;

Eigen::Isometry3d own_pose(pugi::xml_node node) { return to_pose(numbers_in(node.child("pose").text().get())); }

// In the frame of the model that the node stands in, along relative_to.
Eigen::Isometry3d pose_in_model(pugi::xml_node model, pugi::xml_node node, int depth = 0) {
  const auto pose = own_pose(node);
  const std::string frame = node.child("pose").attribute("relative_to").value();
  const std::string attached = frame.empty() && std::string(node.name()) == "frame" ? node.attribute("attached_to").value() : frame;
  if (attached.empty() || attached == "__model__" || depth == deepest) return pose;
  for (const char* kind : {"link", "frame", "model", "joint"}) {
    auto other = model.find_child_by_attribute(kind, "name", attached.c_str());
    if (!other || other == node) continue;
    if (std::string(kind) == "joint") {  // stands where its child does
      const auto child = model.find_child_by_attribute("link", "name", other.child("child").text().get());
      return pose_in_model(model, child, depth + 1) * own_pose(other) * pose;
    }
    return pose_in_model(model, other, depth + 1) * pose;
  }
  return pose;
}

std::vector<Eigen::Vector3d> ring(double radius, double z) {
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < corners_of_circle; ++i) {
    const double angle = 2 * std::numbers::pi * i / corners_of_circle;
    points.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
  }
  return points;
}

// A ball has the same outline however it is turned: rings about each axis.
std::vector<Eigen::Vector3d> ball(double radius, const Eigen::Vector3d& middle) {
  std::vector<Eigen::Vector3d> points;
  for (const auto& p : ring(radius, 0)) {
    for (const auto& turned : {Eigen::Vector3d(p.x(), p.y(), 0), Eigen::Vector3d(p.x(), 0, p.y()), Eigen::Vector3d(0, p.x(), p.y())})
      points.push_back(middle + turned);
  }
  return points;
}

std::vector<Eigen::Vector3d> corners(pugi::xml_node geometry) {
  std::vector<Eigen::Vector3d> points;
  const auto add = [&](const std::vector<Eigen::Vector3d>& more) { points.insert(points.end(), more.begin(), more.end()); };
  if (auto box = geometry.child("box")) {
    const auto size = numbers_in(box.child("size").text().get());
    if (size.size() != 3) return points;
    for (int i = 0; i < 8; ++i)
      points.emplace_back((i & 1 ? 0.5 : -0.5) * size[0], (i & 2 ? 0.5 : -0.5) * size[1], (i & 4 ? 0.5 : -0.5) * size[2]);
  } else if (auto sphere = geometry.child("sphere")) {
    add(ball(sphere.child("radius").text().as_double(), Eigen::Vector3d::Zero()));
  } else if (auto cylinder = geometry.child("cylinder")) {
    for (const double side : {-0.5, 0.5})
      add(ring(cylinder.child("radius").text().as_double(), side * cylinder.child("length").text().as_double()));
  } else if (auto capsule = geometry.child("capsule")) {
    const double half = capsule.child("length").text().as_double() / 2, radius = capsule.child("radius").text().as_double();
    for (const double side : {-half, half}) add(ball(radius, {0, 0, side}));
  }
  return points;
}

void add(pugi::xml_node node, const std::filesystem::path& at, const ModelFiles& files, const Eigen::Isometry3d& place, int depth,
         Outline& outline) {
  if (depth == deepest) return;
  if (std::string(node.name()) == "include") {
    if (const auto opened = files.open(node, at)) add(opened->model, opened->file.parent_path(), files, place, depth + 1, outline);
    return;
  }
  for (auto link : node.children("link")) {
    const auto link_place = place * pose_in_model(node, link);
    for (auto collision : link.children("collision")) {
      auto points = corners(collision.child("geometry"));
      if (points.empty()) continue;
      const auto pose = link_place * own_pose(collision);
      for (auto& point : points) point = pose * point;
      outline.parts.push_back(std::move(points));
    }
  }
  for (auto child : node.children()) {
    const std::string kind = child.name();
    if (kind == "model" || kind == "include") add(child, at, files, place * pose_in_model(node, child), depth + 1, outline);
  }
}

}  // namespace

Outline outline_of(pugi::xml_node node, const std::filesystem::path& at, const ModelFiles& files) {
  Outline outline;
  add(node, at, files, Eigen::Isometry3d::Identity(), 0, outline);
  return outline;
}

}  // namespace campaign
