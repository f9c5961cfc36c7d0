#include "simctl/offers.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <set>
#include <tuple>

#include "base/text.h"
#include "shm/client.h"

namespace simctl {
namespace {

using shm::IfaceType;

long server_id(const std::vector<std::string>& words) {
  const char* from_environment = std::getenv("RTMSIM_SERVER_ID");
  std::string text = from_environment ? from_environment : "0";
  for (std::size_t i = 0; i + 1 < words.size(); ++i) {
    if (words[i] == "-s" || words[i] == "--server-id") text = words[i + 1];
  }
  return static_cast<long>(base::parse_integer(text).value_or(0));
}

bool fits(IfaceType type, const std::string& value, const std::string& command) {
  const bool is_drive = shm::row_of(type).command_values > 0;
  if (value == "MODEL" && command == "joints") return type == IfaceType::joints;
  if (value == "MODEL" || value == "--follow") return type == IfaceType::truth;
  if (value == "CAMERA" || value == "--camera") return type == IfaceType::camera;
  if (command == "velocity") return is_drive || type == IfaceType::truth;
  if (command == "odometry" || command == "motors") return is_drive;
  if (command == "tag") return type == IfaceType::rfid;
  if (command == "fault") return type != IfaceType::truth && type != IfaceType::simulation && shm::row_of(type).sample_size > 0;
  return true;
}

// Joints of the models that the line names.
std::vector<base::Offer> joint_offers(const std::vector<std::string>& before) {
  std::vector<base::Offer> found;
  for (const auto& segment : shm::find_segments()) {
    const auto& [type, iface, server] = std::tie(segment.name.type, segment.name.iface, segment.name.server_id);
    if (!segment.is_alive || type != IfaceType::joints || server != server_id(before)) continue;
    if (std::ranges::none_of(before, [&](const std::string& word) { return word + "::joints" == iface; })) continue;
    const auto opened = shm::Iface::open(server, type, iface);
    if (!opened) continue;
    const auto* joints = reinterpret_cast<const shm::Joint*>(opened->info_followers(0));
    for (std::size_t i = 0; i < opened->count(); ++i) found.push_back({joints[i].name});
  }
  return found;
}

}  // namespace

std::optional<std::vector<base::Offer>> offers(const std::string& value, const std::vector<std::string>& before, const std::string&) {
  if (value == "JOINT") return joint_offers(before);
  static constexpr std::array asked{"IFACE", "MODEL", "CAMERA", "--server-id", "--follow", "--camera"};
  if (std::ranges::find(asked, value) == asked.end()) return std::nullopt;
  static constexpr std::array sharp{"odometry", "motors", "velocity", "fault", "joints", "tag"};
  const auto command = std::ranges::find_first_of(before, sharp);
  std::vector<base::Offer> found;
  std::set<std::string> seen;
  for (const auto& segment : shm::find_segments()) {
    if (!segment.is_alive) continue;
    if (value == "--server-id") {
      if (const auto id = std::to_string(segment.name.server_id); seen.insert(id).second) found.push_back({id});
      continue;
    }
    if (segment.name.server_id != server_id(before) || !fits(segment.name.type, value, command == before.end() ? "" : *command)) continue;
    std::string name = segment.name.iface;
    if (value == "MODEL" && segment.name.type == IfaceType::joints) name.erase(name.rfind("::joints"));
    if (seen.insert(name).second) found.push_back({name, std::string(shm::to_text(segment.name.type))});
  }
  return found;
}

}  // namespace simctl
