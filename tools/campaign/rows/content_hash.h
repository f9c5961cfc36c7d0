// A number of 128 bits that stands for what was added, in its order. Not for secrets: who wants to can make two contents with the same one.
// A value; one thread at a time.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "base/result.h"

namespace campaign {

class ContentHash {
 public:
  // The length counts too: ("ab", "c") is not ("a", "bc").
  void add(std::string_view text);
  base::Result<void> add_file(const std::string& file);
  // 32 digits.
  std::string text() const;

 private:
  void mix(std::uint64_t word);
  std::uint64_t a_ = 0x243f6a8885a308d3ULL, b_ = 0x13198a2e03707344ULL;
};

}  // namespace campaign
