// fiducial and blobfinder. One thread at a time.
#pragma once

#include <array>
#include <vector>

#include "device.h"

namespace gateway {

// Marks of a detector, or models of a logical camera. SET_FOV and SET_ID are rejected: the world has them.
class Fiducial final : public Device {
 public:
  using Device::Device;
  static constexpr std::array shows{shm::IfaceType::fiducial, shm::IfaceType::logical_camera};
  static constexpr std::array table = std::to_array<Served>({
      {player::Type::data, 1,
       "marks with their poses in the detector, also when there are none; of a logical camera models, numbered from 0"},
      {player::Type::request, 1, "geometry; the size of a mark is that of the first one seen"},
      {player::Type::request, 2, "field of view"},
  });

 private:
  ServedTable served() const override { return table; }
  void show_sample() override;
  std::optional<Answer> answer(std::uint8_t subtype, const std::string& payload, const Later& later) override;
  std::vector<player::FiducialItem> items();
};

// Regions of one colour in the image of a camera, or boxes around labelled objects.
class Blobfinder final : public Device {
 public:
  using Device::Device;
  static constexpr std::array shows{shm::IfaceType::camera, shm::IfaceType::boxes};
  static constexpr std::array table = std::to_array<Served>({
      {player::Type::data, 1,
       "connected regions of at least 10 pixels that are red, yellow, green, cyan, blue or magenta (id 0 to 5), the largest first; of a "
       "bounding box camera its boxes (id: the label); range 0: not known"},
  });

 private:
  ServedTable served() const override { return table; }
  void show_sample() override;
  std::optional<Answer> answer(std::uint8_t subtype, const std::string& payload, const Later& later) override;
};

// `rgb`: three bytes a pixel, without gaps.
std::vector<player::Blob> color_blobs(std::span<const std::uint8_t> rgb, std::size_t width, std::size_t height);

}  // namespace gateway
