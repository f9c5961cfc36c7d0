// Pictures: read by the reader of files, written with libpng.
#include "render/image.h"

#include <png.h>

#include <algorithm>

#include "base/whole_file.h"
#include "reader/asset_reader.h"
#include "render/mesh_arrays.h"

namespace sim {
namespace {

base::Error bad(const std::string& name, const std::string& why) { return base::Error{"image " + name + ": " + why}; }

// A png_image is freed whatever happens.
struct PngReader {
  png_image image{};
  PngReader() { image.version = PNG_IMAGE_VERSION; }
  ~PngReader() { png_image_free(&image); }
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;
};

base::Result<Image> ask_for_image(AssetReader::Question question, int largest_side, FileStamps* files) {
  ArrayWriter details;
  details.number<std::int64_t>(largest_side);
  question.details = details.bytes();
  const auto answer = AssetReader::mine().ask(question);
  if (files != nullptr) *files = answer.files;
  return AssetReader::decoded<Image>(question, answer, take_image);
}

}  // namespace

base::Result<Image> decode_image(std::span<const std::uint8_t> bytes, const std::string& name, int largest_side) {
  static constexpr std::uint8_t nothing = 0;
  return ask_for_image({AssetKind::image, name, "image", {}, bytes.data() == nullptr ? std::span(&nothing, 0) : bytes}, largest_side,
                       nullptr);
}

base::Result<Image> read_image(const std::filesystem::path& file, int largest_side, FileStamps* files) {
  return ask_for_image({AssetKind::image, file.string(), "image", {}}, largest_side, files);
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

}  // namespace sim
