#include "base/jpeg.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <vector>

namespace {

std::vector<std::uint8_t> plain(int width, int height, std::uint8_t red, std::uint8_t green, std::uint8_t blue) {
  std::vector<std::uint8_t> rgb;
  for (int i = 0; i < width * height; ++i) rgb.insert(rgb.end(), {red, green, blue});
  return rgb;
}

TEST(Jpeg, an_image_of_one_colour_comes_back) {
  base::JpegEncoder encoder;
  const auto jpeg = encoder.encode(plain(20, 10, 200, 100, 50), 20, 10, 0, base::JpegPixels::rgb, 95);
  ASSERT_TRUE(jpeg);
  const auto image = base::decode_jpeg(*jpeg, base::JpegPixels::rgba);
  ASSERT_TRUE(image);
  EXPECT_EQ(image->width, 20);
  EXPECT_EQ(image->height, 10);
  ASSERT_EQ(image->pixels.size(), 20U * 10U * 4U);
  EXPECT_NEAR(image->pixels[0], 200, 3);
  EXPECT_NEAR(image->pixels[1], 100, 3);
  EXPECT_NEAR(image->pixels[2], 50, 3);
  EXPECT_EQ(image->pixels[3], 255);
}

TEST(Jpeg, rows_with_gaps_are_read_by_their_stride) {
  std::vector<std::uint8_t> padded;
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 16; ++x) padded.insert(padded.end(), {0, 0, 255});
    padded.insert(padded.end(), 16, 0xee);
  }
  base::JpegEncoder encoder;
  const auto jpeg = encoder.encode(padded, 16, 16, 16 * 3 + 16, base::JpegPixels::bgr, 95);
  ASSERT_TRUE(jpeg);
  const auto image = base::decode_jpeg(*jpeg, base::JpegPixels::rgb);
  ASSERT_TRUE(image);
  for (std::size_t i = 0; i + 2 < image->pixels.size(); i += 3) EXPECT_GT(image->pixels[i], 240) << "pixel " << i / 3;
}

TEST(Jpeg, sizes_that_the_pixels_do_not_have_are_refused) {
  base::JpegEncoder encoder;
  const std::vector<std::uint8_t> pixels(12);
  EXPECT_FALSE(encoder.encode(pixels, 2, 3, 0, base::JpegPixels::rgb, 90));
  EXPECT_FALSE(encoder.encode(pixels, 2, 2, 5, base::JpegPixels::rgb, 90));
  EXPECT_FALSE(encoder.encode(pixels, 0, 2, 0, base::JpegPixels::rgb, 90));
  EXPECT_FALSE(encoder.encode(pixels, 2, -1, 0, base::JpegPixels::rgb, 90));
  EXPECT_FALSE(encoder.encode(pixels, 2, 2, 0, base::JpegPixels::rgb, 0));
  EXPECT_FALSE(encoder.encode(pixels, 2, 2, 0, base::JpegPixels::rgb, 101));
  EXPECT_TRUE(encoder.encode(pixels, 2, 2, 0, base::JpegPixels::rgb, 90));
}

TEST(Jpeg, data_that_is_no_jpeg_and_images_that_are_too_large_are_refused) {
  EXPECT_FALSE(base::decode_jpeg({}, base::JpegPixels::rgb));
  EXPECT_FALSE(base::decode_jpeg(std::vector<std::uint8_t>{1, 2, 3}, base::JpegPixels::rgb));
  base::JpegEncoder encoder;
  const auto jpeg = encoder.encode(plain(40, 4, 1, 2, 3), 40, 4, 0, base::JpegPixels::rgb, 90);
  ASSERT_TRUE(jpeg);
  EXPECT_FALSE(base::decode_jpeg(*jpeg, base::JpegPixels::rgb, 39));
  EXPECT_TRUE(base::decode_jpeg(*jpeg, base::JpegPixels::rgb, 40));
}

}  // namespace
