#include "studio/shown_picture.h"

#include <turbojpeg.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <memory>
#include <optional>

#include "base/text.h"

namespace studio {
namespace {

using base::Error;
using base::Result;

constexpr std::uint64_t most_pixels = std::uint64_t{1} << 26;
constexpr int jpeg_quality = 85;

struct Coding {
  int turbo = -1;         // that the encoder takes as it is; -1: none
  std::size_t bytes = 1;  // a pixel
};

const std::map<std::string_view, Coding>& codings() {
  static const std::map<std::string_view, Coding> all = {{"rgb8", {TJPF_RGB, 3}},   {"bgr8", {TJPF_BGR, 3}},   {"rgba8", {TJPF_RGBX, 4}},
                                                         {"bgra8", {TJPF_BGRX, 4}}, {"mono8", {TJPF_GRAY, 1}}, {"mono16", {-1, 2}},
                                                         {"32FC1", {-1, 4}},        {"bayer_rggb8", {}},       {"bayer_bggr8", {}},
                                                         {"bayer_gbrg8", {}},       {"bayer_grbg8", {}}};
  return all;
}

Result<std::string> compress(const unsigned char* pixels, const RawPicture& size, std::size_t stride, int format) {
  const std::unique_ptr<void, int (*)(tjhandle)> handle(tjInitCompress(), tjDestroy);
  unsigned char* buffer = nullptr;
  unsigned long length = 0;
  const int code =
      !handle ? -1
              : tjCompress2(handle.get(), pixels, static_cast<int>(size.width), static_cast<int>(stride), static_cast<int>(size.height),
                            format, &buffer, &length, format == TJPF_GRAY ? TJSAMP_GRAY : TJSAMP_420, jpeg_quality, TJFLAG_FASTDCT);
  std::string jpeg;
  if (code == 0) jpeg.assign(reinterpret_cast<const char*>(buffer), length);
  if (buffer != nullptr) tjFree(buffer);
  if (code != 0) return Error{"the picture cannot be made a JPEG"};
  return jpeg;
}

std::vector<unsigned char> upper_octets(const RawPicture& picture) {
  std::vector<unsigned char> grey;
  grey.reserve(std::size_t{picture.width} * picture.height);
  for (std::size_t y = 0; y < picture.height; ++y) {
    for (std::size_t x = 0; x < picture.width; ++x)
      grey.push_back(static_cast<unsigned char>(picture.data[y * picture.stride + 2 * x + 1]));
  }
  return grey;
}

// What has no depth is black.
std::vector<unsigned char> grey_of_depth(const RawPicture& picture) {
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
  std::vector<unsigned char> grey;
  grey.reserve(std::size_t{picture.width} * picture.height);
  for (std::size_t y = 0; y < picture.height; ++y) {
    for (std::size_t x = 0; x < picture.width; ++x) {
      const float depth = at(x, y);
      grey.push_back(depth == 0 ? 0 : static_cast<unsigned char>(white - (white - darkest) * depth / farthest));
    }
  }
  return grey;
}

// `letters`: the colours of the cell of four, "rggb".
std::vector<unsigned char> colours_of_mosaic(const RawPicture& picture, std::string_view letters) {
  std::vector<unsigned char> rgb(std::size_t{picture.width} * picture.height * 3);
  for (std::size_t y = 0; y < picture.height; ++y) {
    for (std::size_t x = 0; x < picture.width; ++x) {
      // The cell that the pixel is in; at an odd border the one before.
      const std::size_t left = std::min<std::size_t>(x & ~std::size_t{1}, picture.width >= 2 ? picture.width - 2 : 0) & ~std::size_t{1};
      const std::size_t top = std::min<std::size_t>(y & ~std::size_t{1}, picture.height >= 2 ? picture.height - 2 : 0) & ~std::size_t{1};
      unsigned sums[3] = {}, counts[3] = {};
      for (std::size_t i = 0; i < 4; ++i) {
        const std::size_t px = std::min<std::size_t>(left + i % 2, picture.width - 1),
                          py = std::min<std::size_t>(top + i / 2, picture.height - 1);
        const std::size_t colour = letters[i] == 'r' ? 0 : letters[i] == 'g' ? 1 : 2;
        sums[colour] += static_cast<unsigned char>(picture.data[py * picture.stride + px]);
        ++counts[colour];
      }
      for (std::size_t colour = 0; colour < 3; ++colour)
        rgb[(y * picture.width + x) * 3 + colour] = static_cast<unsigned char>(sums[colour] / std::max(1U, counts[colour]));
    }
  }
  return rgb;
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

Result<std::string> jpeg_of(const RawPicture& picture) {
  const auto coding = codings().find(picture.encoding);
  if (coding == codings().end())
    return Error{"its pictures are of encoding " + base::in_quotes(std::string(picture.encoding)) + ", which is not shown"};
  const auto row = coding->second.bytes * picture.width;
  if (picture.width == 0 || picture.height == 0 || std::uint64_t{picture.width} * picture.height > most_pixels || picture.stride < row ||
      picture.stride > most_pixels * 4 || picture.data.size() < picture.stride * (picture.height - 1) + row)
    return Error{"a picture of " + std::to_string(picture.width) + " x " + std::to_string(picture.height) + " pixels in " +
                 std::to_string(picture.data.size()) + " octets"};
  if (coding->second.turbo >= 0)
    return compress(reinterpret_cast<const unsigned char*>(picture.data.data()), picture, picture.stride, coding->second.turbo);
  if (picture.encoding.starts_with("bayer_")) {
    const auto rgb = colours_of_mosaic(picture, picture.encoding.substr(6, 4));
    return compress(rgb.data(), picture, std::size_t{picture.width} * 3, TJPF_RGB);
  }
  const auto grey = picture.encoding == "32FC1" ? grey_of_depth(picture) : upper_octets(picture);
  return compress(grey.data(), picture, picture.width, TJPF_GRAY);
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
  return jpeg_of({*width, *height, *step, *encoding, *data});
}

}  // namespace studio
