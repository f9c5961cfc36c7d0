// Links, joints and grippers of the models of a world, and the objects that grippers hold: read from the tree of the simulator
// (RTMSIM_REQUEST_TREE, sim-server --check --json). Values; any thread.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "base/result.h"

namespace tools {

struct ModelContact {
  std::string link, other;  // "MODEL::LINK::COLLISION"
};

struct Gripper {
  std::string name, model;           // MODEL::GRIPPER, MODEL
  std::vector<std::string> links{};  // fingers and palm, as the model names them
};

// What a model has that a run can be asked about.
struct ModelParts {
  std::string name;
  std::vector<std::string> joints;  // that have a position
  std::vector<Gripper> grippers;
  std::vector<std::string> links{};
};

// One of the "models" of a tree.
ModelParts to_parts(const nlohmann::json& model);
// Of a gripper as it is written in an expectation, and a model.
std::string grip_name(const std::string& gripper, const std::string& model);
// What is wrong with the grip, from the contacts of the model; empty: two links of the gripper touch it, or the only one.
std::string grip_problem(const Gripper& gripper, const std::string& model, const std::vector<ModelContact>& contacts);
// MODEL::GRIPPER, the name of a gripper that no other model has, or a model with one gripper. The error says which grippers there are.
base::Result<Gripper> find_gripper(const std::vector<ModelParts>& parts, const std::string& name);
// Of the model; the error says which joints it has.
base::Result<void> find_joint(const std::vector<ModelParts>& parts, const std::string& model, const std::string& joint);

base::Result<void> find_link(const std::vector<ModelParts>& parts, const std::string& model, const std::string& link);

}  // namespace tools
