// The text of a fault to inject: KIND:START:DURATION:AMOUNT:LAST, as "drop:2:1:0.5:7". Times in seconds up to 1e9; DURATION 0: until the
// end. AMOUNT may be empty. Its reader knows the kinds, and what LAST is: an iface, or a seed. Values; any thread.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <string_view>

#include "base/result.h"

namespace base {

struct FaultText {
  std::string kind;
  std::chrono::nanoseconds from{}, until = std::chrono::nanoseconds::max();
  std::optional<double> amount;
  std::string last;  // never empty; may have colons
};

// `last`: the name of LAST, for the error: fault "TEXT": expected KIND:START:DURATION:AMOUNT:SEED
Result<FaultText> parse_fault_text(std::string_view text, std::string_view last);
std::string fault_text(std::string_view kind, double start_s, double duration_s, double amount, const std::string& last);

}  // namespace base
