#include "asset-reader/elevation_file.h"

#include <spdlog/fmt/fmt.h>
#include <tiffio.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace sim {
namespace {

constexpr std::uint32_t no_data_tag = 42113;                  // of GDAL: a number as text
constexpr std::uint64_t max_block = std::uint64_t{1} << 30U;  // [byte] of a strip or tile

base::Error bad_tiff(std::string why) { return base::Error{std::move(why)}; }

// What libtiff reads from, and the first that it complains of.
struct Source {
  std::span<const std::uint8_t> bytes;
  std::uint64_t at = 0;
  std::string fault{};
};

Source& source_of(thandle_t handle) { return *static_cast<Source*>(handle); }

tmsize_t read_bytes(thandle_t handle, void* to, tmsize_t size) {
  Source& source = source_of(handle);
  const std::uint64_t left = source.at < source.bytes.size() ? source.bytes.size() - source.at : 0;
  const auto count = static_cast<std::size_t>(std::min(left, static_cast<std::uint64_t>(std::max<tmsize_t>(size, 0))));
  if (count > 0) std::memcpy(to, source.bytes.data() + source.at, count);
  source.at += count;
  return static_cast<tmsize_t>(count);
}
tmsize_t write_bytes(thandle_t, void*, tmsize_t) { return 0; }
toff_t seek(thandle_t handle, toff_t offset, int from) {
  Source& source = source_of(handle);
  source.at = offset + (from == SEEK_CUR ? source.at : from == SEEK_END ? source.bytes.size() : 0);
  return source.at;
}
int close(thandle_t) { return 0; }
toff_t size_of(thandle_t handle) { return source_of(handle).bytes.size(); }

int keep_fault(TIFF*, void* source, const char*, const char* format, va_list arguments) {
  char text[300];
  std::vsnprintf(text, sizeof text, format, arguments);
  std::string& fault = static_cast<Source*>(source)->fault;
  if (fault.empty()) fault = text;
  return 1;
}
int ignore(TIFF*, void*, const char*, const char*, va_list) { return 1; }

void add_no_data_tag(TIFF* file) {
  static char name[] = "GDALNoDataValue";
  static const TIFFFieldInfo field{no_data_tag, -1, -1, TIFF_ASCII, FIELD_CUSTOM, 1, 0, name};
  TIFFMergeFieldInfo(file, &field, 1);
}

using Tiff = std::unique_ptr<TIFF, void (*)(TIFF*)>;

Tiff open(Source& source) {
  TIFFSetTagExtender(add_no_data_tag);
  const std::unique_ptr<TIFFOpenOptions, void (*)(TIFFOpenOptions*)> options(TIFFOpenOptionsAlloc(), TIFFOpenOptionsFree);
  TIFFOpenOptionsSetErrorHandlerExtR(options.get(), keep_fault, &source);
  TIFFOpenOptionsSetWarningHandlerExtR(options.get(), ignore, &source);
  return {TIFFClientOpenExt("elevations", "rm", &source, read_bytes, write_bytes, seek, close, size_of, nullptr, nullptr, options.get()),
          TIFFClose};
}

struct TiffLayout {
  std::uint32_t width = 0, height = 0;
  std::uint16_t bands = 1, bits = 1, format = SAMPLEFORMAT_UINT;
  std::uint32_t block_width = 0, block_height = 0;  // of a tile, or of a strip
  bool has_tiles = false;
};

base::Result<TiffLayout> layout_of(TIFF* file) {
  TiffLayout layout;
  TIFFGetField(file, TIFFTAG_IMAGEWIDTH, &layout.width);
  TIFFGetField(file, TIFFTAG_IMAGELENGTH, &layout.height);
  TIFFGetFieldDefaulted(file, TIFFTAG_SAMPLESPERPIXEL, &layout.bands);
  TIFFGetFieldDefaulted(file, TIFFTAG_BITSPERSAMPLE, &layout.bits);
  TIFFGetFieldDefaulted(file, TIFFTAG_SAMPLEFORMAT, &layout.format);
  if (layout.bands != 1) return bad_tiff(fmt::format("{} bands (expected 1, of elevations)", layout.bands));
  constexpr std::uint32_t most = largest_height_map;
  if (layout.width < 2 || layout.height < 2 || layout.width > most || layout.height > most)
    return bad_tiff(fmt::format("size {}x{} (expected 2..{})", layout.width, layout.height, most));
  const bool is_float = layout.format == SAMPLEFORMAT_IEEEFP;
  const bool is_whole = layout.format == SAMPLEFORMAT_UINT || layout.format == SAMPLEFORMAT_INT;
  const bool is_known = is_float ? layout.bits == 32 || layout.bits == 64 : layout.bits == 8 || layout.bits == 16 || layout.bits == 32;
  if ((!is_float && !is_whole) || !is_known)
    return bad_tiff(fmt::format("{} of {} bits (expected whole numbers of 8, 16 or 32 bits, or floating-point numbers of 32 or 64)",
                                is_float   ? "floating-point numbers"
                                : is_whole ? "whole numbers"
                                           : "numbers of another kind",
                                layout.bits));
  layout.has_tiles = TIFFIsTiled(file) != 0;
  if (layout.has_tiles) {
    TIFFGetField(file, TIFFTAG_TILEWIDTH, &layout.block_width);
    TIFFGetField(file, TIFFTAG_TILELENGTH, &layout.block_height);
  } else {
    layout.block_width = layout.width;
    TIFFGetFieldDefaulted(file, TIFFTAG_ROWSPERSTRIP, &layout.block_height);
    layout.block_height = std::min(layout.block_height, layout.height);
  }
  const std::uint64_t bytes = std::uint64_t{layout.block_width} * layout.block_height * layout.bits / 8;
  if (bytes == 0 || bytes > max_block) return bad_tiff(fmt::format("tiles of {}x{}", layout.block_width, layout.block_height));
  return layout;
}

template <class T>
double number_at(const std::uint8_t* at) {
  T value;
  std::memcpy(&value, at, sizeof value);
  return static_cast<double>(value);
}

double sample(const TiffLayout& layout, const std::uint8_t* at) {
  if (layout.format == SAMPLEFORMAT_IEEEFP) return layout.bits == 32 ? number_at<float>(at) : number_at<double>(at);
  const bool has_sign = layout.format == SAMPLEFORMAT_INT;
  if (layout.bits == 8) return has_sign ? number_at<std::int8_t>(at) : number_at<std::uint8_t>(at);
  if (layout.bits == 16) return has_sign ? number_at<std::int16_t>(at) : number_at<std::uint16_t>(at);
  return has_sign ? number_at<std::int32_t>(at) : number_at<std::uint32_t>(at);
}

// All, row by row from the north; the reason otherwise.
base::Result<std::vector<double>> samples(TIFF* file, const TiffLayout& layout, const Source& source) {
  std::vector<double> out(std::size_t{layout.width} * layout.height);
  const std::size_t each = layout.bits / 8U, row_bytes = layout.block_width * each;
  std::vector<std::uint8_t> block(row_bytes * layout.block_height);
  for (std::uint32_t top = 0; top < layout.height; top += layout.block_height) {
    for (std::uint32_t left = 0; left < layout.width; left += layout.block_width) {
      const std::uint32_t rows = std::min(layout.block_height, layout.height - top);
      const std::uint32_t columns = std::min(layout.block_width, layout.width - left);
      // The last strip is shorter, tiles are all of one size.
      const auto wanted = static_cast<tmsize_t>(row_bytes * (layout.has_tiles ? layout.block_height : rows));
      const tmsize_t got = layout.has_tiles ? TIFFReadEncodedTile(file, TIFFComputeTile(file, left, top, 0, 0), block.data(), wanted)
                                            : TIFFReadEncodedStrip(file, TIFFComputeStrip(file, top, 0), block.data(), wanted);
      if (got != wanted) return bad_tiff(source.fault.empty() ? "a TIFF that is cut off" : source.fault);
      for (std::uint32_t y = 0; y < rows; ++y) {
        for (std::uint32_t x = 0; x < columns; ++x)
          out[std::size_t{top + y} * layout.width + left + x] = sample(layout, block.data() + y * row_bytes + x * each);
      }
    }
  }
  return out;
}

// The values that mean that there is none.
std::vector<double> no_values(TIFF* file) {
  const char* text = nullptr;
  if (TIFFGetField(file, no_data_tag, &text) == 1 && text != nullptr) {
    char* end = nullptr;
    const double value = std::strtod(text, &end);
    // Files of floating-point numbers name it with more digits than they have.
    if (end != text) return {value, static_cast<double>(static_cast<float>(value))};
  }
  return {-9999, -32768};
}

}  // namespace

bool is_tiff(std::span<const std::uint8_t> bytes) {
  constexpr std::array<std::array<std::uint8_t, 4>, 4> heads{{{'I', 'I', 42, 0}, {'M', 'M', 0, 42}, {'I', 'I', 43, 0}, {'M', 'M', 0, 43}}};
  return bytes.size() >= 4 &&
         std::any_of(heads.begin(), heads.end(), [&](const auto& head) { return std::equal(head.begin(), head.end(), bytes.begin()); });
}

base::Result<HeightLevels> decode_elevations(std::span<const std::uint8_t> bytes) {
  Source source{bytes};
  const Tiff file = open(source);
  if (!file) return bad_tiff(source.fault.empty() ? "a damaged TIFF" : source.fault);
  const auto layout = layout_of(file.get());
  if (!layout) return layout.error();
  auto elevations = samples(file.get(), *layout, source);
  if (!elevations) return elevations.error();
  const std::vector<double> missing = no_values(file.get());
  const auto has_value = [&](double e) {
    return std::abs(e) <= largest_coordinate && std::find(missing.begin(), missing.end(), e) == missing.end();
  };
  HeightLevels map;
  map.lowest = std::numeric_limits<double>::max(), map.highest = -map.lowest;
  for (const double e : *elevations) {
    if (has_value(e)) map.lowest = std::min(map.lowest, e), map.highest = std::max(map.highest, e);
  }
  if (map.lowest > map.highest) return bad_tiff("no elevation, only marks that there is none");
  const std::uint32_t side = std::max(layout->width, layout->height);
  map.columns = map.rows = std::min<std::uint32_t>(side, max_heights_a_side);
  map.levels.reserve(std::size_t{map.columns} * map.rows);
  for (std::size_t row = 0; row < map.rows; ++row) {
    for (std::size_t column = 0; column < map.columns; ++column) {
      const std::size_t x = column * (side - 1) / (map.columns - 1), y = row * (side - 1) / (map.rows - 1);
      const bool is_inside = x < layout->width && y < layout->height;
      const double e = is_inside ? (*elevations)[y * layout->width + x] : map.lowest;
      map.levels.push_back(static_cast<float>(has_value(e) ? e : map.lowest));
    }
  }
  return map;
}

}  // namespace sim
