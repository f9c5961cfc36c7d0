// Which cameras are a pair, and the disparities of images whose shift is known.
#include "disparity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/random.h"

namespace gateway {
namespace {

shm::CameraInfo camera_at(double x, double y, double z, double yaw = 0) {
  shm::CameraInfo info{};
  info.width = 120, info.height = 60, info.format = RTMSIM_FORMAT_RGB8;
  info.fx = info.fy = 100;
  info.cx = 60, info.cy = 30;
  info.pose = {x, y, z, std::cos(yaw / 2), 0, 0, std::sin(yaw / 2)};
  return info;
}

std::string refusal(const shm::CameraInfo& left, const shm::CameraInfo& right) {
  const auto pair = stereo_pair(left, right);
  return pair ? "a pair" : pair.error().message;
}

TEST(StereoPair, is_two_cameras_side_by_side) {
  const auto pair = stereo_pair(camera_at(1, 0.06, 2), camera_at(1, -0.06, 2));
  ASSERT_TRUE(pair);
  EXPECT_NEAR(pair->base, 0.12, 1e-12);
  EXPECT_EQ(pair->focal, 100);
  // Both turned to the left: the right one is to the right of the left one.
  EXPECT_TRUE(stereo_pair(camera_at(0, 0, 0, std::numbers::pi / 2), camera_at(0.1, 0, 0, std::numbers::pi / 2)));
}

TEST(StereoPair, refuses_cameras_that_are_none_with_what_was_expected) {
  const auto left = camera_at(0, 0, 0);
  auto large = camera_at(0, -0.1, 0);
  large.width = 640, large.height = 480;
  EXPECT_EQ(refusal(left, large), "the images have 120 x 60 and 640 x 480 pixels; expected the same size");
  auto thermal = camera_at(0, -0.1, 0);
  thermal.format = RTMSIM_FORMAT_THERMAL16;
  EXPECT_EQ(refusal(left, thermal), "the images show colours and temperatures; expected the same");
  auto grey = camera_at(0, -0.1, 0);
  grey.format = RTMSIM_FORMAT_MONO8;
  EXPECT_EQ(refusal(grey, left), "the images show grey and colours; expected the same");
  EXPECT_EQ(refusal(grey, grey).substr(0, 13), "the second is");
  auto tele = camera_at(0, -0.1, 0);
  tele.fx = 200;
  EXPECT_EQ(refusal(left, tele), "the focal lengths are 100 and 200 pixels; expected the same");
  EXPECT_EQ(refusal(left, camera_at(0, -0.1, 0, 0.1)), "they look 5.7 degrees apart; expected the same way");
  for (const auto& right : {camera_at(0, 0, 0), camera_at(0, 0.1, 0), camera_at(0.05, -0.1, 0), camera_at(0, -0.1, 0.05)})
    EXPECT_NE(refusal(left, right).find("expected it to the right"), std::string::npos) << refusal(left, right);
}

// Grey noise, and the same as seen from `shift` pixels to the right.
struct ShiftedNoise {
  player::Image left, right;
  explicit ShiftedNoise(int shift, std::uint32_t width = 120, std::uint32_t height = 60) {
    left = right = {width, height, 8, player::ImageFormat::mono8, {}};
    const auto grey = [](std::uint64_t x, std::uint64_t y) { return static_cast<char>(base::mix64(x * 7919 + y * 104729) & 255); };
    for (std::uint32_t y = 0; y < height; ++y) {
      for (std::uint32_t x = 0; x < width; ++x) {
        left.pixels += grey(x, y);
        right.pixels += grey(x + static_cast<std::uint64_t>(shift), y);
      }
    }
  }
};

TEST(Disparities, are_the_shift_between_the_images_and_points_lie_at_its_depth) {
  const ShiftedNoise seen(10);
  const Disparities found = disparities_of(seen.left, seen.right);
  ASSERT_EQ(found.width, 120U);
  ASSERT_EQ(found.step, 1U);
  EXPECT_EQ(found.sixteenths[30 * 120 + 60], 160);
  std::size_t count = 0;
  for (const std::uint16_t value : found.sixteenths) {
    if (value == 0) continue;
    EXPECT_NEAR(value, 160, 1);
    ++count;
  }
  EXPECT_GT(count, 4000U);
  const auto image = to_image(found);
  EXPECT_EQ(image.pixels.size(), 2U * 120 * 60);
  const auto points = to_points(found, {100, 60, 30, 0.2}, seen.left, 5000);
  ASSERT_EQ(points.size(), std::min<std::size_t>(count, 5000));
  for (const auto& point : points) EXPECT_NEAR(point.at.x, 2, 0.02) << "100 pixels x 0.2 m / 10 pixels";
  EXPECT_EQ(to_points(found, {100, 60, 30, 0.2}, seen.left, 7).size(), 7U);
}

TEST(Disparities, are_none_where_all_looks_alike_or_images_are_none) {
  player::Image plain{120, 60, 8, player::ImageFormat::mono8, std::string(120 * 60, 'x')};
  for (const std::uint16_t value : disparities_of(plain, plain).sixteenths) EXPECT_EQ(value, 0);
  player::Image other = plain;
  other.width = 60;
  EXPECT_TRUE(disparities_of(plain, other).sixteenths.empty());
  other = plain;
  other.pixels.resize(10);
  EXPECT_TRUE(disparities_of(plain, other).sixteenths.empty());
  EXPECT_TRUE(disparities_of({}, {}).sixteenths.empty());
  player::Image tiny{3, 2, 8, player::ImageFormat::mono8, "abcdef"};
  for (const std::uint16_t value : disparities_of(tiny, tiny).sixteenths) EXPECT_EQ(value, 0);
}

TEST(Disparities, of_large_images_are_those_of_every_nth_pixel) {
  const ShiftedNoise seen(20, 800, 60);
  const Disparities found = disparities_of(seen.left, seen.right);
  EXPECT_EQ(found.step, 2U);
  EXPECT_EQ(found.width, 400U);
  EXPECT_EQ(found.sixteenths[15 * 400 + 200], 160);
  const auto points = to_points(found, {200, 400, 30, 0.1}, seen.left, 100000);
  ASSERT_FALSE(points.empty());
  for (const auto& point : points) EXPECT_NEAR(point.at.x, 1, 0.01);
}

}  // namespace
}  // namespace gateway
