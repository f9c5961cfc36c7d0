// Frames of camera ifaces as images of ports and as JPEG; mosaics as colours.
#include "camera_image.h"

#include <base/bayer.h>
#include <gtest/gtest.h>
#include <turbojpeg.h>

#include <algorithm>
#include <string>

namespace iface {
namespace {

using shm::Format;
using Bytes = std::vector<std::byte>;

Bytes bytes(std::initializer_list<int> values) {
  Bytes out;
  for (const int value : values) out.push_back(static_cast<std::byte>(value));
  return out;
}

shm::FrameHead head_of(Format format, std::uint32_t width, std::uint32_t height) {
  shm::FrameHead head{};
  head.format = static_cast<std::uint32_t>(format);
  head.width = width;
  head.height = height;
  head.stride = width * shm::bytes_per_pixel(format);
  return head;
}

TEST(CameraImage, every_format_has_a_name_and_bits_and_a_place_in_img) {
  struct Case {
    Format format;
    std::string name;
    int bits;
    Img::ColorFormat img;
  };
  for (const auto& c : {Case{Format::rgb8, "RGB8", 24, Img::CF_RGB}, Case{Format::bgr8, "BGR8", 24, Img::CF_RGB},
                        Case{Format::rgba8, "RGBA8", 32, Img::RGBA}, Case{Format::bgra8, "BGRA8", 32, Img::RGBA},
                        Case{Format::mono8, "MONO8", 8, Img::CF_GRAY}, Case{Format::mono16, "MONO16", 16, Img::Y16},
                        Case{Format::bayer_rggb8, "BAYER_RGGB8", 8, Img::RAW}, Case{Format::bayer_bggr8, "BAYER_BGGR8", 8, Img::RAW},
                        Case{Format::bayer_gbrg8, "BAYER_GBRG8", 8, Img::RAW}, Case{Format::bayer_grbg8, "BAYER_GRBG8", 8, Img::RAW}}) {
    const auto got = image_format(c.format);
    EXPECT_EQ(got.name, c.name);
    EXPECT_EQ(got.bits, c.bits) << c.name;
    EXPECT_EQ(got.bits, 8U * shm::bytes_per_pixel(c.format)) << c.name;
    EXPECT_EQ(got.img, c.img) << c.name;
  }
  EXPECT_EQ(image_format(Format::depth_float).img, Img::CF_UNKNOWN);
}

TEST(CameraImage, img_gets_red_first) {
  Bytes scratch;
  const auto bgr = bytes({3, 2, 1, 6, 5, 4}), wanted = bytes({1, 2, 3, 4, 5, 6});
  EXPECT_TRUE(std::ranges::equal(for_img(Format::bgr8, bgr, scratch), wanted));
  EXPECT_TRUE(std::ranges::equal(for_img(Format::bgra8, bytes({3, 2, 1, 255}), scratch), bytes({1, 2, 3, 255})));
  const auto grey = bytes({7, 8});
  EXPECT_EQ(for_img(Format::mono8, grey, scratch).data(), grey.data()) << "no copy";
}

TEST(CameraImage, padded_rows_are_packed_and_others_are_not_copied) {
  Bytes scratch;
  auto head = head_of(Format::mono8, 3, 2);
  const auto whole = bytes({1, 2, 3, 4, 5, 6});
  EXPECT_EQ(packed(head, whole, scratch).data(), whole.data());
  head.stride = 4;
  const auto padded = bytes({1, 2, 3, 0, 4, 5, 6, 0});
  EXPECT_TRUE(std::ranges::equal(packed(head, padded, scratch), whole));
}

// A JPEG as RGB.
std::vector<unsigned char> decoded(std::span<const unsigned char> jpeg, int& width, int& height) {
  void* handle = tjInitDecompress();
  int sampling = 0, colors = 0;
  EXPECT_EQ(tjDecompressHeader3(handle, jpeg.data(), jpeg.size(), &width, &height, &sampling, &colors), 0);
  std::vector<unsigned char> rgb(static_cast<std::size_t>(width * height) * 3);
  EXPECT_EQ(tjDecompress2(handle, jpeg.data(), jpeg.size(), rgb.data(), width, 0, height, TJPF_RGB, 0), 0);
  tjDestroy(handle);
  return rgb;
}

// A soft gradient in the format: red grows to the right, green downwards.
Bytes gradient(Format format, std::uint32_t width, std::uint32_t height, std::vector<int>& rgb) {
  Bytes out;
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) {
      const int r = 60 + static_cast<int>(x), g = 80 + static_cast<int>(y), b = 100;
      const int grey = (299 * r + 587 * g + 114 * b + 500) / 1000;
      const std::string name = image_format(format).name;
      const auto put = [&](std::initializer_list<int> values) {
        for (const int v : values) out.push_back(static_cast<std::byte>(v));
      };
      const bool is_grey = name.starts_with("MONO");
      for (const int v : is_grey ? std::array{grey, grey, grey} : std::array{r, g, b}) rgb.push_back(v);
      if (name == "RGB8") put({r, g, b});
      if (name == "BGR8") put({b, g, r});
      if (name == "RGBA8") put({r, g, b, 255});
      if (name == "BGRA8") put({b, g, r, 255});
      if (name == "MONO8") put({grey});
      if (name == "MONO16") put({0, grey});
      if (name.starts_with("BAYER_")) {
        const char color = name[6 + 2 * (y % 2) + x % 2];
        put({color == 'R' ? r : color == 'G' ? g : b});
      }
    }
  }
  return out;
}

TEST(CameraImage, jpeg_of_every_format_decodes_near_the_frame) {
  for (const auto format : {Format::rgb8, Format::bgr8, Format::rgba8, Format::bgra8, Format::mono8, Format::mono16, Format::bayer_rggb8,
                            Format::bayer_bggr8, Format::bayer_gbrg8, Format::bayer_grbg8}) {
    const auto head = head_of(format, 64, 48);
    std::vector<int> wanted;
    const auto pixels = gradient(format, 64, 48, wanted);
    base::JpegEncoder encoder;
    Bytes scratch;
    const auto jpeg = to_jpeg(encoder, head, pixels, 95, scratch);
    ASSERT_TRUE(jpeg) << image_format(format).name;
    int width = 0, height = 0;
    const auto rgb = decoded(*jpeg, width, height);
    ASSERT_EQ(width, 64);
    ASSERT_EQ(height, 48);
    int farthest = 0;
    for (std::size_t i = 0; i < rgb.size(); ++i) farthest = std::max(farthest, std::abs(rgb[i] - wanted[i]));
    EXPECT_LE(farthest, 8) << image_format(format).name;
  }
}

TEST(CameraImage, what_jpeg_cannot_encode_is_refused_with_a_line) {
  base::JpegEncoder encoder;
  Bytes scratch;
  EXPECT_FALSE(to_jpeg(encoder, head_of(Format::depth_float, 2, 2), Bytes(16), 90, scratch));
  EXPECT_FALSE(to_jpeg(encoder, head_of(Format::rgb8, 4, 4), Bytes(5), 90, scratch));
  EXPECT_FALSE(to_jpeg(encoder, head_of(Format::bayer_bggr8, 4, 4), Bytes(5), 90, scratch));
  EXPECT_FALSE(to_jpeg(encoder, head_of(Format::mono16, 4, 4), Bytes(5), 90, scratch));
  const auto bad = to_jpeg(encoder, head_of(Format::rgb8, 2, 2), Bytes(12), 0, scratch);
  ASSERT_FALSE(bad);
  EXPECT_NE(bad.error().message.find("quality"), std::string::npos);
}

TEST(Bayer, a_mosaic_of_one_colour_is_that_colour_everywhere) {
  for (const char* order : {"rggb", "bggr", "gbrg", "grbg"}) {
    std::vector<std::uint8_t> mosaic;
    for (std::size_t y = 0; y < 5; ++y) {
      for (std::size_t x = 0; x < 7; ++x) {
        const char color = order[2 * (y % 2) + x % 2];
        mosaic.push_back(color == 'r' ? 200 : color == 'g' ? 120 : 40);
      }
    }
    std::vector<std::uint8_t> rgb(5 * 7 * 3);
    base::demosaic(mosaic, 7, 5, 7, base::parse_bayer_order(order).value(), rgb);
    for (std::size_t i = 0; i < rgb.size(); ++i) ASSERT_EQ(rgb[i], i % 3 == 0 ? 200 : i % 3 == 1 ? 120 : 40) << order << " " << i;
  }
  EXPECT_FALSE(base::parse_bayer_order("rgbg"));
}

}  // namespace
}  // namespace iface
