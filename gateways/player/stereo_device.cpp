#include "stereo_device.h"

#include <utility>

#include "base/log.h"
#include "camera_device.h"

namespace gateway {

void Stereo::show_sample() {
  constexpr std::size_t room = player::max_message - 256;
  if (!companion()) return;
  const auto left = iface().hold(), right = companion()->iface().hold();
  if (!left || !right || left->head().stamp.valid == 0 || right->head().stamp.valid == 0) return;
  const auto& stamp = left->head().stamp;
  if (stamp.sim_time_ns != right->head().stamp.sim_time_ns) return;  // the other one comes yet
  if (!is_for_newcomer() && shown_ == stamp.sequence) return;
  shown_ = stamp.sequence;
  const auto first = to_image(left->head(), left->data()), second = to_image(right->head(), right->data());
  if (first && second && first->pixels.size() + second->pixels.size() <= room)
    return publish(1, player::encode_stereo(*first, *second), stamp);
  if (!std::exchange(has_complained_, true))
    base::log(base::Level::warn, "player-gateway", "stereo of {} and {}: the two images are no pictures of Player, or more than 8 MiB",
              iface().name(), companion()->iface().name());
}

}  // namespace gateway
