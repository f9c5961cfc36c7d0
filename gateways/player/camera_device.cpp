#include "camera_device.h"

#include <array>
#include <cmath>
#include <cstring>
#include <utility>

#include "base/bayer.h"
#include "base/log.h"

namespace gateway {
namespace {

// Where red, green and blue are in a pixel of the frame.
struct Channels {
  std::array<std::size_t, 3> offsets;
  std::size_t size;
};

std::optional<Channels> channels_of(shm::Format format) {
  switch (format) {
    case shm::Format::rgb8:
      return Channels{{0, 1, 2}, 3};
    case shm::Format::bgr8:
      return Channels{{2, 1, 0}, 3};
    case shm::Format::rgba8:
      return Channels{{0, 1, 2}, 4};
    case shm::Format::bgra8:
      return Channels{{2, 1, 0}, 4};
    default:
      return std::nullopt;
  }
}

std::optional<base::BayerOrder> mosaic_of(shm::Format format) {
  switch (format) {
    case shm::Format::bayer_rggb8:
      return base::BayerOrder{0, 0};
    case shm::Format::bayer_bggr8:
      return base::BayerOrder{1, 1};
    case shm::Format::bayer_gbrg8:
      return base::BayerOrder{1, 0};
    case shm::Format::bayer_grbg8:
      return base::BayerOrder{0, 1};
    default:
      return std::nullopt;
  }
}

// Rows of floats [m] as bytes, the high one first.
std::string millimetres(const char* pixels, std::size_t width, std::size_t height, std::size_t stride) {
  std::string bytes;
  bytes.reserve(2 * width * height);
  for (std::size_t y = 0; y < height; ++y) {
    for (std::size_t x = 0; x < width; ++x) {
      float depth = 0;
      std::memcpy(&depth, pixels + y * stride + x * sizeof depth, sizeof depth);
      const float rounded = std::round(depth * 1000);
      const unsigned value = rounded >= 0 && rounded <= 65535 ? static_cast<unsigned>(rounded) : 0;  // false for NaN and infinity
      bytes += static_cast<char>(value >> 8);
      bytes += static_cast<char>(value & 255);
    }
  }
  return bytes;
}

}  // namespace

std::optional<player::Image> to_image(const shm::FrameHead& head, std::span<const std::byte> data) {
  const auto format = shm::shown_as(static_cast<shm::Format>(head.format));
  const std::size_t width = head.width, height = head.height, row_size = width * shm::bytes_per_pixel(format);
  if (width == 0 || height == 0 || row_size == 0 || head.stride < row_size || data.size() / head.stride < height) return std::nullopt;
  const char* pixels = reinterpret_cast<const char*>(data.data());
  player::Image image{head.width, head.height, 24, player::ImageFormat::rgb888, {}};
  if (const auto channels = channels_of(format)) {
    image.pixels.resize(3 * width * height);
    char* to = image.pixels.data();
    for (std::size_t y = 0; y < height; ++y) {
      const char* from = pixels + y * head.stride;
      for (std::size_t x = 0; x < width; ++x, from += channels->size) {
        for (const std::size_t offset : channels->offsets) *to++ = from[offset];
      }
    }
    return image;
  }
  if (format == shm::Format::mono8 || format == shm::Format::mono16) {
    image.bits = static_cast<std::uint32_t>(8 * shm::bytes_per_pixel(format));
    image.format = format == shm::Format::mono8 ? player::ImageFormat::mono8 : player::ImageFormat::mono16;
    for (std::size_t y = 0; y < height; ++y) image.pixels.append(pixels + y * head.stride, row_size);
    if (format == shm::Format::mono16) {
      for (std::size_t i = 0; i + 1 < image.pixels.size(); i += 2) std::swap(image.pixels[i], image.pixels[i + 1]);
    }
    return image;
  }
  if (format == shm::Format::depth_float) {
    image.bits = 16;
    image.format = player::ImageFormat::mono16;
    image.pixels = millimetres(pixels, width, height, head.stride);
    return image;
  }
  if (const auto order = mosaic_of(format)) {
    image.pixels.resize(3 * width * height);
    base::demosaic({reinterpret_cast<const std::uint8_t*>(pixels), data.size()}, static_cast<int>(width), static_cast<int>(height),
                   head.stride, *order, {reinterpret_cast<std::uint8_t*>(image.pixels.data()), image.pixels.size()});
    return image;
  }
  return std::nullopt;
}

void Camera::on_attach() { latest_.clear(); }

void Camera::show_sample() {
  constexpr std::size_t room = player::max_message - 64;  // for pixels
  const auto frame = iface().hold();
  if (!frame || frame->head().stamp.valid == 0) return;
  auto image = to_image(frame->head(), frame->data());
  if (image && is_jpeg_) compress(*image);
  if (!image || image->pixels.size() > room) {
    if (!std::exchange(has_complained_, true))
      base::log(base::Level::warn, "player-gateway", "camera {}: {}", iface().name(),
                image ? "its images are larger than the 8 MiB that Player can send" : "Player has no such image format");
    return;
  }
  latest_ = player::encode(*image);
  publish(1, latest_, frame->head().stamp);
}

// Colours only: clients make colours of every JPEG, in the room that the picture says.
void Camera::compress(player::Image& image) {
  if (image.format != player::ImageFormat::rgb888) return;
  const std::span<const std::uint8_t> pixels(reinterpret_cast<const std::uint8_t*>(image.pixels.data()), image.pixels.size());
  const auto file =
      encoder_.encode(pixels, static_cast<int>(image.width), static_cast<int>(image.height), 0, base::JpegPixels::rgb, quality_);
  if (!file) return;
  image.pixels.assign(reinterpret_cast<const char*>(file->data()), file->size());
  image.is_compressed = true;
}

std::optional<player::PropertyValue> Camera::property(const std::string& key) const {
  if (key == "compression") return std::int32_t{is_jpeg_};
  if (key == "quality") return std::int32_t{quality_};
  return Device::property(key);
}

bool Camera::set_property(const player::DriverProperty& property) {
  const auto* value = std::get_if<std::int32_t>(&property.value);
  if (value == nullptr) return false;
  if (property.key == "compression" && (*value == 0 || *value == 1)) return is_jpeg_ = *value == 1, true;
  if (property.key == "quality" && *value >= 1 && *value <= 100) return quality_ = *value, true;
  return false;
}

std::optional<Answer> Camera::answer(std::uint8_t subtype, const std::string&, const Later&) {
  constexpr std::uint8_t get_source = 1, get_image = 3;
  if (subtype == get_source) return ack(player::encode_camera_source("", 0));
  return subtype == get_image && is_used() && !latest_.empty() ? ack(latest_) : nack();
}

}  // namespace gateway
