#include "recording/picture_export.h"

#include <png.h>

#include <array>
#include <cstdint>
#include <map>

#include "base/base64.h"
#include "base/jpeg.h"
#include "base/text.h"

namespace recorder {

namespace {

constexpr std::uint64_t max_pixels = std::uint64_t{1} << 26;

std::uint32_t bytes_of(Picture::Kind kind) {
  switch (kind) {
    case Picture::Kind::grey:
      return 1;
    case Picture::Kind::wide_grey:
      return 2;
    case Picture::Kind::rgb:
    case Picture::Kind::bgr:
      return 3;
    default:
      return 4;
  }
}

base::Result<Picture> checked(Picture picture) {
  const auto wrong = base::Error{"a picture of " + std::to_string(picture.width) + " x " + std::to_string(picture.height) + " pixels in " +
                                 std::to_string(picture.pixels.size()) + " bytes"};
  if (picture.width == 0 || picture.height == 0 || std::uint64_t{picture.width} * picture.height > max_pixels) return wrong;
  if (picture.stride < std::size_t{bytes_of(picture.kind)} * picture.width || picture.stride > INT32_MAX) return wrong;
  if (picture.pixels.size() < picture.stride * (picture.height - 1) + std::size_t{bytes_of(picture.kind)} * picture.width) return wrong;
  return picture;
}

base::Result<Picture> from_image(const Json& sample) {
  using enum Picture::Kind;
  static const std::map<std::string, Picture::Kind> kinds = {{"rgb8", rgb},   {"bgr8", bgr},   {"rgba8", rgba},
                                                             {"bgra8", bgra}, {"mono8", grey}, {"mono16", wide_grey}};
  const auto encoding = sample.value("encoding", "");
  const auto kind = kinds.find(encoding);
  if (kind == kinds.end()) return base::Error{"its pictures are of encoding " + base::in_quotes(encoding) + ", which PNG does not have"};
  return checked({kind->second, sample.value("width", 0U), sample.value("height", 0U), sample.value("step", std::size_t{0}),
                  base::from_base64(sample.value("data", ""))});
}

base::Result<Picture> from_jpeg(const std::string& octets) {
  auto image = base::decode_jpeg({reinterpret_cast<const std::uint8_t*>(octets.data()), octets.size()}, base::JpegPixels::rgb);
  if (!image) return base::Error{"its pictures are no JPEG"};
  const auto width = static_cast<std::uint32_t>(image->width);
  return Picture{Picture::Kind::rgb, width, static_cast<std::uint32_t>(image->height), std::size_t{width} * 3,
                 std::string(image->pixels.begin(), image->pixels.end())};
}

// Of a component: JPEG, or rows of RGB or grey without gaps.
base::Result<Picture> from_component(const Json& sample) {
  const Json& image = sample.contains("data") ? sample["data"] : sample;
  const Json& content = image.contains("image") ? image["image"] : image;
  if (!content.contains("pixels") || !content["pixels"].is_array()) return base::Error{"its samples have no pixels"};
  std::string octets;
  for (const auto& one : content["pixels"]) octets += static_cast<char>(one.is_number_integer() ? one.get<std::uint64_t>() & 0xffU : 0);
  const auto format = content.value("format", "");
  if (format.find("jpeg") != std::string::npos || format.find("JPEG") != std::string::npos) return from_jpeg(octets);
  const auto bits = content.value("bpp", 0);
  if (bits != 8 && bits != 24) return base::Error{"its pictures have " + std::to_string(bits) + " bits a pixel"};
  const auto width = content.value("width", 0U);
  return checked({bits == 8 ? Picture::Kind::grey : Picture::Kind::rgb, width, content.value("height", 0U),
                  std::size_t{width} * static_cast<std::size_t>(bits) / 8, std::move(octets)});
}

}  // namespace

bool has_pictures(const std::string& type) {
  return type == "sensor_msgs/msg/Image" || type == "sensor_msgs/msg/CompressedImage" || type == "RTC::CameraImage";
}

base::Result<Picture> picture_of(const std::string& type, const Json& sample) {
  try {
    if (type == "sensor_msgs/msg/Image") return from_image(sample);
    if (type == "sensor_msgs/msg/CompressedImage") return from_jpeg(base::from_base64(sample.value("data", "")));
    return from_component(sample);
  } catch (const Json::exception&) {
    return base::Error{"its samples name the type " + base::in_quotes(type) + " and have members of other types"};
  }
}

base::Result<void> write_png(const Picture& picture, const std::string& file) {
  static constexpr std::array<png_uint_32, 6> formats = {PNG_FORMAT_GRAY, PNG_FORMAT_RGB,  PNG_FORMAT_BGR,
                                                         PNG_FORMAT_RGBA, PNG_FORMAT_BGRA, PNG_FORMAT_GRAY};
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = picture.width;
  image.height = picture.height;
  image.format = formats[static_cast<std::size_t>(picture.kind)];
  std::string narrow;
  const std::string* pixels = &picture.pixels;
  std::size_t stride = picture.stride;
  if (picture.kind == Picture::Kind::wide_grey) {  // the upper octets are what people see
    for (std::uint32_t y = 0; y < picture.height; ++y) {
      for (std::uint32_t x = 0; x < picture.width; ++x) narrow += picture.pixels[y * picture.stride + 2 * x + 1];
    }
    pixels = &narrow;
    stride = picture.width;
  }
  if (png_image_write_to_file(&image, file.c_str(), 0, pixels->data(), static_cast<png_int_32>(stride), nullptr) == 0)
    return base::Error{"file " + base::in_quotes(file) + ": " + image.message};
  return {};
}

}  // namespace recorder
