// Pictures and height maps, by libpng and libjpeg-turbo.
#include <png.h>
#include <spdlog/fmt/fmt.h>
#include <turbojpeg.h>

#include <algorithm>
#include <cctype>
#include <memory>

#include "asset-reader/dds.h"
#include "asset-reader/elevation_file.h"
#include "asset-reader/jobs.h"
#include "render/mesh_arrays.h"
#include "world/triangle_arrays.h"

namespace sim {
namespace {

base::Error bad(const std::string& why) { return base::Error{why}; }

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

base::Result<Image> decode_png(std::span<const std::uint8_t> bytes) {
  PngReader reader;
  if (png_image_begin_read_from_memory(&reader.image, bytes.data(), bytes.size()) == 0) return bad(reader.image.message);
  if (reader.image.width > largest_image || reader.image.height > largest_image) return bad("larger than 16384 pixels a side");
  reader.image.format = PNG_FORMAT_RGBA;
  Image image{static_cast<int>(reader.image.width), static_cast<int>(reader.image.height), {}};
  image.rgba.resize(image.size_bytes());
  if (png_image_finish_read(&reader.image, nullptr, image.rgba.data(), 0, nullptr) == 0) return bad(reader.image.message);
  return image;
}

base::Result<Image> decode_jpeg(std::span<const std::uint8_t> bytes) {
  const std::unique_ptr<void, int (*)(void*)> decoder(tjInitDecompress(), tjDestroy);
  if (!decoder) return bad("no JPEG decoder");
  int width = 0;
  int height = 0;
  int sampling = 0;
  int colours = 0;
  const auto size = static_cast<unsigned long>(bytes.size());
  if (tjDecompressHeader3(decoder.get(), bytes.data(), size, &width, &height, &sampling, &colours) != 0)
    return bad(tjGetErrorStr2(decoder.get()));
  if (width < 1 || height < 1 || width > largest_image || height > largest_image) return bad("larger than 16384 pixels a side");
  Image image{width, height, {}};
  image.rgba.resize(image.size_bytes());
  if (tjDecompress2(decoder.get(), bytes.data(), size, image.rgba.data(), width, 0, height, TJPF_RGBA, 0) != 0 &&
      tjGetErrorCode(decoder.get()) == TJERR_FATAL)
    return bad(tjGetErrorStr2(decoder.get()));
  return image;
}

bool is_pgm(std::span<const std::uint8_t> bytes) { return bytes.size() > 8 && bytes[0] == 'P' && bytes[1] == '5'; }

// Grey, as maps of robots are written: "P5", width, height, largest value, each after blanks and comments; one blank; the pixels.
base::Result<Image> decode_pgm(std::span<const std::uint8_t> bytes) {
  std::size_t at = 2;
  const auto number = [&] {
    while (at < bytes.size() && (std::isspace(bytes[at]) != 0 || bytes[at] == '#')) {
      if (bytes[at] != '#') {
        ++at;
        continue;
      }
      while (at < bytes.size() && bytes[at] != '\n') ++at;
    }
    int value = -1;
    for (; at < bytes.size() && std::isdigit(bytes[at]) != 0 && value < 1'000'000; ++at) value = 10 * std::max(value, 0) + bytes[at] - '0';
    return value;
  };
  const int width = number(), height = number(), most = number();
  if (width < 1 || height < 1 || most < 1 || most > 65535) return bad("a damaged PGM header");
  if (width > largest_image || height > largest_image) return bad("larger than 16384 pixels a side");
  const std::size_t each = most > 255 ? 2 : 1, count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  ++at;
  if (at > bytes.size() || bytes.size() - at < count * each) return bad("a PGM image that is cut off");
  Image image{width, height, {}};
  image.rgba.reserve(image.size_bytes());
  for (std::size_t i = 0; i < count; ++i, at += each) {
    const int value = each == 1 ? bytes[at] : bytes[at] * 256 + bytes[at + 1];
    const auto grey = static_cast<std::uint8_t>(std::min(value, most) * 255 / most);
    image.rgba.insert(image.rgba.end(), {grey, grey, grey, 255});
  }
  return image;
}

// Of a size as large as the picture, but for what max_heights_a_side leaves out. The corners stay where they are.
base::Result<HeightLevels> decode_levels(std::span<const std::uint8_t> bytes) {
  if (is_tiff(bytes)) return decode_elevations(bytes);
  PngReader reader;
  png_image& image = reader.image;
  if (png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()) == 0)
    return bad(fmt::format("{} (expected a PNG image or a GeoTIFF)", image.message));
  if (image.width < 2 || image.height < 2 || image.width > largest_height_map || image.height > largest_height_map)
    return bad(fmt::format("size {}x{} (expected 2..{})", image.width, image.height, largest_height_map));
  // 16-bit images stay linear; 8-bit ones would pass a gamma curve in linear format.
  const bool is_deep = (image.format & PNG_FORMAT_FLAG_LINEAR) != 0;
  image.format = is_deep ? PNG_FORMAT_LINEAR_Y : PNG_FORMAT_GRAY;
  std::vector<std::uint16_t> deep(is_deep ? std::size_t{image.width} * image.height : 0);
  std::vector<std::uint8_t> flat(is_deep ? 0 : std::size_t{image.width} * image.height);
  if (png_image_finish_read(&image, nullptr, is_deep ? static_cast<void*>(deep.data()) : flat.data(), 0, nullptr) == 0)
    return bad(image.message);
  constexpr std::uint32_t most = max_heights_a_side;
  HeightLevels map{std::min(image.width, most), std::min(image.height, most), 0, is_deep ? 65535.0 : 255.0, {}};
  map.levels.reserve(std::size_t{map.columns} * map.rows);
  for (std::size_t row = 0; row < map.rows; ++row) {
    for (std::size_t column = 0; column < map.columns; ++column) {
      const std::size_t x = column * (image.width - 1) / (map.columns - 1);
      const std::size_t y = row * (image.height - 1) / (map.rows - 1);
      const std::size_t i = y * image.width + x;
      map.levels.push_back(is_deep ? deep[i] : flat[i]);
    }
  }
  return map;
}

base::Result<Image> decode(std::span<const std::uint8_t> bytes) {
  if (is_png(bytes)) return decode_png(bytes);
  if (is_jpeg(bytes)) return decode_jpeg(bytes);
  if (is_dds(bytes)) return decode_dds(bytes);
  if (is_pgm(bytes)) return decode_pgm(bytes);
  return bad("neither PNG, JPEG, DDS nor PGM");
}

std::span<const std::uint8_t> as_bytes(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

}  // namespace

base::Result<void> read_picture(Job& job) {
  const auto largest_side = std::max<std::int64_t>(1, job.in.number<std::int64_t>());
  std::string own;
  auto bytes = job.content;
  if (!job.has_content) {
    auto file = job.files.read(job.path, max_image_file);
    if (!file) return file.error();
    own = std::move(*file);
    bytes = as_bytes(own);
  }
  auto image = decode(bytes);
  if (!image) return image.error();
  while (std::max(image->width, image->height) > largest_side) *image = halve(*image);
  put(job.out, *image);
  return {};
}

base::Result<void> read_levels(Job& job) {
  const auto file = job.files.read(job.path, max_image_file);
  if (!file) return file.error();
  const auto map = decode_levels(as_bytes(*file));
  if (!map) return map.error();
  put(job.out, *map);
  return {};
}

}  // namespace sim
