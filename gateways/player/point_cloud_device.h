// pointcloud3d: point clouds of multi-layer scanners and of depth cameras. One thread at a time.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "device.h"
#include "protocol/payloads.h"

namespace gateway {

// The places that a frame of points or of depths shows, in the sensor's frame: x forward, y left, z up [m]. What hit nothing is left out.
// When there are more than `most`, whole rows and columns of the grid are left out, as many of each. Empty for other formats and for data
// shorter than the head says.
std::vector<player::Point3d> to_points(const shm::FrameHead& head, const shm::CameraInfo& info, std::span<const std::byte> data,
                                       std::size_t most);

class PointCloud final : public Device {
 public:
  using Device::Device;
  static constexpr std::array shows{shm::IfaceType::points, shm::IfaceType::depth};
  static constexpr std::array table = std::to_array<Served>({
      {player::Type::data, 1, "points in the sensor's frame, white; what hit nothing is left out"},
  });

 private:
  ServedTable served() const override { return table; }
  void show_sample() override;
  std::optional<Answer> answer(std::uint8_t subtype, const std::string& payload, const Later& later) override;
};

}  // namespace gateway
