#include "picture.h"

#include <gtest/gtest.h>

namespace video {
namespace {

RTC::CameraImage image(const char* format, int bits, std::vector<unsigned char> pixels, int width = 2, int height = 1) {
  RTC::CameraImage result;
  result.width = static_cast<CORBA::UShort>(width);
  result.height = static_cast<CORBA::UShort>(height);
  result.bpp = static_cast<CORBA::UShort>(bits);
  result.format = CORBA::string_dup(format);
  result.pixels.length(static_cast<CORBA::ULong>(pixels.size()));
  for (CORBA::ULong i = 0; i < pixels.size(); ++i) result.pixels[i] = pixels[i];
  return result;
}

std::string problem;

std::optional<Picture> to_picture(const RTC::CameraImage& image) { return video::to_picture(image, problem); }

TEST(Picture, every_order_of_colours_becomes_rgb) {
  const std::vector<unsigned char> wanted = {1, 2, 3, 4, 5, 6};
  EXPECT_EQ(to_picture(image("RGB8", 24, {1, 2, 3, 4, 5, 6}))->rgb, wanted);
  EXPECT_EQ(to_picture(image("bgr8", 24, {3, 2, 1, 6, 5, 4}))->rgb, wanted);
  EXPECT_EQ(to_picture(image("RGBA8", 32, {1, 2, 3, 9, 4, 5, 6, 9}))->rgb, wanted);
  EXPECT_EQ(to_picture(image("", 24, {1, 2, 3, 4, 5, 6}))->rgb, wanted);
  EXPECT_EQ(to_picture(image("BGRA8", 32, {3, 2, 1, 9, 6, 5, 4, 9}))->rgb, wanted);
  EXPECT_EQ(to_picture(image("", 0, {1, 2, 3, 4, 5, 6}))->rgb, wanted);
  EXPECT_EQ(to_picture(image("bitmap", 0, {3, 2, 1, 6, 5, 4}))->rgb, wanted);
  EXPECT_EQ(to_picture(image("MONO16", 16, {99, 7, 99, 8}))->rgb, (std::vector<unsigned char>{7, 7, 7, 8, 8, 8}));
  EXPECT_EQ(to_picture(image("BAYER_GRBG8", 8, {20, 10, 30, 20}, 2, 2))->rgb,
            (std::vector<unsigned char>{10, 20, 30, 10, 20, 30, 10, 20, 30, 10, 20, 30}));
  EXPECT_EQ(to_picture(image("MONO8", 8, {7, 8}))->rgb, (std::vector<unsigned char>{7, 7, 7, 8, 8, 8}));
}

TEST(Picture, near_things_are_bright_in_depth_images) {
  std::vector<unsigned char> pixels(8);
  const float depths[2] = {1, 10};
  std::copy_n(reinterpret_cast<const unsigned char*>(depths), sizeof depths, pixels.begin());
  const auto picture = to_picture(image("DEPTH32F", 32, pixels));
  ASSERT_TRUE(picture) << problem;
  EXPECT_GT(picture->rgb[0], picture->rgb[3]);
}

TEST(Picture, images_that_do_not_fit_their_size_are_refused_with_both_numbers) {
  ASSERT_FALSE(to_picture(image("RGB8", 24, {1, 2, 3})));
  EXPECT_NE(problem.find("6 bytes, got 3"), std::string::npos) << problem;
  EXPECT_FALSE(to_picture(image("RGB8", 24, {}, 0, 0)));
  EXPECT_FALSE(to_picture(image("RGB8", 24, {}, 65535, 65535)));
  EXPECT_FALSE(to_picture(image("RGB8", 24, std::vector<unsigned char>(65535 * 3), 65535, 1)));
  EXPECT_FALSE(to_picture(image("BAYER_RGBG8", 8, {1, 2})));
  EXPECT_FALSE(to_picture(image("", 0, {1, 2, 3})));
  EXPECT_FALSE(to_picture(image("", 12, {1, 2, 3})));
  EXPECT_FALSE(to_picture(image("HSV", 24, {1, 2, 3, 4, 5, 6})));
  EXPECT_FALSE(to_picture(image("JPEG", 24, {1, 2, 3, 4, 5, 6})));
  EXPECT_FALSE(to_picture(image("JPEG", 24, {})));
}

TEST(Picture, a_format_that_a_terminal_would_obey_is_shown_without_that) {
  ASSERT_FALSE(to_picture(image("\x1b[2J\n", 24, {1, 2, 3, 4, 5, 6})));
  EXPECT_NE(problem.find("image format \"?[2J?\" with 24 bits"), std::string::npos) << problem;
}

TEST(Picture, every_order_of_a_mosaic_becomes_the_same_picture) {
  // One colour everywhere: red 10, green 20, blue 30.
  const std::vector<std::pair<const char*, std::vector<unsigned char>>> mosaics = {{"BAYER_RGGB8", {10, 20, 20, 30}},
                                                                                   {"bayer_grbg", {20, 10, 30, 20}},
                                                                                   {"BAYER_GBRG8", {20, 30, 10, 20}},
                                                                                   {"BAYER_BGGR8", {30, 20, 20, 10}}};
  for (const auto& [format, pixels] : mosaics) {
    const auto picture = to_picture(image(format, 8, pixels, 2, 2));
    ASSERT_TRUE(picture) << format << ": " << problem;
    EXPECT_EQ(picture->rgb, (std::vector<unsigned char>{10, 20, 30, 10, 20, 30, 10, 20, 30, 10, 20, 30})) << format;
  }
}

}  // namespace
}  // namespace video
