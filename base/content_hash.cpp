#include "base/content_hash.h"

#include <cstdio>
#include <cstring>
#include <fstream>
#include <vector>

#include "base/beneath.h"
#include "base/text.h"

namespace base {

void ContentHash::mix(std::uint64_t word) {
  a_ = (a_ ^ word) * 0x9e3779b97f4a7c15ULL;
  a_ ^= a_ >> 29U;
  b_ = (b_ + word + (a_ << 1U)) * 0xc2b2ae3d27d4eb4fULL;
  b_ ^= b_ >> 32U;
}

void ContentHash::add(std::string_view text) {
  mix(text.size());
  std::uint64_t word = 0;
  for (; text.size() >= sizeof word; text.remove_prefix(sizeof word)) {
    std::memcpy(&word, text.data(), sizeof word);
    mix(word);
  }
  word = 0;
  std::memcpy(&word, text.data(), text.size());
  mix(word);
}

Result<void> ContentHash::add_file(const std::string& file) {
  if (const auto checked = check_regular_file(file); !checked) return checked;  // a device has no end
  std::ifstream in(file, std::ios::binary);
  std::vector<char> piece(1U << 18U);
  while (in.read(piece.data(), static_cast<std::streamsize>(piece.size())) || in.gcount() > 0)
    add({piece.data(), static_cast<std::size_t>(in.gcount())});
  if (!in.eof() || in.bad()) return Error{"file " + in_quotes(file) + ": cannot be read"};
  return {};
}

std::string ContentHash::text() const {
  char digits[33];
  std::snprintf(digits, sizeof digits, "%016llx%016llx", static_cast<unsigned long long>(a_), static_cast<unsigned long long>(b_));
  return digits;
}

}  // namespace base
