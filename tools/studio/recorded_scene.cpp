#include "studio/recorded_scene.h"

#include <unistd.h>

#include <cstring>

#include "base/text.h"
#include "run/recorded_run.h"
#include "shm/request_board.h"
#include "studio/scene.h"
#include "studio/started_run.h"

namespace studio {
namespace {

using base::Error;
using base::Result;

constexpr std::uint32_t lowest_server = 5000, highest_server = 9999;  // those below are for people and their scripts
constexpr int tries = 20;
constexpr int deepest_frame = 16;
constexpr const char* world_frame = "world";

std::uint32_t free_server_id(std::uint32_t number) {
  const auto first = static_cast<std::uint32_t>(::getpid()) * 7 + number * 131;
  for (std::uint32_t i = 0;; ++i) {
    const std::uint32_t id = lowest_server + (first + i) % (highest_server - lowest_server + 1);
    if (i > highest_server || !shm::Requester::open(id)) return id;
  }
}

// The JSON of a glTF binary: behind twelve octets its length, a word, and then the text.
Json json_of(const std::string& glb) {
  constexpr std::size_t head = 20, length_at = 12;
  std::uint32_t length = 0;
  if (glb.size() < head) return {};
  std::memcpy(&length, glb.data() + length_at, sizeof length);
  if (length > glb.size() - head) return {};
  return Json::parse(std::string_view(glb).substr(head, length), nullptr, false);
}

PoseNumbers pose_of_node(const Json& node) {
  PoseNumbers pose{0, 0, 0, 1, 0, 0, 0};
  if (const auto place = node.find("translation"); place != node.end()) {
    for (std::size_t i = 0; i < 3; ++i) pose[i] = place->at(i).get<float>();
  }
  if (const auto turn = node.find("rotation"); turn != node.end()) {  // x y z w
    for (std::size_t i = 0; i < 4; ++i) pose[3 + (i + 1) % 4] = turn->at(i).get<float>();
  }
  return pose;
}

// `second` is in the frame that `first` puts somewhere.
PoseNumbers product(const PoseNumbers& first, const PoseNumbers& second) {
  const auto [x, y, z, w, qx, qy, qz] = first;
  const auto [px, py, pz, v, rx, ry, rz] = second;
  const float tx = 2 * (qy * pz - qz * py), ty = 2 * (qz * px - qx * pz), tz = 2 * (qx * py - qy * px);
  return {x + px + w * tx + qy * tz - qz * ty, y + py + w * ty + qz * tx - qx * tz, z + pz + w * tz + qx * ty - qy * tx,
          w * v - qx * rx - qy * ry - qz * rz, w * rx + qx * v + qy * rz - qz * ry, w * ry - qx * rz + qy * v + qz * rx,
          w * rz + qx * ry - qy * rx + qz * v};
}

}  // namespace

Result<RecordedScene> RecordedScene::read(Content glb) {
  RecordedScene scene;
  const Json json = json_of(*glb.octets);
  try {
    const Json& extras = json.at("scenes").at(0).at("extras");
    scene.version = extras.at("version").get<std::uint32_t>();
    for (const auto& link : extras.at("links")) {
      const Json& node = json.at("nodes").at(link.get<std::size_t>());
      scene.links.push_back(node.value("name", ""));
      scene.poses.push_back(pose_of_node(node));
    }
    for (const auto& node : json.at("nodes")) {
      if (node.contains("extras") && node["extras"].value("model", false))
        scene.models.push_back({{"name", node.value("name", "")}, {"static", node["extras"].value("static", false)}});
    }
  } catch (const Json::exception& e) {
    return Error{std::string("the simulator's scene has not the expected members: ") + e.what()};
  }
  scene.glb = std::move(glb);
  return scene;
}

Result<std::shared_ptr<const RecordedScene>> RecordedScene::make(const std::string& recording) {
  const auto run = recorder::RecordedRun::unpack(recording, recorder::RecordedRun::Needs::world);
  if (!run) return run.error();
  StartOptions options;
  options.world = run->world();
  const auto recorded = run->options();
  if (!recorded) return recorded.error();
  options.resource_paths = recorded->resource_paths;
  tools::SilentReporter reporter;  // the error says enough
  bool is_rejected = false;
  Result<std::unique_ptr<StartedRun>> started = Error{"no server id is free"};
  for (std::uint32_t i = 0; i < tries && !started; ++i) {
    const auto id = free_server_id(i);
    started = StartedRun::start(CORBA::ORB::_nil(), options, id, reporter, is_rejected);
    if (!started && !shm::Requester::open(id)) return started.error();  // else somebody was quicker
  }
  if (!started) return started.error();
  auto glb = export_scene((*started)->server_id(), false);
  if (glb.status != 200) return Error{std::string(base::trim(*glb.octets))};
  auto scene = read(std::move(glb));
  if (!scene) return scene.error();
  scene->glb_with_collisions = export_scene((*started)->server_id(), true);
  return std::make_shared<const RecordedScene>(std::move(*scene));
}

void RecordedPlaces::take(const Json& message) {
  for (const auto& transform : message.at("transforms")) {
    const Json& place = transform.at("transform").at("translation");
    const Json& turn = transform.at("transform").at("rotation");
    const auto number = [](const Json& of, const char* member) { return of.at(member).get<float>(); };
    frames_[transform.at("child_frame_id").get<std::string>()] = {
        transform.at("header").at("frame_id").get<std::string>(),
        {number(place, "x"), number(place, "y"), number(place, "z"), number(turn, "w"), number(turn, "x"), number(turn, "y"),
         number(turn, "z")}};
  }
}

bool RecordedPlaces::is_placed(const std::string& name, PoseNumbers& pose) const {
  auto frame = frames_.find(name);
  if (frame == frames_.end()) return false;
  pose = frame->second.pose;
  for (int depth = 0; frame->second.parent != world_frame; ++depth) {
    frame = frames_.find(frame->second.parent);
    if (frame == frames_.end() || depth > deepest_frame) return false;
    pose = product(frame->second.pose, pose);
  }
  return true;
}

std::vector<float> RecordedPlaces::of(const RecordedScene& scene, const std::vector<std::string>& more) const {
  std::vector<float> numbers;
  numbers.reserve((scene.links.size() + more.size()) * 7);
  for (std::size_t i = 0; i < scene.links.size(); ++i) {
    PoseNumbers pose{};
    if (!is_placed(scene.links[i], pose)) pose = scene.poses[i];
    numbers.insert(numbers.end(), pose.begin(), pose.end());
  }
  for (const auto& frame : more) {
    PoseNumbers pose{0, 0, 0, 1, 0, 0, 0};
    (void)is_placed(frame, pose);  // one that is not placed yet stands in the middle
    numbers.insert(numbers.end(), pose.begin(), pose.end());
  }
  return numbers;
}

}  // namespace studio
