// Height maps from GeoTIFF files: every kind of number and layout, what is not there, and what is refused. The files are written by
// libtiff.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tiffio.h>

#include <cmath>
#include <functional>

#include "support/world_files.h"
#include "world/triangles.h"

namespace sim {
namespace {

using testing::HasSubstr;

struct Dem {
  int width = 5, height = 5;
  int bits = 32, format = SAMPLEFORMAT_IEEEFP, bands = 1, compression = COMPRESSION_NONE, tile = 0, rows_in_strip = 2;
  const char* mode = "w";  // "wb": big-endian, "w8": BigTIFF
  std::string no_data{};
  std::function<double(int, int)> elevation = [](int column, int row) { return 100 + column + 10.0 * row; };
};

void add_no_data_tag(TIFF* file) {
  static char name[] = "GDALNoDataValue";
  static const TIFFFieldInfo field{42113, -1, -1, TIFF_ASCII, FIELD_CUSTOM, 1, 0, name};
  TIFFMergeFieldInfo(file, &field, 1);
}

template <class T>
void append(std::vector<std::uint8_t>& out, double value) {
  const T number = static_cast<T>(value);
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(&number);
  out.insert(out.end(), bytes, bytes + sizeof number);
}

void append(std::vector<std::uint8_t>& out, const Dem& dem, double value) {
  const bool is_signed = dem.format == SAMPLEFORMAT_INT;
  if (dem.format == SAMPLEFORMAT_IEEEFP) return dem.bits == 64 ? append<double>(out, value) : append<float>(out, value);
  if (dem.bits == 8) return is_signed ? append<std::int8_t>(out, value) : append<std::uint8_t>(out, value);
  if (dem.bits == 16) return is_signed ? append<std::int16_t>(out, value) : append<std::uint16_t>(out, value);
  return is_signed ? append<std::int32_t>(out, value) : append<std::uint32_t>(out, value);
}

std::string write_dem(const WorldFiles& files, const Dem& dem) {
  TIFFSetTagExtender(add_no_data_tag);
  std::string path = (files.folder() / "dem.tif").string();
  TIFF* file = TIFFOpen(path.c_str(), dem.mode);
  TIFFSetField(file, TIFFTAG_IMAGEWIDTH, dem.width);
  TIFFSetField(file, TIFFTAG_IMAGELENGTH, dem.height);
  TIFFSetField(file, TIFFTAG_SAMPLESPERPIXEL, dem.bands);
  TIFFSetField(file, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
  TIFFSetField(file, TIFFTAG_BITSPERSAMPLE, dem.bits);
  TIFFSetField(file, TIFFTAG_SAMPLEFORMAT, dem.format);
  TIFFSetField(file, TIFFTAG_COMPRESSION, dem.compression);
  TIFFSetField(file, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
  if (!dem.no_data.empty()) TIFFSetField(file, 42113, dem.no_data.c_str());
  const auto row_of = [&](int row, int from, int columns) {
    std::vector<std::uint8_t> bytes;
    for (int column = from; column < from + columns; ++column) {
      for (int band = 0; band < dem.bands; ++band)
        append(bytes, dem, dem.elevation(std::min(column, dem.width - 1), std::min(row, dem.height - 1)));
    }
    return bytes;
  };
  if (dem.tile > 0) {
    TIFFSetField(file, TIFFTAG_TILEWIDTH, dem.tile);
    TIFFSetField(file, TIFFTAG_TILELENGTH, dem.tile);
    for (int top = 0; top < dem.height; top += dem.tile) {
      for (int left = 0; left < dem.width; left += dem.tile) {
        std::vector<std::uint8_t> bytes;
        for (int row = top; row < top + dem.tile; ++row) {
          const auto part = row_of(row, left, dem.tile);
          bytes.insert(bytes.end(), part.begin(), part.end());
        }
        TIFFWriteTile(file, bytes.data(), static_cast<std::uint32_t>(left), static_cast<std::uint32_t>(top), 0, 0);
      }
    }
  } else {
    TIFFSetField(file, TIFFTAG_ROWSPERSTRIP, dem.rows_in_strip);
    for (int row = 0; row < dem.height; ++row) TIFFWriteScanline(file, row_of(row, 0, dem.width).data(), static_cast<std::uint32_t>(row));
  }
  TIFFClose(file);
  return path;
}

HeightmapShape map_of(const std::string& path, const Eigen::Vector3d& size = {40, 40, 44}) { return {path, size, {0, 0, 0}, 1, {}, {}}; }

// The elevations go from 100 to 144: with a size of 44 m they stay as they are.
void expect_elevations(const Dem& dem) {
  const WorldFiles files;
  const auto grid = TriangleCache().heights(map_of(write_dem(files, dem)));
  ASSERT_TRUE(grid) << grid.error().message;
  ASSERT_EQ((*grid)->columns, dem.width);
  ASSERT_EQ((*grid)->rows, dem.height);
  for (int row = 0; row < dem.height; ++row) {
    for (int column = 0; column < dem.width; ++column)
      EXPECT_NEAR((*grid)->heights[static_cast<std::size_t>(row * dem.width + column)], dem.elevation(column, row), 1e-4)
          << column << " " << row;
  }
}

TEST(Elevations, are_read_from_whole_and_floating_point_numbers) {
  for (const int format : {SAMPLEFORMAT_UINT, SAMPLEFORMAT_INT}) {
    for (const int bits : {8, 16, 32}) {
      const bool is_byte = format == SAMPLEFORMAT_INT && bits == 8;
      Dem dem{.bits = bits, .format = format};
      if (is_byte) dem.elevation = [](int column, int row) { return -20 + column + 10.0 * row; };
      expect_elevations(dem);
    }
  }
  for (const int bits : {32, 64}) expect_elevations({.bits = bits});
}

TEST(Elevations, are_read_from_strips_and_tiles_of_either_byte_order_compressed_and_large) {
  for (const char* mode : {"w", "wb", "w8"}) {
    for (const int compression : {COMPRESSION_NONE, COMPRESSION_LZW, COMPRESSION_ADOBE_DEFLATE, COMPRESSION_ZSTD}) {
      expect_elevations({.compression = compression, .mode = mode});
      expect_elevations({.bits = 16, .format = SAMPLEFORMAT_INT, .compression = compression, .tile = 16, .mode = mode});
    }
  }
  Dem large{.width = 40, .height = 40, .tile = 16};
  large.elevation = [](int column, int row) { return 100 + 44 * (column + row) / 78.0; };
  expect_elevations(large);
}

TEST(Elevations, have_the_height_of_the_size_above_the_lowest_one_which_stays) {
  const WorldFiles files;
  const auto grid = TriangleCache().heights(map_of(write_dem(files, {}), {40, 40, 4.4}));
  ASSERT_TRUE(grid) << grid.error().message;
  EXPECT_NEAR((*grid)->heights.front(), 100, 1e-5);
  EXPECT_NEAR((*grid)->heights[1], 100.1, 1e-5);
  EXPECT_NEAR((*grid)->heights.back(), 104.4, 1e-5);
  Dem flat;
  flat.elevation = [](int, int) { return 7.0; };
  const auto level = TriangleCache().heights(map_of(write_dem(files, flat)));
  ASSERT_TRUE(level) << level.error().message;
  for (const float height : (*level)->heights) EXPECT_EQ(height, 7);
}

TEST(Elevations, without_a_value_are_the_lowest) {
  const WorldFiles files;
  const auto corner = [&](const std::string& no_data, double mark) {
    Dem dem;
    dem.no_data = no_data;
    dem.elevation = [mark](int column, int row) { return column == 0 && row == 0 ? mark : 101.0 + column + 10 * row; };
    const auto grid = TriangleCache().heights(map_of(write_dem(files, dem), {40, 40, 44}));
    if (!grid) return std::make_pair(grid.error().message, 0.0F);
    return std::make_pair(std::string(), (*grid)->heights.front());
  };
  EXPECT_EQ(corner("-1", -1), std::make_pair(std::string(), 102.0F));
  EXPECT_EQ(corner("-3.4028234663852886e+38", -3.4028234663852886e+38).second, 102);
  EXPECT_EQ(corner("-3.40282e+38", -3.4028234663852886e+38).second, 102) << "too far to be an elevation";
  EXPECT_EQ(corner("0.1", 0.1).second, 102) << "as near as 32 bits have it";
  EXPECT_EQ(corner("", -9999).second, 102);
  EXPECT_EQ(corner("", -32768).second, 102);
  EXPECT_EQ(corner("nan", std::nan("")).second, 102);
  EXPECT_EQ(corner("", std::numeric_limits<double>::infinity()).second, 102);
  EXPECT_EQ(corner("-1", -9999).second, -9999) << "the file says which value is none";
}

TEST(Elevations, of_a_map_that_is_not_square_lie_in_the_north_west_of_one_that_is) {
  const WorldFiles files;
  const auto grid = TriangleCache().heights(map_of(write_dem(files, {.width = 5, .height = 3}), {40, 40, 24}));
  ASSERT_TRUE(grid) << grid.error().message;
  ASSERT_EQ((*grid)->columns, 5);
  ASSERT_EQ((*grid)->rows, 5);
  for (int row = 0; row < 5; ++row) {
    for (int column = 0; column < 5; ++column)
      EXPECT_NEAR((*grid)->heights[static_cast<std::size_t>(5 * row + column)], row < 3 ? 100 + column + 10 * row : 100, 1e-4);
  }
}

TEST(Elevations, that_are_not_of_one_band_of_known_numbers_are_refused_with_what_is_expected) {
  const WorldFiles files;
  const auto fault = [&](const Dem& dem) {
    const auto grid = TriangleCache().heights(map_of(write_dem(files, dem)));
    return grid ? std::string() : grid.error().message;
  };
  EXPECT_THAT(fault({.bits = 8, .format = SAMPLEFORMAT_UINT, .bands = 3}), HasSubstr("3 bands (expected 1, of elevations)"));
  EXPECT_THAT(fault({.width = 1, .height = 4}), HasSubstr("size 1x4 (expected 2..8193)"));
  EXPECT_THAT(fault({.width = 2, .height = 9000}), HasSubstr("size 2x9000 (expected 2..8193)"));
  EXPECT_THAT(fault({.bits = 32, .format = SAMPLEFORMAT_COMPLEXINT}),
              HasSubstr("numbers of another kind of 32 bits (expected whole numbers"));
  Dem empty;
  empty.elevation = [](int, int) { return -9999.0; };
  EXPECT_THAT(fault(empty), HasSubstr("no elevation, only marks that there is none"));
}

TEST(Elevations, of_a_damaged_file_are_refused_in_one_line) {
  const WorldFiles files;
  const std::string path = write_dem(files, {.width = 65, .height = 65, .compression = COMPRESSION_LZW, .rows_in_strip = 8});
  const auto size = std::filesystem::file_size(path);
  int refused = 0;
  for (std::uintmax_t left = size - 1; left > 4; left = left * 2 / 3) {
    std::filesystem::resize_file(path, left);
    const auto grid = TriangleCache().heights(map_of(path));
    if (grid) continue;
    ++refused;
    EXPECT_EQ(grid.error().message.find('\n'), std::string::npos) << grid.error().message;
    EXPECT_THAT(grid.error().message, HasSubstr("dem.tif"));
  }
  EXPECT_GT(refused, 3);
}

TEST(Elevations, that_begin_far_above_have_a_note_that_says_so) {
  const WorldFiles files;
  write_dem(files, {});
  const LoadResult result = files.load(
      "<model name='m'><static>true</static><link name='l'><collision name='c'><geometry><heightmap><uri>dem.tif</uri>"
      "<size>20 10 3</size></heightmap></geometry></collision></link></model>");
  ASSERT_EQ(result.findings.size(), 1U) << all_findings(result);
  EXPECT_EQ(result.findings[0].severity, Finding::Severity::note);
  EXPECT_THAT(result.findings[0].text(), testing::AllOf(HasSubstr("dem.tif begin at 100 m"), HasSubstr("that far above its <pos>")));
  EXPECT_TRUE(std::holds_alternative<HeightmapShape>(result.world.models.at(0).links.at(0).collisions.at(0).geometry));
}

}  // namespace
}  // namespace sim
