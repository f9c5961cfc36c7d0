// A 128-bit hash of contents, in the order in which they are added. It is not cryptographic: an attacker can construct collisions.
// A value; one thread at a time.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "base/result.h"

namespace base {

class ContentHash {
 public:
  // The length counts too: ("ab", "c") is not ("a", "bc").
  void add(std::string_view text);
  Result<void> add_file(const std::string& file);
  // 32 digits.
  std::string text() const;

 private:
  void mix(std::uint64_t word);
  std::uint64_t a_ = 0x243f6a8885a308d3ULL, b_ = 0x13198a2e03707344ULL;
};

}  // namespace base
