#include <algorithm>
#include <cmath>

#include "rays/ray_scene.h"

namespace sim {

Beams::Beams(std::span<const Eigen::Vector3f> directions, float near, float far) : size_(directions.size()), far_(far) {
  const std::size_t padded = (size_ + 15) / 16 * 16;
  x_.assign(padded, 1);
  y_.assign(padded, 0);
  z_.assign(padded, 0);
  near_.assign(padded, near);
  for (std::size_t i = 0; i < size_; ++i) {
    x_[i] = directions[i].x(), y_[i] = directions[i].y(), z_[i] = directions[i].z();
    low_ = low_.cwiseMin(directions[i]);
    high_ = high_.cwiseMax(directions[i]);
  }
  for (std::size_t first = 0; first < size_; first += 16) {
    const auto packet = directions.subspan(first, std::min<std::size_t>(16, size_ - first));
    Cone cone;
    for (const auto& direction : packet) cone.axis += direction.normalized();
    cone.axis = cone.axis.norm() > 1e-3F ? cone.axis.normalized().eval() : packet[0].normalized().eval();
    float cosine = 1;
    for (const auto& direction : packet) cosine = std::min(cosine, cone.axis.dot(direction.normalized()));
    cone.cosine = std::clamp(cosine, -1.0F, 1.0F);
    cone.sine = std::sqrt(1 - cone.cosine * cone.cosine);
    cones_.push_back(cone);
  }
}

Beams Beams::fan(int beams, double from, double to, int layers, double lowest, double highest, float near, float far) {
  std::vector<Eigen::Vector3f> directions;
  directions.reserve(static_cast<std::size_t>(beams) * static_cast<std::size_t>(layers));
  for (int layer = 0; layer < layers; ++layer) {
    const double up = layers > 1 ? lowest + (highest - lowest) * layer / (layers - 1) : lowest;
    for (int beam = 0; beam < beams; ++beam) {
      const double angle = beams > 1 ? from + (to - from) * beam / (beams - 1) : (from + to) / 2;
      directions.emplace_back(static_cast<float>(std::cos(up) * std::cos(angle)), static_cast<float>(std::cos(up) * std::sin(angle)),
                              static_cast<float>(std::sin(up)));
    }
  }
  return Beams(directions, near, far);
}

}  // namespace sim
