#include "description.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>
#include <span>

#include "joint_frames.h"
#include "names.h"
#include "ros/from_iface.h"

namespace ros2 {
namespace {

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", value);
  return text;
}

std::string escaped(const std::string& text) {
  std::string safe;
  for (const char c : text) safe += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '"' ? "&quot;" : std::string(1, c);
  return safe;
}

std::string origin_of(const shm::Pose& p) {
  const double roll = std::atan2(2 * (p.qw * p.qx + p.qy * p.qz), 1 - 2 * (p.qx * p.qx + p.qy * p.qy));
  const double pitch = std::asin(std::clamp(2 * (p.qw * p.qy - p.qz * p.qx), -1.0, 1.0));
  const double yaw = std::atan2(2 * (p.qw * p.qz + p.qx * p.qy), 1 - 2 * (p.qy * p.qy + p.qz * p.qz));
  return "<origin xyz=\"" + number(p.x) + " " + number(p.y) + " " + number(p.z) + "\" rpy=\"" + number(roll) + " " + number(pitch) + " " +
         number(yaw) + "\"/>";
}

// Empty for a shape that URDF has not, or that has no end.
std::string geometry_of(const ListedShape& shape) {
  const auto& s = shape.size;
  if (shape.kind == "box" && s.size() == 3) return "<box size=\"" + number(s[0]) + " " + number(s[1]) + " " + number(s[2]) + "\"/>";
  if (shape.kind == "cylinder" && s.size() == 2) return "<cylinder radius=\"" + number(s[0]) + "\" length=\"" + number(s[1]) + "\"/>";
  if (shape.kind == "sphere" && s.size() == 1) return "<sphere radius=\"" + number(s[0]) + "\"/>";
  return "";
}

// Of the links that `link` carries, in its frame; "" is the base.
std::string shapes_of(const ListedModel& model, const std::set<std::string>& moving, const std::string& link, const shm::Pose& frame) {
  std::string text;
  const auto to_frame = ros::inverse(frame);
  for (const auto& one : model.links) {
    if (carrier_of(model, one.name, [&](const auto& name) { return moving.contains(name); }) != link) continue;
    for (const auto& shape : one.shapes) {
      const auto geometry = geometry_of(shape);
      if (geometry.empty()) continue;
      const std::string body = origin_of(ros::product(to_frame, shape.pose)) + "<geometry>" + geometry + "</geometry>";
      text += "    <visual>" + body + "</visual>\n    <collision>" + body + "</collision>\n";
    }
  }
  return text;
}

std::string joint_of(const shm::Joint& joint, const std::string& parent, const shm::Pose& pose) {
  const bool has_limits = std::isfinite(joint.lower) && std::isfinite(joint.upper);
  const bool slides = joint.kind == RTMSIM_JOINT_SLIDES;
  const std::string kind = slides ? "prismatic" : has_limits ? "revolute" : "continuous";
  constexpr double far = 1e6;  // a prismatic joint must have limits
  std::string text = "  <joint name=\"" + escaped(ros::text_of(joint.name)) + "\" type=\"" + kind + "\">\n    <parent link=\"" + parent +
                     "\"/>\n    <child link=\"" + token(ros::text_of(joint.link)) + "\"/>\n    " + origin_of(pose) + "\n    <axis xyz=\"" +
                     number(joint.axis[0]) + " " + number(joint.axis[1]) + " " + number(joint.axis[2]) + "\"/>\n    <limit";
  if (kind != "continuous")
    text += " lower=\"" + number(has_limits ? joint.lower : -far) + "\" upper=\"" + number(has_limits ? joint.upper : far) + "\"";
  const auto finite = [](double value) { return number(std::isfinite(value) ? value : far); };
  return text + " effort=\"" + finite(joint.max_effort) + "\" velocity=\"" + finite(joint.max_velocity) + "\"/>\n  </joint>\n";
}

}  // namespace

std::string urdf_of(const ListedModel& model, const shm::Iface* joints, const shm::Pose& base) {
  std::set<std::string> moving;
  const auto* first = joints == nullptr ? nullptr : reinterpret_cast<const shm::Joint*>(joints->info_followers(0));
  const std::span<const shm::Joint> all(first, joints == nullptr ? 0 : joints->count());
  for (const auto& joint : all) moving.insert(ros::text_of(joint.link));
  const auto position_of = [&](const shm::Joint& joint) {
    const auto found = model.joint_positions.find(ros::text_of(joint.name));
    return found == model.joint_positions.end() ? 0.0 : found->second;
  };
  std::string rest;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::string link = ros::text_of(all[i].link);
    const bool is_root = all[i].parent == 0 || all[i].parent > all.size();
    const std::string parent = is_root ? "base_link" : token(ros::text_of(all[all[i].parent - 1].link));
    rest += "  <link name=\"" + token(link) + "\">\n" + shapes_of(model, moving, link, joint_frame(all, i, position_of)) + "  </link>\n" +
            joint_of(all[i], parent, is_root ? ros::product(ros::inverse(base), all[i].pose) : all[i].pose);
  }
  return "<?xml version=\"1.0\"?>\n<robot name=\"" + token(model.name) + "\">\n  <link name=\"base_link\">\n" +
         shapes_of(model, moving, "", base) + "  </link>\n" + rest + "</robot>\n";
}

}  // namespace ros2
