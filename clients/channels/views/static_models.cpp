#include "views/static_models.h"

#include <nlohmann/json.hpp>

#include "shm/request_board.h"
#include "views/iface_view.h"

namespace channels {

base::Result<std::vector<ros::TransformStamped>> static_models_of(std::uint32_t server_id) {
  auto requester = shm::Requester::open(server_id);
  if (!requester) return requester.error();
  const auto reply = requester->ask(shm::ListRequest{}, std::chrono::seconds(3));
  if (!reply) return reply.error();
  const auto list = nlohmann::json::parse(reply->text, nullptr, false);
  std::vector<ros::TransformStamped> transforms;
  if (!list.is_object()) return transforms;
  for (const auto& model : list.value("models", nlohmann::json::array())) {
    if (!model.value("static", false)) continue;
    const auto p = model.value("pose", std::vector<double>());
    if (p.size() != 7) continue;
    transforms.push_back(transform_of({}, world_frame, model.value("name", ""), {p[0], p[1], p[2], p[3], p[4], p[5], p[6]}));
  }
  return transforms;
}

}  // namespace channels
