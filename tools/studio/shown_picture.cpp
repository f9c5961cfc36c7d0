#include "studio/shown_picture.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>
#include <span>

#include "base/bayer.h"
#include "base/text.h"

namespace studio {
namespace {

using base::Error;
using base::Result;

constexpr std::uint64_t max_pixels = std::uint64_t{1} << 26;
constexpr int jpeg_quality = 85;

struct Coding {
  std::optional<base::JpegPixels> pixels{};  // none: the image is converted before it is encoded
  std::size_t bytes = 1;                     // per pixel
};

const std::map<std::string_view, Coding>& codings() {
  using enum base::JpegPixels;
  static const std::map<std::string_view, Coding> all = {{"rgb8", {rgb, 3}},           {"bgr8", {bgr, 3}},   {"rgba8", {rgba, 4}},
                                                         {"bgra8", {bgra, 4}},         {"mono8", {grey, 1}}, {"mono16", {std::nullopt, 2}},
                                                         {"32FC1", {std::nullopt, 4}}, {"bayer_rggb8", {}},  {"bayer_bggr8", {}},
                                                         {"bayer_gbrg8", {}},          {"bayer_grbg8", {}}};
  return all;
}

Result<std::string> compress(base::JpegEncoder& encoder, std::span<const std::uint8_t> pixels, const RawPicture& size, std::size_t stride,
                             base::JpegPixels kind) {
  const auto jpeg = encoder.encode(pixels, static_cast<int>(size.width), static_cast<int>(size.height), stride, kind, jpeg_quality);
  if (!jpeg) return jpeg.error();
  return std::string(jpeg->begin(), jpeg->end());
}

std::vector<std::uint8_t> upper_octets(const RawPicture& picture) {
  std::vector<std::uint8_t> grey;
  grey.reserve(std::size_t{picture.width} * picture.height);
  for (std::size_t y = 0; y < picture.height; ++y) {
    for (std::size_t x = 0; x < picture.width; ++x)
      grey.push_back(static_cast<unsigned char>(picture.data[y * picture.stride + 2 * x + 1]));
  }
  return grey;
}

// What has no depth is black.
std::vector<std::uint8_t> grey_of_depth(const RawPicture& picture) {
  const auto at = [&](std::size_t x, std::size_t y) {
    float depth = 0;
    std::memcpy(&depth, picture.data.data() + y * picture.stride + 4 * x, sizeof depth);
    return std::isfinite(depth) && depth > 0 ? depth : 0;
  };
  float farthest = 0;
  for (std::size_t y = 0; y < picture.height; ++y) {
    for (std::size_t x = 0; x < picture.width; ++x) farthest = std::max(farthest, at(x, y));
  }
  constexpr float white = 255, darkest = 40;  // of what is there
  std::vector<std::uint8_t> grey;
  grey.reserve(std::size_t{picture.width} * picture.height);
  for (std::size_t y = 0; y < picture.height; ++y) {
    for (std::size_t x = 0; x < picture.width; ++x) {
      const float depth = at(x, y);
      grey.push_back(depth == 0 ? 0 : static_cast<unsigned char>(white - (white - darkest) * depth / farthest));
    }
  }
  return grey;
}

// Little-endian CDR from behind its head of four octets.
class Cdr {
 public:
  explicit Cdr(std::string_view body) : body_(body) {}

  std::optional<std::uint32_t> number() {
    at_ = (at_ + 3) & ~std::size_t{3};
    std::uint32_t value = 0;
    if (at_ + sizeof value > body_.size()) return std::nullopt;
    std::memcpy(&value, body_.data() + at_, sizeof value);
    at_ += sizeof value;
    return value;
  }
  std::optional<std::string_view> octets() {
    const auto length = number();
    if (!length || *length > body_.size() - at_) return std::nullopt;
    const auto part = body_.substr(at_, *length);
    at_ += *length;
    return part;
  }
  std::optional<std::string_view> text() {
    auto part = octets();
    if (part && part->ends_with('\0')) part->remove_suffix(1);
    return part;
  }
  bool skip(std::size_t count) { return (at_ += count) <= body_.size(); }

 private:
  std::string_view body_;
  std::size_t at_ = 0;
};

}  // namespace

CameraName camera_name(const std::string& text) {
  for (const std::string type : {"camera", "depth"}) {
    const auto name = type.size() + 1;
    if (text.starts_with(type + ":") && text.size() > name && text[name] != ':') return {{type}, text.substr(name)};
  }
  return {{"camera", "depth"}, text};
}

Result<std::string> jpeg_of(const RawPicture& picture, base::JpegEncoder& encoder) {
  const auto coding = codings().find(picture.encoding);
  if (coding == codings().end())
    return Error{"its pictures are of encoding " + base::in_quotes(std::string(picture.encoding)) + ", which is not shown"};
  const auto row = coding->second.bytes * picture.width;
  if (picture.width == 0 || picture.height == 0 || std::uint64_t{picture.width} * picture.height > max_pixels || picture.stride < row ||
      picture.stride > max_pixels * 4 || picture.data.size() < picture.stride * (picture.height - 1) + row)
    return Error{"a picture of " + std::to_string(picture.width) + " x " + std::to_string(picture.height) + " pixels in " +
                 std::to_string(picture.data.size()) + " bytes"};
  if (coding->second.pixels)
    return compress(encoder, {reinterpret_cast<const std::uint8_t*>(picture.data.data()), picture.data.size()}, picture, picture.stride,
                    *coding->second.pixels);
  const auto order = picture.encoding.starts_with("bayer_") ? base::parse_bayer_order(picture.encoding.substr(6, 4)) : std::nullopt;
  if (order) {
    std::vector<std::uint8_t> rgb(std::size_t{picture.width} * picture.height * 3);
    base::demosaic({reinterpret_cast<const std::uint8_t*>(picture.data.data()), picture.data.size()}, static_cast<int>(picture.width),
                   static_cast<int>(picture.height), picture.stride, *order, rgb);
    return compress(encoder, rgb, picture, 0, base::JpegPixels::rgb);
  }
  const auto grey = picture.encoding == "32FC1" ? grey_of_depth(picture) : upper_octets(picture);
  return compress(encoder, grey, picture, 0, base::JpegPixels::grey);
}

Result<std::string> jpeg_in_message(std::string_view type, std::string_view octets) {
  const Error cut{"a picture is cut short"};
  constexpr std::size_t head = 4, stamp = 8;
  if (octets.size() < head + stamp || octets[1] != 1) return cut;
  Cdr message(octets.substr(head));
  if (!message.skip(stamp) || !message.text()) return cut;
  if (type == "sensor_msgs/msg/CompressedImage") {
    if (!message.text()) return cut;
    const auto jpeg = message.octets();
    return jpeg ? Result<std::string>(std::string(*jpeg)) : Result<std::string>(cut);
  }
  if (type != "sensor_msgs/msg/Image") return Error{"its pictures were recorded in a form that is not shown"};
  const auto height = message.number(), width = message.number();
  const auto encoding = message.text();
  if (!height || !width || !encoding || !message.skip(1)) return cut;
  const auto step = message.number();
  const auto data = message.octets();
  if (!step || !data) return cut;
  base::JpegEncoder encoder;
  return jpeg_of({*width, *height, *step, *encoding, *data}, encoder);
}

}  // namespace studio
