// How long and deep the names may be that peers give: keys of connector properties, configuration parameters and creation arguments. They
// become paths in trees, so each step of each name costs memory. A table of facts; any thread.
#pragma once

#include <cstddef>
#include <string_view>

#include "base/result.h"

namespace rt {

struct KeyLimits {
  std::size_t length = 1024;                          // [octets] of one key
  std::size_t depth = 64;                             // steps of one key
  std::size_t keys = 4096;                            // of one list
  std::size_t total_length = std::size_t{256} << 10;  // [octets] of all keys of one list
};
inline constexpr KeyLimits key_limits{};

// A port of one connection calls the next one while the first still waits, so their number is the depth of a chain of calls.
inline constexpr std::size_t most_ports_of_a_connection = 256;

// `what` begins the message: "property of the connection".
base::Result<void> check_key(std::string_view what, std::string_view key);

// Counts the keys of one list.
class KeyCounter {
 public:
  explicit KeyCounter(std::string_view what) : what_(what) {}
  base::Result<void> add(std::string_view key);

 private:
  std::string_view what_;
  std::size_t keys_ = 0;
  std::size_t total_length_ = 0;
};

}  // namespace rt
