// Sets that grow together: each entry names another of its set, or itself when it stands for the set. One thread.
#pragma once

#include <cstdint>
#include <vector>

namespace sim {

// Who stands for the set of `i`; shortens the way there.
inline std::uint32_t root(std::vector<std::uint32_t>& parents, std::uint32_t i) {
  while (parents[i] != i) i = parents[i] = parents[parents[i]];
  return i;
}

}  // namespace sim
