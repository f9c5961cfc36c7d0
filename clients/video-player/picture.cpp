#include "picture.h"

#include <coil/stringutil.h>
#include <png.h>
#include <turbojpeg.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <memory>

namespace video {
namespace {

constexpr int largest_side = 16384;          // [pixel]
constexpr std::size_t max_pixels = 1 << 26;  // a JPEG of few octets can claim any size

enum class Kind { colors, depth, bayer, wide_grey };

// A peer's text may be of any length.
std::string quoted_format(const RTC::CameraImage& image) { return quoted(std::string_view(image.format.in()).substr(0, 40)); }

struct Layout {
  std::size_t octets;                // of a pixel
  int red = 0, green = 0, blue = 0;  // offsets in it
  Kind kind = Kind::colors;
  std::size_t red_row = 0, red_column = 0;  // of a Bayer mosaic: 0 or 1; blue is diagonally beside it, green everywhere else
};

Layout mosaic(std::size_t red_row, std::size_t red_column) { return {1, 0, 0, 0, Kind::bayer, red_row, red_column}; }

// By the bits of a pixel; 0 bits: by the octets that came.
std::optional<Layout> nameless_layout(const RTC::CameraImage& image, bool is_bgr) {
  const std::size_t count = static_cast<std::size_t>(image.width) * image.height;
  const std::size_t octets = image.bpp > 0 ? image.bpp / 8U : count > 0 ? image.pixels.length() / count : 0;
  if (octets == 3) return is_bgr ? Layout{3, 2, 1, 0} : Layout{3, 0, 1, 2};
  if (octets == 4) return is_bgr ? Layout{4, 2, 1, 0} : Layout{4, 0, 1, 2};
  if (octets == 1) return Layout{1};
  return std::nullopt;
}

std::optional<Layout> layout_of(const RTC::CameraImage& image) {
  const auto format = coil::toLower(std::string(image.format.in()));
  const auto is = [&](std::initializer_list<const char*> names) { return std::find(names.begin(), names.end(), format) != names.end(); };
  if (is({"rgb8", "rgb", "r8g8b8", "rgb888"})) return Layout{3, 0, 1, 2};
  if (is({"bgr8", "bgr", "b8g8r8", "bgr888"})) return Layout{3, 2, 1, 0};
  if (is({"rgba8", "rgba", "rgb32"})) return Layout{4, 0, 1, 2};
  if (is({"bgra8", "bgra"})) return Layout{4, 2, 1, 0};
  if (is({"mono8", "mono", "gray", "grey", "gray8", "grey8", "l8", "y8"})) return Layout{1};
  if (is({"mono16", "gray16", "grey16", "l16", "y16"})) return Layout{2, 1, 1, 1, Kind::wide_grey};
  if (is({"depth32f"})) return Layout{4, 0, 0, 0, Kind::depth};
  if (is({"bayer_rggb8", "bayer_rggb"})) return mosaic(0, 0);
  if (is({"bayer_grbg8", "bayer_grbg"})) return mosaic(0, 1);
  if (is({"bayer_gbrg8", "bayer_gbrg"})) return mosaic(1, 0);
  if (is({"bayer_bggr8", "bayer_bggr"})) return mosaic(1, 1);
  // Components with OpenCV inside send its memory, blue first, as "bitmap".
  if (format.empty() || format == "bitmap") return nameless_layout(image, !format.empty());
  return std::nullopt;
}

std::optional<Picture> from_jpeg(const RTC::CameraImage& image, std::string& problem) {
  const std::unique_ptr<void, int (*)(void*)> decoder(tjInitDecompress(), tjDestroy);
  Picture picture;
  int sampling = 0;
  int colours = 0;
  const auto size = image.pixels.length();
  const auto* bytes = image.pixels.get_buffer();
  if (!decoder || size == 0 || tjDecompressHeader3(decoder.get(), bytes, size, &picture.width, &picture.height, &sampling, &colours) != 0) {
    problem = "image of " + std::to_string(size) + " bytes is not a JPEG image";
    return std::nullopt;
  }
  const std::size_t pixels = static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height);
  if (picture.width > largest_side || picture.height > largest_side || pixels > max_pixels) {
    problem = "JPEG image of " + std::to_string(picture.width) + "x" + std::to_string(picture.height) + " is too large";
    return std::nullopt;
  }
  picture.rgb.resize(3 * pixels);
  if (tjDecompress2(decoder.get(), bytes, size, picture.rgb.data(), picture.width, 0, picture.height, TJPF_RGB, 0) != 0 &&
      tjGetErrorCode(decoder.get()) == TJERR_FATAL) {
    problem = std::string("JPEG image: ") + tjGetErrorStr2(decoder.get());
    return std::nullopt;
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

// Each colour that a pixel does not have is the mean of its neighbours that do.
void mosaic_to_rgb(const unsigned char* mosaic, const Layout& layout, Picture& picture) {
  const auto columns = static_cast<std::size_t>(picture.width), rows = static_cast<std::size_t>(picture.height);
  const auto color_at = [&](std::size_t row, std::size_t column) -> std::size_t {
    const bool in_red_row = row % 2 == layout.red_row, in_red_column = column % 2 == layout.red_column;
    return in_red_row != in_red_column ? 1 : in_red_row ? 0 : 2;
  };
  unsigned char* pixel = picture.rgb.data();
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t column = 0; column < columns; ++column, pixel += 3) {
      std::array<unsigned, 3> sum{}, count{};
      for (std::size_t y = row - (row > 0 ? 1 : 0); y <= std::min(row + 1, rows - 1); ++y) {
        for (std::size_t x = column - (column > 0 ? 1 : 0); x <= std::min(column + 1, columns - 1); ++x) {
          const std::size_t color = color_at(y, x);
          sum[color] += mosaic[y * columns + x];
          ++count[color];
        }
      }
      for (std::size_t c = 0; c < 3; ++c) pixel[c] = static_cast<unsigned char>(count[c] > 0 ? (sum[c] + count[c] / 2) / count[c] : 0);
      pixel[color_at(row, column)] = mosaic[row * columns + column];
    }
  }
}

void colors_to_rgb(const unsigned char* from, const Layout& layout, Picture& picture) {
  if (layout.octets == 3 && layout.red == 0) {
    std::memcpy(picture.rgb.data(), from, picture.rgb.size());
    return;
  }
  unsigned char* to = picture.rgb.data();
  for (std::size_t i = 0; i < picture.rgb.size() / 3; ++i, from += layout.octets, to += 3) {
    to[0] = from[layout.red];
    to[1] = from[layout.green];
    to[2] = from[layout.blue];
  }
}

// Why the image cannot be shown; empty: it can.
std::string problem_of(const RTC::CameraImage& image, const std::optional<Layout>& layout) {
  if (!layout) {
    return "image format " + quoted_format(image) + " with " + std::to_string(image.bpp) +
           " bits per pixel is not known, expected RGB8, BGR8, RGBA8, BGRA8, MONO8, MONO16, BAYER_RGGB8 and its like, DEPTH32F or JPEG";
  }
  const std::size_t count = static_cast<std::size_t>(image.width) * image.height;
  const auto size = std::to_string(image.width) + "x" + std::to_string(image.height);
  if (count == 0 || image.width > largest_side || image.height > largest_side) return "image of " + size + " pixels cannot be shown";
  if (image.pixels.length() == count * layout->octets) return {};
  return "image of " + size + " pixels in format " + quoted_format(image) + " must have " + std::to_string(count * layout->octets) +
         " bytes, got " + std::to_string(image.pixels.length());
}

}  // namespace

std::optional<Picture> to_picture(const RTC::CameraImage& image, std::string& problem) {
  const auto format = coil::toLower(std::string(image.format.in()));
  if (format == "jpeg" || format == "jpg") return from_jpeg(image, problem);
  const auto layout = layout_of(image);
  problem = problem_of(image, layout);
  if (!problem.empty()) return std::nullopt;
  Picture picture{image.width, image.height, {}};
  picture.rgb.resize(3 * static_cast<std::size_t>(image.width) * image.height);
  const auto* from = image.pixels.get_buffer();
  if (layout->kind == Kind::depth) {
    depth_to_grey(image, picture);
  } else if (layout->kind == Kind::bayer) {
    mosaic_to_rgb(from, *layout, picture);
  } else {
    colors_to_rgb(from, *layout, picture);
  }
  return picture;
}

std::string write_png(const Picture& picture, const std::string& file) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(picture.width);
  image.height = static_cast<png_uint_32>(picture.height);
  image.format = PNG_FORMAT_RGB;
  image.flags = PNG_IMAGE_FLAG_FAST;  // every frame of a stream is written: three times the speed for a tenth more bytes
  if (png_image_write_to_file(&image, file.c_str(), 0, picture.rgb.data(), 0, nullptr) != 0) return {};
  return "file " + quoted(file) + ": " + image.message;
}

std::string quoted(std::string_view text) {
  std::string line(text);
  std::replace_if(
      line.begin(), line.end(), [](unsigned char c) { return c < 0x20 || c >= 0x7f; }, '?');
  return '"' + line + '"';
}

}  // namespace video
