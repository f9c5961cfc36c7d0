#include "recording/mcap/compression.h"

#include <libdeflate.h>
#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <utility>

#include "base/text.h"

namespace mcap {

namespace {

// Recordings are written while a robot runs, so time counts. A hash table that stays in the nearest cache and matches of at least seven
// octets make level -5 1.5 times as fast: scans and odometry of a hundred robots at 5.5 GB/s to 0.112 of their size instead of 3.7 GB/s to
// 0.105, all of an obstacle run at 1.7 GB/s to 0.40 instead of 1.3 to 0.36; lz4 3.0 to 0.120 and 1.2 to 0.37.
constexpr int zstd_level = -5, zstd_hash_log = 11, zstd_shortest_match = 7;
constexpr std::size_t first_room = 1 << 20;  // [bytes]

// Grows as octets really come, so that a length that lies costs nothing.
void make_room(std::string& out, std::size_t used, std::uint64_t size) {
  if (used < out.size()) return;
  out.resize(static_cast<std::size_t>(std::min<std::uint64_t>(size, std::max(first_room, used * 2))));
}

base::Error wrong_size(std::uint64_t size) { return {"does not decompress to the " + std::to_string(size) + " bytes that it announces"}; }

base::Result<void> decompress_zstd(std::string_view octets, std::uint64_t size, std::string& out) {
  const std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context(ZSTD_createDCtx(), ZSTD_freeDCtx);
  if (!context) return base::Error{"no memory to decompress with"};
  ZSTD_inBuffer in{octets.data(), octets.size(), 0};
  std::size_t used = 0;
  char beyond = 0;
  for (bool moves = true; moves;) {
    make_room(out, used, size);
    const bool is_full = used == size;
    ZSTD_outBuffer piece = is_full ? ZSTD_outBuffer{&beyond, 1, 0} : ZSTD_outBuffer{out.data(), out.size(), used};
    const std::size_t read = in.pos;
    const std::size_t written = piece.pos;
    const std::size_t answer = ZSTD_decompressStream(context.get(), &piece, &in);
    if (ZSTD_isError(answer)) return base::Error{std::string("cannot be decompressed: ") + ZSTD_getErrorName(answer)};
    if (is_full && piece.pos != 0) return wrong_size(size);
    if (!is_full) used = piece.pos;
    moves = in.pos != read || piece.pos != written;
  }
  if (used != size) return wrong_size(size);
  out.resize(used);
  return {};
}

base::Result<void> decompress_lz4(std::string_view octets, std::uint64_t size, std::string& out) {
  LZ4F_dctx* raw = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&raw, LZ4F_VERSION))) return base::Error{"no memory to decompress with"};
  const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> context(raw, LZ4F_freeDecompressionContext);
  std::size_t used = 0;
  char beyond = 0;
  while (!octets.empty()) {
    make_room(out, used, size);
    const bool is_full = used == size;
    std::size_t room = is_full ? 1 : out.size() - used;
    std::size_t taken = octets.size();
    const std::size_t answer = LZ4F_decompress(context.get(), is_full ? &beyond : out.data() + used, &room, octets.data(), &taken, nullptr);
    if (LZ4F_isError(answer)) return base::Error{std::string("cannot be decompressed: ") + LZ4F_getErrorName(answer)};
    if (is_full && room != 0) return wrong_size(size);
    if (!is_full) used += room;
    octets.remove_prefix(taken);
    if (taken == 0 && room == 0) break;
  }
  if (used != size) return wrong_size(size);
  out.resize(used);
  return {};
}

// Polynomials over two elements as CRC-32 has them: the highest bit is x^0.
constexpr std::uint32_t crc_polynomial = 0xedb88320U;
constexpr std::uint32_t one_octet = 0x00800000U;  // x^8

std::uint32_t crc_product(std::uint32_t a, std::uint32_t b) {
  std::uint32_t product = 0;
  for (std::uint32_t bit = 0x80000000U; bit != 0; bit >>= 1U) {
    if ((a & bit) != 0) product ^= b;
    b = (b & 1U) != 0 ? (b >> 1U) ^ crc_polynomial : b >> 1U;
  }
  return product;
}

}  // namespace

std::string_view to_text(Compression compression) {
  switch (compression) {
    case Compression::none:
      return "";
    case Compression::lz4:
      return "lz4";
    case Compression::zstd:
      return "zstd";
  }
  return "";
}

struct Compressor::Context {
  std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> zstd{nullptr, ZSTD_freeCCtx};
};

Compressor::Compressor(Compression compression) : compression_(compression), context_(std::make_unique<Context>()) {
  if (compression != Compression::zstd) return;
  context_->zstd.reset(ZSTD_createCCtx());
  if (!context_->zstd) return;  // compress() says so
  for (const auto& [parameter, value] : {std::pair(ZSTD_c_compressionLevel, zstd_level), std::pair(ZSTD_c_hashLog, zstd_hash_log),
                                         std::pair(ZSTD_c_minMatch, zstd_shortest_match)})
    ZSTD_CCtx_setParameter(context_->zstd.get(), parameter, value);
}

Compressor::~Compressor() = default;

base::Result<std::string_view> Compressor::compress(std::string_view octets, std::string& room) {
  switch (compression_) {
    case Compression::none:
      return octets;
    case Compression::zstd: {
      if (!context_->zstd) return base::Error{"no memory to compress with"};
      room.resize(std::max(room.size(), ZSTD_compressBound(octets.size())));
      const std::size_t size = ZSTD_compress2(context_->zstd.get(), room.data(), room.size(), octets.data(), octets.size());
      if (ZSTD_isError(size)) return base::Error{std::string("zstd: ") + ZSTD_getErrorName(size)};
      return std::string_view(room).substr(0, size);
    }
    case Compression::lz4: {
      room.resize(std::max(room.size(), LZ4F_compressFrameBound(octets.size(), nullptr)));
      const std::size_t size = LZ4F_compressFrame(room.data(), room.size(), octets.data(), octets.size(), nullptr);
      if (LZ4F_isError(size)) return base::Error{std::string("lz4: ") + LZ4F_getErrorName(size)};
      return std::string_view(room).substr(0, size);
    }
  }
  return octets;
}

base::Result<void> decompress(std::string_view name, std::string_view octets, std::uint64_t size, std::string& out) {
  out.clear();
  if (name.empty()) {
    if (octets.size() != size) return wrong_size(size);
    out.assign(octets);
    return {};
  }
  if (name == "zstd") return decompress_zstd(octets, size, out);
  if (name == "lz4") return decompress_lz4(octets, size, out);
  return base::Error{"has the compression " + base::in_quotes(name) + "; expected none, lz4 or zstd"};
}

// libdeflate takes a null pointer for the wish to begin anew.
std::uint32_t crc32(std::uint32_t before, std::string_view octets) {
  return octets.empty() ? before : libdeflate_crc32(before, octets.data(), octets.size());
}

// Octets that follow multiply the polynomial of what came before by x to the power of eight times their number.
std::uint32_t joined_crc32(std::uint32_t before, std::uint32_t crc, std::uint64_t size) {
  std::uint32_t power = one_octet;
  for (; size > 0; size >>= 1U) {
    if ((size & 1U) != 0) before = crc_product(before, power);
    power = crc_product(power, power);
  }
  return before ^ crc;
}

}  // namespace mcap
