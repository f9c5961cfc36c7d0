#include "world/xml_values.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

#include "base/text.h"
#include "world/xml_file.h"

namespace sim {

std::optional<std::vector<double>> parse_numbers(std::string_view text) {
  std::vector<double> numbers;
  const auto is_gap = [](char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == ','; };
  std::size_t at = 0;
  while (true) {
    while (at < text.size() && is_gap(text[at])) ++at;
    if (at == text.size()) return numbers;
    std::size_t end = at;
    while (end < text.size() && !is_gap(text[end])) ++end;
    const char* first = text.data() + at + (text[at] == '+' ? 1 : 0);
    const char* last = text.data() + end;
    double value = 0;
    const std::from_chars_result result = std::from_chars(first, last, value);
    if (result.ptr != last) return std::nullopt;
    if (result.ec == std::errc::result_out_of_range) {
      // Both ends of the range come here: 1e999 is infinite, 1e-999 is nothing.
      const std::string_view word(first, static_cast<std::size_t>(last - first));
      const bool is_tiny = word.find("e-") != std::string_view::npos || word.find("E-") != std::string_view::npos;
      value = is_tiny ? 0 : word.front() == '-' ? -infinite : infinite;
    } else if (result.ec != std::errc{}) {
      return std::nullopt;
    }
    numbers.push_back(value);
    at = end;
  }
}

std::optional<Eigen::Isometry3d> parse_pose(pugi::xml_node pose) {
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  const std::optional<std::vector<double>> numbers = parse_numbers(text_of(pose));
  if (!numbers) return std::nullopt;
  if (numbers->empty()) return out;
  for (double number : *numbers) {
    if (!std::isfinite(number)) return std::nullopt;
  }
  const bool is_quaternion = std::string_view(pose.attribute("rotation_format").value()) == "quat_xyzw";
  if (numbers->size() != (is_quaternion ? 7U : 6U)) return std::nullopt;
  const std::vector<double>& n = *numbers;
  out.translation() = Eigen::Vector3d(n[0], n[1], n[2]);
  if (is_quaternion) {
    const Eigen::Quaterniond rotation(n[6], n[3], n[4], n[5]);
    if (!(rotation.norm() > 1e-12)) return std::nullopt;
    out.linear() = rotation.normalized().toRotationMatrix();
  } else {
    const double unit = pose.attribute("degrees").as_bool() ? std::numbers::pi / 180 : 1;
    out.linear() = (Eigen::AngleAxisd(n[5] * unit, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(n[4] * unit, Eigen::Vector3d::UnitY()) *
                    Eigen::AngleAxisd(n[3] * unit, Eigen::Vector3d::UnitX()))
                       .toRotationMatrix();
  }
  return out;
}

std::string pose_text(const Eigen::Isometry3d& pose) {
  const Eigen::Vector3d p = pose.translation();
  const Eigen::Matrix3d r = pose.linear();
  const double pitch = std::atan2(-r(2, 0), std::hypot(r(0, 0), r(1, 0)));
  // Looking straight up or down, roll and yaw turn the same way; all of it is yaw then.
  const bool is_upright = std::hypot(r(0, 0), r(1, 0)) < 1e-9;
  const double roll = is_upright ? 0 : std::atan2(r(2, 1), r(2, 2));
  const double yaw = is_upright ? std::atan2(-r(0, 1), r(1, 1)) : std::atan2(r(1, 0), r(0, 0));
  std::string text;
  for (const double number : {p.x(), p.y(), p.z(), roll, pitch, yaw}) text += (text.empty() ? "" : " ") + base::format_number(number);
  return text;
}

std::optional<double> number_at(pugi::xml_node node, std::string_view path) {
  const std::optional<std::vector<double>> numbers = parse_numbers(text_of(child_at(node, path)));
  if (!numbers || numbers->size() != 1 || std::isnan(numbers->front())) return std::nullopt;
  return numbers->front();
}

double number_at(pugi::xml_node node, std::string_view path, double fallback) { return number_at(node, path).value_or(fallback); }

int integer_at(pugi::xml_node node, std::string_view path, int fallback) {
  const std::optional<double> number = number_at(node, path);
  return number && std::abs(*number) <= 2147483647.0 ? static_cast<int>(*number) : fallback;
}

bool bool_at(pugi::xml_node node, std::string_view path, bool fallback) {
  return base::parse_bool(text_of(child_at(node, path))).value_or(fallback);
}

std::string text_at(pugi::xml_node node, std::string_view path, const std::string& fallback) {
  std::string text = text_of(child_at(node, path));
  return text.empty() ? fallback : text;
}

Eigen::Vector2d vector2_at(pugi::xml_node node, std::string_view path, const Eigen::Vector2d& fallback) {
  const std::optional<std::vector<double>> n = parse_numbers(text_of(child_at(node, path)));
  return n && n->size() == 2 ? Eigen::Vector2d((*n)[0], (*n)[1]) : fallback;
}

Eigen::Vector3d vector3_at(pugi::xml_node node, std::string_view path, const Eigen::Vector3d& fallback) {
  const std::optional<std::vector<double>> n = parse_numbers(text_of(child_at(node, path)));
  return n && n->size() == 3 ? Eigen::Vector3d((*n)[0], (*n)[1], (*n)[2]) : fallback;
}

Color color_at(pugi::xml_node node, std::string_view path, const Color& fallback) {
  const std::optional<std::vector<double>> n = parse_numbers(text_of(child_at(node, path)));
  if (!n || n->size() < 3 || n->size() > 4) return fallback;
  const auto part = [&](std::size_t i) {
    return std::isfinite((*n)[i]) ? static_cast<float>(std::min(std::max((*n)[i], 0.0), 1.0)) : 1.0F;
  };
  return {part(0), part(1), part(2), n->size() == 4 ? part(3) : 1.0F};
}

Eigen::Isometry3d pose_at(pugi::xml_node node, std::string_view path) {
  return parse_pose(child_at(node, path)).value_or(Eigen::Isometry3d::Identity());
}

Eigen::Matrix<double, 6, 6> symmetric_matrix(std::string_view upper_half) {
  constexpr double largest = 1e9;
  Eigen::Matrix<double, 6, 6> matrix = Eigen::Matrix<double, 6, 6>::Zero();
  const auto numbers = parse_numbers(upper_half);
  if (!numbers || numbers->size() != 21) return matrix;
  auto entry = numbers->begin();
  for (int row = 0; row < 6; ++row) {
    for (int column = row; column < 6; ++column, ++entry)
      matrix(row, column) = matrix(column, row) = std::isfinite(*entry) ? std::clamp(*entry, -largest, largest) : 0;
  }
  return matrix;
}

ParameterNode parameters_of(pugi::xml_node node) {
  ParameterNode out;
  out.name = node.name();
  for (const pugi::xml_attribute& attribute : node.attributes()) {
    const std::string_view name = attribute.name();
    if (name != line_mark && name != file_mark) out.attributes.emplace_back(name, attribute.value());
  }
  for (const pugi::xml_node& child : node.children()) {
    if (child.type() == pugi::node_element) {
      out.children.push_back(parameters_of(child));
    } else if (child.type() == pugi::node_pcdata || child.type() == pugi::node_cdata) {
      out.text += base::trim(child.value());
    }
  }
  return out;
}

}  // namespace sim
