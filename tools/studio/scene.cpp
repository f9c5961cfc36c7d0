#include "studio/scene.h"

#include "shm/request_board.h"

namespace studio {
namespace {

constexpr std::chrono::seconds export_limit{60};  // of large worlds

}  // namespace

Content refusal(const std::string& why) {
  return {503, "text/plain; charset=utf-8", std::make_shared<const std::string>("rtm-studio: " + why + "\n"), ""};
}

Content export_scene(std::uint32_t server_id, bool with_collisions) {
  auto simulator = shm::Requester::open(server_id);
  if (!simulator) return refusal(simulator.error().message);
  auto reply = simulator->ask(shm::ExportRequest{with_collisions}, export_limit);
  if (!reply) return refusal(reply.error().message);
  if (reply->status != shm::RequestStatus::ok) return refusal(reply->message);
  const auto version = std::to_string(static_cast<std::uint64_t>(reply->values[0]));
  // Another simulator may count the same: the tag holds for what both have in common, the octets.
  const auto tag = version + "-" + std::to_string(std::hash<std::string>()(reply->text));
  return {200, "model/gltf-binary", std::make_shared<const std::string>(std::move(reply->text)), tag};
}

}  // namespace studio
