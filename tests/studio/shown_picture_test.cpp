// Pictures that rtm-studio shows: cameras and messages of all forms as JPEG.
#include "studio/shown_picture.h"

#include <gtest/gtest.h>

#include "base/jpeg.h"
#include "ros/messages.h"

namespace {

bool is_jpeg(const base::Result<std::string>& jpeg) { return jpeg && jpeg->starts_with("\xff\xd8\xff"); }

TEST(ShownPicture, each_form_of_a_camera_becomes_a_jpeg) {
  base::JpegEncoder encoder;
  for (const std::string_view encoding :
       {"rgb8", "bgr8", "rgba8", "bgra8", "mono8", "mono16", "32FC1", "bayer_rggb8", "bayer_bggr8", "bayer_gbrg8", "bayer_grbg8"}) {
    const std::string data(7 * 4 * 5, '\x3f');
    EXPECT_TRUE(is_jpeg(studio::jpeg_of({7, 5, 7 * 4, encoding, data}, encoder))) << encoding;
    EXPECT_TRUE(is_jpeg(studio::jpeg_of({1, 1, 4, encoding, data}, encoder))) << encoding;
    EXPECT_FALSE(studio::jpeg_of({7, 6, 7 * 4, encoding, data}, encoder).ok()) << encoding;
    EXPECT_FALSE(studio::jpeg_of({7, 5, 6, encoding, data}, encoder).ok()) << encoding;
    EXPECT_FALSE(studio::jpeg_of({0, 5, 28, encoding, data}, encoder).ok()) << encoding;
    EXPECT_FALSE(studio::jpeg_of({0xffffffff, 0xffffffff, 0xffffffff, encoding, data}, encoder).ok()) << encoding;
  }
  EXPECT_FALSE(studio::jpeg_of({1, 1, 4, "points", "1234"}, encoder).ok());
}

TEST(ShownPicture, a_mosaic_of_red_pixels_is_red) {
  std::string data(16 * 16, '\0');
  for (std::size_t y = 0; y < 16; y += 2) {
    for (std::size_t x = 0; x < 16; x += 2) data[y * 16 + x] = '\xff';
  }
  base::JpegEncoder encoder;
  const auto jpeg = studio::jpeg_of({16, 16, 16, "bayer_rggb8", data}, encoder);
  ASSERT_TRUE(is_jpeg(jpeg));
  const auto image = base::decode_jpeg({reinterpret_cast<const std::uint8_t*>(jpeg->data()), jpeg->size()}, base::JpegPixels::rgb);
  ASSERT_TRUE(image);
  const std::size_t middle = 3 * (8 * 16 + 8);
  EXPECT_GT(image->pixels[middle], 200);
  EXPECT_LT(image->pixels[middle + 1], 60);
  EXPECT_LT(image->pixels[middle + 2], 60);
}

TEST(ShownPicture, a_camera_is_named_with_its_type_or_without) {
  EXPECT_EQ(studio::camera_name("depth:rig::eyes").types, (std::vector<std::string>{"depth"}));
  EXPECT_EQ(studio::camera_name("depth:rig::eyes").iface, "rig::eyes");
  EXPECT_EQ(studio::camera_name("depth::eyes").types, (std::vector<std::string>{"camera", "depth"}));
  EXPECT_EQ(studio::camera_name("depth::eyes").iface, "depth::eyes");
}

TEST(ShownPicture, messages_are_read_and_damaged_ones_refused) {
  const std::string pixels(2 * 2 * 3, 'x');
  ros::Image image;
  image.height = image.width = 2;
  image.encoding = "rgb8";
  image.step = 6;
  image.data = {reinterpret_cast<const std::uint8_t*>(pixels.data()), pixels.size()};
  const auto octets = ros::encode(image);
  const std::string_view whole(octets.data(), octets.size());
  const auto jpeg = studio::jpeg_in_message("sensor_msgs/msg/Image", whole);
  ASSERT_TRUE(is_jpeg(jpeg));
  for (std::size_t length = 0; length < whole.size(); ++length)
    EXPECT_FALSE(studio::jpeg_in_message("sensor_msgs/msg/Image", whole.substr(0, length)).ok()) << length;
  ros::CompressedImage packed_image;
  packed_image.format = "jpeg";
  packed_image.data = {reinterpret_cast<const std::uint8_t*>(jpeg->data()), jpeg->size()};
  const auto packed = ros::encode(packed_image);
  EXPECT_EQ(*studio::jpeg_in_message("sensor_msgs/msg/CompressedImage", {packed.data(), packed.size()}), *jpeg);
  EXPECT_FALSE(studio::jpeg_in_message("RTC::CameraImage", whole).ok());
}

}  // namespace
