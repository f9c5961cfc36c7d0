#include "stereo_device.h"

#include <utility>

#include "base/log.h"
#include "camera_device.h"
#include "disparity.h"

namespace gateway {

namespace {
base::Result<StereoPair> pair_of(const shm::Iface& left, const shm::Iface& right) {
  auto pair = stereo_pair(left.info<shm::CameraInfo>(), right.info<shm::CameraInfo>());
  if (!pair) return base::Error{"stereo of " + left.name() + " and " + right.name() + ": " + pair.error().message};
  return pair;
}
}  // namespace

base::Result<void> Stereo::check() const {
  if (!companion()) return base::Error{"stereo of " + iface().name() + ": the other camera is missing"};
  if (auto pair = pair_of(iface(), companion()->iface()); !pair) return pair.error();
  return {};
}

void Stereo::show_sample() {
  constexpr std::size_t room = player::max_message - 256, of_a_point = 24;  // [byte]
  if (!companion()) return;
  const auto pair = pair_of(iface(), companion()->iface());
  if (!pair) return;
  const auto left = iface().hold(), right = companion()->iface().hold();
  if (!left || !right || left->head().stamp.valid == 0 || right->head().stamp.valid == 0) return;
  const auto& stamp = left->head().stamp;
  if (stamp.sim_time_ns != right->head().stamp.sim_time_ns) return;  // the other one comes yet
  if (!is_for_newcomer() && shown_ == stamp.sequence) return;
  shown_ = stamp.sequence;
  const auto first = to_image(left->head(), left->data()), second = to_image(right->head(), right->data());
  if (const std::size_t size = first && second ? first->pixels.size() + second->pixels.size() : room + 1; size <= room) {
    const Disparities disparities = disparities_of(*first, *second);
    player::Image disparity = to_image(disparities);
    if (size + disparity.pixels.size() > room) disparity = {};
    const auto points = to_points(disparities, *pair, *first, (room - size - disparity.pixels.size()) / of_a_point);
    return publish(1, player::encode_stereo(*first, *second, disparity, points), stamp);
  }
  if (!std::exchange(has_complained_, true))
    base::log(base::Level::warn, "player-gateway", "stereo of {} and {}: the two images are no pictures of Player, or more than 8 MiB",
              iface().name(), companion()->iface().name());
}

}  // namespace gateway
