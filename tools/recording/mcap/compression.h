// Compresses and decompresses chunks, and computes their CRC-32 (IEEE 802.3). An object belongs to one thread at a time.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "recording/mcap/mcap.h"

namespace mcap {

// As the format writes it: "", "lz4", "zstd".
std::string_view to_text(Compression compression);

class Compressor final {
 public:
  explicit Compressor(Compression compression);
  Compressor(const Compressor&) = delete;
  Compressor& operator=(const Compressor&) = delete;
  ~Compressor();
  // What stands in the file: `octets` themselves without compression, else `room`, which is used again. An error of the library names it.
  base::Result<std::string_view> compress(std::string_view octets, std::string& room);

 private:
  struct Context;
  Compression compression_;
  std::unique_ptr<Context> context_;
};

// Exactly `size` octets; an error says what came instead. No more memory than `size` is taken.
base::Result<void> decompress(std::string_view name, std::string_view octets, std::uint64_t size, std::string& out);

std::uint32_t crc32(std::uint32_t before, std::string_view octets);
// Of `before` and then `size` octets whose own is `crc`, without a look at them.
std::uint32_t joined_crc32(std::uint32_t before, std::uint32_t crc, std::uint64_t size);

}  // namespace mcap
