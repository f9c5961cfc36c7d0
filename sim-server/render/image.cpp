// Reading and writing pictures with libpng and libjpeg-turbo.
#include "render/image.h"

#include <png.h>
#include <turbojpeg.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <memory>

#include "base/text.h"
#include "base/whole_file.h"
#include "render/dds.h"

namespace sim {
namespace {

constexpr int max_side = 16384;
constexpr std::uintmax_t most_bytes = std::uintmax_t{1} << 30;

base::Error bad(const std::string& name, const std::string& why) { return base::Error{"image " + name + ": " + why}; }

base::Result<std::vector<std::uint8_t>> read_bytes(const std::filesystem::path& file) {
  std::error_code error;
  if (std::filesystem::exists(file, error) && !std::filesystem::is_regular_file(file, error))
    return bad(file.string(), "is no ordinary file");
  std::ifstream in(file, std::ios::binary);
  if (!in) return bad(file.string(), "cannot be opened");
  const auto size = std::filesystem::file_size(file, error);
  if (error || size > most_bytes) return bad(file.string(), "a file of at most 1 GiB is expected");
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(size));
  in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (static_cast<std::uintmax_t>(in.gcount()) != size) return bad(file.string(), "cannot be read");
  return bytes;
}

bool is_png(std::span<const std::uint8_t> bytes) { return bytes.size() > 8 && png_sig_cmp(bytes.data(), 0, 8) == 0; }
bool is_jpeg(std::span<const std::uint8_t> bytes) { return bytes.size() > 3 && bytes[0] == 0xff && bytes[1] == 0xd8 && bytes[2] == 0xff; }

// A png_image is freed whatever happens.
struct PngReader {
  png_image image{};
  PngReader() { image.version = PNG_IMAGE_VERSION; }
  ~PngReader() { png_image_free(&image); }
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;
};

base::Result<Image> decode_png(std::span<const std::uint8_t> bytes, const std::string& name) {
  PngReader reader;
  if (png_image_begin_read_from_memory(&reader.image, bytes.data(), bytes.size()) == 0) return bad(name, reader.image.message);
  if (reader.image.width > max_side || reader.image.height > max_side) return bad(name, "larger than 16384 pixels a side");
  reader.image.format = PNG_FORMAT_RGBA;
  Image image{static_cast<int>(reader.image.width), static_cast<int>(reader.image.height), {}};
  image.rgba.resize(image.size_bytes());
  if (png_image_finish_read(&reader.image, nullptr, image.rgba.data(), 0, nullptr) == 0) return bad(name, reader.image.message);
  return image;
}

base::Result<Image> decode_jpeg(std::span<const std::uint8_t> bytes, const std::string& name) {
  const std::unique_ptr<void, int (*)(void*)> decoder(tjInitDecompress(), tjDestroy);
  if (!decoder) return bad(name, "no JPEG decoder");
  int width = 0;
  int height = 0;
  int sampling = 0;
  int colours = 0;
  const auto size = static_cast<unsigned long>(bytes.size());
  if (tjDecompressHeader3(decoder.get(), bytes.data(), size, &width, &height, &sampling, &colours) != 0)
    return bad(name, tjGetErrorStr2(decoder.get()));
  if (width < 1 || height < 1 || width > max_side || height > max_side) return bad(name, "larger than 16384 pixels a side");
  Image image{width, height, {}};
  image.rgba.resize(image.size_bytes());
  if (tjDecompress2(decoder.get(), bytes.data(), size, image.rgba.data(), width, 0, height, TJPF_RGBA, 0) != 0 &&
      tjGetErrorCode(decoder.get()) == TJERR_FATAL)
    return bad(name, tjGetErrorStr2(decoder.get()));
  return image;
}

struct LinearTable {
  std::array<float, 256> value;
  LinearTable() {
    for (int i = 0; i < 256; ++i) value[static_cast<std::size_t>(i)] = to_linear(static_cast<float>(i) / 255.0F);
  }
};

std::uint8_t to_byte(float srgb) { return static_cast<std::uint8_t>(std::clamp(srgb, 0.0F, 1.0F) * 255.0F + 0.5F); }

// The nearest sRGB code of a linear value, by table: fine enough that no code is missed.
struct SrgbTable {
  static constexpr int size = 1 << 14;
  std::vector<std::uint8_t> value = std::vector<std::uint8_t>(size + 1);
  SrgbTable() {
    for (int i = 0; i <= size; ++i) value[static_cast<std::size_t>(i)] = to_byte(to_srgb(static_cast<float>(i) / size));
  }
};

}  // namespace

float to_linear(float srgb) { return srgb <= 0.04045F ? srgb / 12.92F : std::pow((srgb + 0.055F) / 1.055F, 2.4F); }
float to_srgb(float linear) { return linear <= 0.0031308F ? linear * 12.92F : 1.055F * std::pow(linear, 1.0F / 2.4F) - 0.055F; }

base::Result<Image> decode_image(std::span<const std::uint8_t> bytes, const std::string& name) {
  if (is_png(bytes)) return decode_png(bytes, name);
  if (is_jpeg(bytes)) return decode_jpeg(bytes, name);
  if (is_dds(bytes)) return decode_dds(bytes, name);
  return bad(name, "neither PNG, JPEG nor DDS");
}

base::Result<Image> read_image(const std::filesystem::path& file) {
  auto bytes = read_bytes(file);
  if (!bytes) return bytes.error();
  return decode_image(*bytes, file.string());
}

namespace {
// Without alpha when every pixel is opaque.
struct PngWriter : PngReader {
  std::vector<std::uint8_t> rgb;
  const void* pixels;

  explicit PngWriter(const Image& from) : pixels(from.rgba.data()) {
    bool is_opaque = true;
    for (std::size_t i = 3; i < from.rgba.size(); i += 4) is_opaque = is_opaque && from.rgba[i] == 255;
    if (is_opaque) {
      rgb.reserve(from.rgba.size() / 4 * 3);
      for (std::size_t i = 0; i < from.rgba.size(); i += 4) rgb.insert(rgb.end(), &from.rgba[i], &from.rgba[i] + 3);
      pixels = rgb.data();
    }
    image.width = static_cast<png_uint_32>(from.width);
    image.height = static_cast<png_uint_32>(from.height);
    image.format = is_opaque ? PNG_FORMAT_RGB : PNG_FORMAT_RGBA;
  }
};
}  // namespace

base::Result<std::vector<std::uint8_t>> encode_png(const Image& image, const std::string& name) {
  if (image.width < 1 || image.height < 1 || image.rgba.size() != image.size_bytes()) return bad(name, "has no pixels");
  PngWriter writer(image);
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(writer.image);
  std::vector<std::uint8_t> bytes(size);
  if (png_image_write_to_memory(&writer.image, bytes.data(), &size, 0, writer.pixels, 0, nullptr) == 0)
    return bad(name, writer.image.message);
  bytes.resize(size);
  return bytes;
}

base::Result<void> write_png(const Image& image, const std::filesystem::path& file) {
  const auto octets = encode_png(image, file.string());
  if (!octets) return octets.error();
  return base::write_whole_file(file, {reinterpret_cast<const char*>(octets->data()), octets->size()});
}

Image halve(const Image& image) {
  static const LinearTable linear;
  static const SrgbTable srgb;
  const Image& in = image;
  Image out{std::max(1, in.width / 2), std::max(1, in.height / 2), {}};
  out.rgba.resize(out.size_bytes());
  const int step_x = in.width > 1 ? 1 : 0;
  const int step_y = in.height > 1 ? 1 : 0;
  for (int y = 0; y < out.height; ++y) {
    for (int x = 0; x < out.width; ++x) {
      const int x0 = in.width > 1 ? 2 * x : 0;
      const int y0 = in.height > 1 ? 2 * y : 0;
      float sum[3] = {0, 0, 0};
      float weight = 0;
      int alpha = 0;
      for (int k = 0; k < 4; ++k) {
        const auto row = static_cast<std::size_t>(y0 + (k >> 1) * step_y);
        const std::uint8_t* p = &in.rgba[(row * static_cast<std::size_t>(in.width) + static_cast<std::size_t>(x0 + (k & 1) * step_x)) * 4];
        const float w = static_cast<float>(p[3]) + 1e-3F;
        for (int c = 0; c < 3; ++c) sum[c] += w * linear.value[p[c]];
        weight += w;
        alpha += p[3];
      }
      std::uint8_t* p = &out.rgba[(static_cast<std::size_t>(y) * static_cast<std::size_t>(out.width) + static_cast<std::size_t>(x)) * 4];
      for (int c = 0; c < 3; ++c) p[c] = srgb.value[static_cast<std::size_t>(sum[c] / weight * static_cast<float>(SrgbTable::size) + 0.5F)];
      p[3] = static_cast<std::uint8_t>((alpha + 2) / 4);
    }
  }
  return out;
}

}  // namespace sim
