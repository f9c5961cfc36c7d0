#include "simctl/offers.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <set>

#include "base/text.h"
#include "shm/segment.h"

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
  if (value == "MODEL" || value == "--follow") return type == IfaceType::truth;
  if (value == "CAMERA" || value == "--camera") return type == IfaceType::camera;
  if (command == "velocity") return is_drive || type == IfaceType::truth;
  if (command == "odometry" || command == "motors") return is_drive;
  if (command == "fault") return type != IfaceType::truth && type != IfaceType::simulation && shm::row_of(type).sample_size > 0;
  return true;
}

}  // namespace

std::optional<std::vector<base::Offer>> offers(const std::string& value, const std::vector<std::string>& before, const std::string&) {
  static constexpr std::array asked{"IFACE", "MODEL", "CAMERA", "--server-id", "--follow", "--camera"};
  if (std::ranges::find(asked, value) == asked.end()) return std::nullopt;
  static constexpr std::array sharp{"odometry", "motors", "velocity", "fault"};
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
    if (seen.insert(segment.name.iface).second) found.push_back({segment.name.iface, std::string(shm::to_text(segment.name.type))});
  }
  return found;
}

}  // namespace simctl
