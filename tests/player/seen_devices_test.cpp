// What fiducial and blobfinder make of what is seen, and their bytes.
#include "seen_devices.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "protocol/payloads.h"
#include "protocol/xdr.h"

namespace gateway {
namespace {

constexpr std::size_t width = 40, height = 30;

struct Picture {
  std::vector<std::uint8_t> rgb = std::vector<std::uint8_t>(3 * width * height, 128);  // grey
  void fill(std::size_t left, std::size_t top, std::size_t right, std::size_t bottom, std::array<std::uint8_t, 3> color) {
    for (std::size_t y = top; y <= bottom; ++y) {
      for (std::size_t x = left; x <= right; ++x) std::ranges::copy(color, &rgb[3 * (y * width + x)]);
    }
  }
};

TEST(Blobfinder, finds_connected_regions_of_one_colour_the_largest_first) {
  Picture picture;
  picture.fill(2, 3, 6, 7, {200, 20, 30});
  picture.fill(20, 10, 29, 19, {20, 40, 220});
  picture.fill(35, 2, 36, 3, {250, 0, 0});  // too small
  const auto blobs = color_blobs(picture.rgb, width, height);
  ASSERT_EQ(blobs.size(), 2U);
  EXPECT_EQ(blobs[0].color, 0x0000ffU);
  EXPECT_EQ(blobs[0].area, 100U);
  EXPECT_EQ(blobs[0].left, 20U);
  EXPECT_EQ(blobs[0].bottom, 19U);
  EXPECT_EQ(blobs[1].id, 0U);
  EXPECT_EQ(blobs[1].color, 0xff0000U);
  EXPECT_EQ(blobs[1].x, 4U);
  EXPECT_EQ(blobs[1].y, 5U);
}

TEST(Blobfinder, a_region_that_winds_is_one_and_touching_colours_are_two) {
  Picture picture;
  picture.fill(5, 5, 7, 20, {10, 200, 10});
  picture.fill(15, 5, 17, 20, {10, 200, 10});
  picture.fill(5, 18, 17, 20, {10, 200, 10});  // joins both below
  picture.fill(18, 5, 25, 20, {220, 220, 10});
  const auto blobs = color_blobs(picture.rgb, width, height);
  ASSERT_EQ(blobs.size(), 2U);
  EXPECT_EQ(blobs[0].color, 0xffff00U);
  EXPECT_EQ(blobs[1].color, 0x00ff00U);
  EXPECT_EQ(blobs[1].left, 5U);
  EXPECT_EQ(blobs[1].right, 17U);
}

TEST(Blobfinder, an_image_without_colours_has_none) {
  EXPECT_TRUE(color_blobs(Picture().rgb, width, height).empty());
  EXPECT_TRUE(color_blobs({}, 0, 0).empty());
}

TEST(Fiducial, bytes_are_id_pose_and_uncertainty_of_each_mark) {
  const auto payload = player::encode_fiducials({{7, {1, 2, 3, 0, 0, 0.5}, {0.1, 0.1, 0.1, 0, 0, 0}}});
  player::XdrReader in(payload);
  EXPECT_EQ(in.count(100, 10), 1U);
  EXPECT_EQ(in.i32(), 7);
  EXPECT_EQ(in.f64(), 1);
  for (int i = 0; i < 4; ++i) in.f64();
  EXPECT_EQ(in.f64(), 0.5);
  EXPECT_EQ(in.f64(), 0.1);
  EXPECT_EQ(payload.size(), 8U + 4 + 12 * 8);
  EXPECT_EQ(player::encode_fiducials({}), std::string(8, '\0'));
}

TEST(Blobfinder, bytes_are_size_and_ten_numbers_of_each_blob) {
  const auto payload = player::encode_blobs(640, 480, {{.id = 3, .color = 0xff, .area = 20, .x = 1, .y = 2}});
  EXPECT_EQ(payload.size(), 16U + 40);
  player::XdrReader in(payload);
  EXPECT_EQ(in.u32(), 640U);
  EXPECT_EQ(in.u32(), 480U);
  EXPECT_EQ(in.count(40, 10), 1U);
  EXPECT_EQ(in.u32(), 3U);
  EXPECT_EQ(in.u32(), 0xffU);
  EXPECT_EQ(in.u32(), 20U);
}

}  // namespace
}  // namespace gateway
