#include "picture.h"

#include <base/bayer.h>
#include <base/text.h>
#include <png.h>
#include <turbojpeg.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <optional>
#include <string_view>

namespace video {
namespace {

using base::Error;
using base::Result;

constexpr int largest_side = 16384;           // [pixel]
constexpr std::size_t most_pixels = 1 << 26;  // a JPEG of few octets can claim any size

enum class Kind { colors, depth, bayer, wide_grey };

// A peer's text may be of any length.
std::string quoted_format(const RTC::CameraImage& image) { return base::in_quotes(std::string_view(image.format.in()).substr(0, 40)); }

struct Layout {
  std::size_t octets;                // of a pixel
  int red = 0, green = 0, blue = 0;  // offsets in it
  Kind kind = Kind::colors;
  base::BayerOrder order = {};
};

// By the bits of a pixel; 0 bits: by the octets that came.
std::optional<Layout> nameless_layout(const RTC::CameraImage& image, bool is_bgr) {
  const std::size_t count = static_cast<std::size_t>(image.width) * image.height;
  const std::size_t octets = image.bpp > 0 ? image.bpp / 8U : count > 0 ? image.pixels.length() / count : 0;
  if (octets == 3) return is_bgr ? Layout{3, 2, 1, 0} : Layout{3, 0, 1, 2};
  if (octets == 4) return is_bgr ? Layout{4, 2, 1, 0} : Layout{4, 0, 1, 2};
  if (octets == 1) return Layout{1};
  return std::nullopt;
}

Result<Layout> layout_of(const RTC::CameraImage& image) {
  const auto format = base::to_lower(image.format.in());
  const auto is = [&](std::initializer_list<const char*> names) { return std::find(names.begin(), names.end(), format) != names.end(); };
  if (is({"rgb8", "rgb", "r8g8b8", "rgb888"})) return Layout{3, 0, 1, 2};
  if (is({"bgr8", "bgr", "b8g8r8", "bgr888"})) return Layout{3, 2, 1, 0};
  if (is({"rgba8", "rgba", "rgb32"})) return Layout{4, 0, 1, 2};
  if (is({"bgra8", "bgra"})) return Layout{4, 2, 1, 0};
  if (is({"mono8", "mono", "gray", "grey", "gray8", "grey8", "l8", "y8"})) return Layout{1};
  if (is({"mono16", "gray16", "grey16", "l16", "y16"})) return Layout{2, 1, 1, 1, Kind::wide_grey};
  if (is({"depth32f"})) return Layout{4, 0, 0, 0, Kind::depth};
  if (format.starts_with("bayer_") && format.size() >= 10 && (format.size() == 10 || format.substr(10) == "8")) {
    if (const auto order = base::parse_bayer_order(format.substr(6, 4))) return Layout{1, 0, 0, 0, Kind::bayer, *order};
  }
  // Components with OpenCV inside send its memory, blue first, as "bitmap".
  if (format.empty() || format == "bitmap") {
    if (const auto layout = nameless_layout(image, !format.empty())) return *layout;
  }
  return Error{
      "image format " + quoted_format(image) + " with " + std::to_string(image.bpp) +
      " bits per pixel is not known, expected RGB8, BGR8, RGBA8, BGRA8, MONO8, MONO16, BAYER_RGGB8 and its like, DEPTH32F or JPEG"};
}

Result<Picture> from_jpeg(const RTC::CameraImage& image) {
  const std::unique_ptr<void, int (*)(void*)> decoder(tjInitDecompress(), tjDestroy);
  Picture picture;
  int sampling = 0;
  int colours = 0;
  const auto size = image.pixels.length();
  const auto* bytes = image.pixels.get_buffer();
  if (!decoder || size == 0 || tjDecompressHeader3(decoder.get(), bytes, size, &picture.width, &picture.height, &sampling, &colours) != 0) {
    return Error{"image of " + std::to_string(size) + " bytes is not a JPEG image"};
  }
  const std::size_t pixels = static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height);
  if (picture.width > largest_side || picture.height > largest_side || pixels > most_pixels)
    return Error{"JPEG image of " + std::to_string(picture.width) + "x" + std::to_string(picture.height) + " is too large"};
  picture.rgb.resize(3 * pixels);
  if (tjDecompress2(decoder.get(), bytes, size, picture.rgb.data(), picture.width, 0, picture.height, TJPF_RGB, 0) != 0 &&
      tjGetErrorCode(decoder.get()) == TJERR_FATAL) {
    return Error{std::string("JPEG image: ") + tjGetErrorStr2(decoder.get())};
  }
  return picture;
}

void depth_to_grey(const RTC::CameraImage& image, Picture& picture) {
  const std::size_t count = picture.rgb.size() / 3;
  std::vector<float> depths(count);
  std::memcpy(depths.data(), image.pixels.get_buffer(), count * sizeof(float));
  float farthest = 0;
  for (const float depth : depths) {
    if (std::isfinite(depth)) farthest = std::max(farthest, depth);
  }
  for (std::size_t i = 0; i < count; ++i) {
    const bool is_there = std::isfinite(depths[i]) && depths[i] > 0 && farthest > 0;
    const auto grey = static_cast<unsigned char>(is_there ? 255.0F - 230.0F * depths[i] / farthest : 0.0F);
    for (std::size_t c = 0; c < 3; ++c) picture.rgb[3 * i + c] = grey;
  }
}

}  // namespace

Result<Picture> to_picture(const RTC::CameraImage& image) {
  if (base::equal_ignoring_case(image.format.in(), "jpeg") || base::equal_ignoring_case(image.format.in(), "jpg")) return from_jpeg(image);
  const auto layout = layout_of(image);
  if (!layout) return layout.error();
  Picture picture;
  picture.width = image.width;
  picture.height = image.height;
  const std::size_t count = static_cast<std::size_t>(image.width) * image.height;
  const auto wanted = count * layout->octets;
  const auto size = std::to_string(image.width) + "x" + std::to_string(image.height);
  if (count == 0 || image.width > largest_side || image.height > largest_side) return Error{"image of " + size + " pixels cannot be shown"};
  if (image.pixels.length() != wanted) {
    return Error{"image of " + size + " pixels in format " + quoted_format(image) + " must have " + std::to_string(wanted) +
                 " bytes, got " + std::to_string(image.pixels.length())};
  }
  picture.rgb.resize(3 * count);
  const auto* from = image.pixels.get_buffer();
  auto* to = picture.rgb.data();
  if (layout->kind == Kind::depth) {
    depth_to_grey(image, picture);
    return picture;
  }
  if (layout->kind == Kind::bayer) {
    base::demosaic({from, count}, picture.width, picture.height, image.width, layout->order, picture.rgb);
    return picture;
  }
  if (layout->octets == 3 && layout->red == 0) {
    std::memcpy(to, from, wanted);
    return picture;
  }
  for (std::size_t i = 0; i < count; ++i, from += layout->octets, to += 3) {
    to[0] = from[layout->red];
    to[1] = from[layout->green];
    to[2] = from[layout->blue];
  }
  return picture;
}

Result<void> write_png(const Picture& picture, const std::string& file) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(picture.width);
  image.height = static_cast<png_uint_32>(picture.height);
  image.format = PNG_FORMAT_RGB;
  image.flags = PNG_IMAGE_FLAG_FAST;  // every frame of a stream is written: three times the speed for a tenth more bytes
  if (png_image_write_to_file(&image, file.c_str(), 0, picture.rgb.data(), 0, nullptr) == 0)
    return Error{"file " + base::in_quotes(file) + ": " + image.message};
  return {};
}

}  // namespace video
