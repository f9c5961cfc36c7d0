// Values in the text of elements, in SDFormat's spellings. Any thread.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "world/world_def.h"

namespace sim {

// Numbers separated by blanks (or commas); infinities and NaN are numbers here. Empty when a word is none.
std::optional<std::vector<double>> parse_numbers(std::string_view text);
// Six numbers (or seven with rotation_format="quat_xyzw"), degrees="true" understood. Empty when they are not finite.
std::optional<Eigen::Isometry3d> parse_pose(pugi::xml_node pose);
// Six numbers that parse_pose reads back.
std::string pose_text(const Eigen::Isometry3d& pose);

// Each reads the element at the path below the node ("surface/bounce/threshold"); the fallback when it is absent, empty or of another form.
double number_at(pugi::xml_node node, std::string_view path, double fallback);
std::optional<double> number_at(pugi::xml_node node, std::string_view path);
int integer_at(pugi::xml_node node, std::string_view path, int fallback);
bool bool_at(pugi::xml_node node, std::string_view path, bool fallback);
std::string text_at(pugi::xml_node node, std::string_view path, const std::string& fallback = {});
Eigen::Vector2d vector2_at(pugi::xml_node node, std::string_view path, const Eigen::Vector2d& fallback);
Eigen::Vector3d vector3_at(pugi::xml_node node, std::string_view path, const Eigen::Vector3d& fallback);
Color color_at(pugi::xml_node node, std::string_view path, const Color& fallback);
Eigen::Isometry3d pose_at(pugi::xml_node node, std::string_view path);

// Of six rows, by the 21 numbers of its upper half; zero when there are not as many. Those that are not finite are 0, all are within 1e9.
Eigen::Matrix<double, 6, 6> symmetric_matrix(std::string_view upper_half);

// The element with all in it as free-form parameters.
ParameterNode parameters_of(pugi::xml_node node);

}  // namespace sim
