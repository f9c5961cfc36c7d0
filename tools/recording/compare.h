// The first difference of two recordings. One thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "recording/mcap/mcap.h"
#include "recording/sample_difference.h"
#include "system/reporter.h"

namespace recorder {

struct CompareOptions {
  std::string first, second;
  std::vector<std::string> topics;
  DifferenceOptions tolerated;
};

struct Comparison {
  struct Difference {
    mcap::Time time{0};
    std::string tick;  // ", tick 571" of a port in lock step
    std::string what;  // the channel, and how its samples differ
  };
  std::vector<std::string> lonely_channels;  // those of one recording only, in words; the samples are not compared then
  std::optional<Difference> first;
  std::uint64_t samples = 0;              // equal ones
  std::vector<std::string> not_compared;  // times that one recording has in chunks that cannot be read, in words

  bool are_equal() const { return lonely_channels.empty() && !first && not_compared.empty(); }
};

// Fails when a recording cannot be read. `reporter` is warned of damage and of channels that are left out.
base::Result<Comparison> compare(const CompareOptions& options, tools::Reporter& reporter);

}  // namespace recorder
