#include "campaign/rows/world_survey.h"

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>

#include "base/child_process.h"
#include "base/text.h"

namespace campaign {
namespace {

using base::Error;
using base::Result;

constexpr std::chrono::minutes longest_check{5};
constexpr int corners_of_circle = 32;

// x y z qw qx qy qz
Eigen::Isometry3d pose_of(const nlohmann::json& json) {
  const auto n = json.get<std::vector<double>>();
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Eigen::Vector3d(n.at(0), n.at(1), n.at(2));
  pose.linear() = Eigen::Quaterniond(n.at(3), n.at(4), n.at(5), n.at(6)).normalized().toRotationMatrix();
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
std::vector<Eigen::Vector3d> ball(double radius, double z) {
  std::vector<Eigen::Vector3d> points;
  for (const auto& p : ring(radius, 0)) {
    for (const auto& turned : {Eigen::Vector3d(p.x(), p.y(), 0), Eigen::Vector3d(p.x(), 0, p.y()), Eigen::Vector3d(0, p.x(), p.y())})
      points.emplace_back(turned + Eigen::Vector3d(0, 0, z));
  }
  return points;
}

std::vector<Eigen::Vector3d> corners(const std::string& shape, const std::vector<double>& size) {
  std::vector<Eigen::Vector3d> points;
  const auto add = [&](const std::vector<Eigen::Vector3d>& more) { points.insert(points.end(), more.begin(), more.end()); };
  if (shape == "box") {
    for (int i = 0; i < 8; ++i)
      points.emplace_back((i & 1 ? 0.5 : -0.5) * size.at(0), (i & 2 ? 0.5 : -0.5) * size.at(1), (i & 4 ? 0.5 : -0.5) * size.at(2));
  } else if (shape == "sphere") {
    add(ball(size.at(0), 0));
  } else if (shape == "cylinder") {
    for (const double side : {-0.5, 0.5}) add(ring(size.at(0), side * size.at(1)));
  } else if (shape == "capsule") {
    for (const double side : {-0.5, 0.5}) add(ball(size.at(0), side * size.at(1)));
  }
  return points;
}

SurveyedModel to_model(const nlohmann::json& json) {
  SurveyedModel model;
  model.pose = pose_of(json.at("pose"));
  model.is_static = json.at("static").get<bool>();
  model.parts = tools::to_parts(json);
  for (const auto& link : json.at("links")) {
    model.mass += link.at("mass").get<double>();
    const auto link_pose = model.pose.inverse() * pose_of(link.at("pose"));
    for (const auto& collision : link.at("collisions")) {
      auto points = corners(collision.at("shape").get<std::string>(), collision.at("size").get<std::vector<double>>());
      if (points.empty()) continue;
      const auto pose = link_pose * pose_of(collision.at("pose"));
      for (auto& point : points) point = pose * point;
      model.outline.parts.push_back(std::move(points));
    }
  }
  return model;
}

WorldSurvey to_survey(const nlohmann::json& json) {
  WorldSurvey survey;
  for (const auto& model : json.at("models")) survey.models.emplace(model.at("name").get<std::string>(), to_model(model));
  for (const auto& one : json.at("found")) {
    const auto file = one.at("file").get<std::string>();
    survey.found[{one.at("folder").get<std::string>(), one.at("uri").get<std::string>()}] = file;
    survey.files.insert(file);
  }
  for (const auto& one : json.at("spawned")) {
    if (!one.contains("files")) survey.not_found.push_back(one.at("model").get<std::string>());
    for (const auto& file : one.value("files", std::vector<std::string>())) survey.files.insert(file);
  }
  return survey;
}

}  // namespace

Result<WorldSurvey> survey_world(const std::string& world, const std::vector<std::string>& resource_paths,
                                 const std::vector<std::string>& spawned) {
  base::ProgramCall call{{base::own_program("sim-server"), world, "--check", "--json"}, {}, ""};
  for (const auto& path : resource_paths) call.words.insert(call.words.end(), {"--resource-path", path});
  for (const auto& model : spawned) call.words.insert(call.words.end(), {"--spawn", model});
  auto started = base::ChildProcess::start(call);
  if (!started) return started.error();
  const auto said = base::output_of(*started, longest_check);
  // A world with findings is a world; they are told when it runs. The JSON is the only line that begins so.
  for (const auto& line : base::split_list(started->said(), '\n')) {
    if (!line.starts_with("{\"models\"")) continue;
    try {
      auto survey = to_survey(nlohmann::json::parse(line));
      std::error_code ignored;  // a folder of material scripts is no file
      std::erase_if(survey.files, [&](const std::string& file) { return !std::filesystem::is_regular_file(file, ignored); });
      survey.files.insert(std::filesystem::absolute(world, ignored).string());
      return survey;
    } catch (const std::exception& problem) {
      return Error{"world " + base::in_quotes(world) + ": sim-server is of another version: " + problem.what()};
    }
  }
  return Error{"world " + base::in_quotes(world) + ": " + (said ? "sim-server printed no models" : said.error().message)};
}

}  // namespace campaign
