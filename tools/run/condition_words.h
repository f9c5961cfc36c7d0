// Conditions as maps of YAML files, in campaign plans and in files of expectations: each is an expression of recording/expression.h.
//
//   {port: A0:out, member: data.vx, min: 1, max: 2}   A0:out.data.vx >= 1 && A0:out.data.vx <= 2; one of them may be missing
//   {model: M, region: [1, 2, 3, 4]}                  pose(M).x >= 1 && pose(M).y >= 2 && pose(M).x <= 3 && pose(M).y <= 4
//   {model: M, touches: OTHER}                        touches(M, OTHER); any: any model but the ground
//   {component: C, is: Active}                        state(C) == Active
//
// And the values of expressions, as far as a run and its record share them. Values; any thread.
#pragma once

#include <string>
#include <vector>

#include "base/result.h"
#include "recording/expression.h"
#include "run/simulator.h"
#include "run/yaml_shape.h"

namespace tools {

inline constexpr const char* usually_touched = "ground_plane";  // what a model may touch when nothing else is said

// Of a map whose values fit the forms above. Throws YamlFailure.
recorder::Expression to_expression(const YAML::Node& node);

// "data.vx", "ranges[0]" -> its steps; the error says what is wrong with it.
base::Result<std::vector<std::string>> member_path(const std::string& member);

// x, y, z or yaw [m, rad].
double member_of(const shm::Pose& pose, const std::string& member);
// Whether one of a model's contacts is with `other`, a model or "any".
bool is_touching(const std::vector<ModelContact>& contacts, const std::string& other);

}  // namespace tools
