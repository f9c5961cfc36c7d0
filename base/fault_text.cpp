#include "base/fault_text.h"

#include <array>
#include <cmath>

#include "base/text.h"

namespace base {
namespace {

constexpr double longest_s = 1e9;

std::chrono::nanoseconds nanoseconds(double seconds) { return std::chrono::nanoseconds(std::llround(seconds * 1e9)); }

}  // namespace

Result<FaultText> parse_fault_text(std::string_view text, std::string_view last) {
  const Error wrong{"fault " + in_quotes(text) + ": expected KIND:START:DURATION:AMOUNT:" + std::string(last)};
  std::array<std::string, 4> words;
  std::string_view rest = text;
  for (auto& word : words) {
    const auto end = rest.find(':');
    if (end == std::string_view::npos) return wrong;
    word = rest.substr(0, end);
    rest.remove_prefix(end + 1);
  }
  const auto start = parse_number(words[1]), duration = parse_number(words[2]), amount = parse_number(words[3]);
  const auto is_time = [](const std::optional<double>& time) { return time && *time >= 0 && *time <= longest_s; };
  if (!is_time(start) || !is_time(duration) || (!amount && !words[3].empty()) || rest.empty()) return wrong;
  FaultText fault{words[0], nanoseconds(*start), std::chrono::nanoseconds::max(), amount, std::string(rest)};
  if (*duration > 0) fault.until = nanoseconds(*start + *duration);
  return fault;
}

std::string fault_text(std::string_view kind, double start_s, double duration_s, double amount, const std::string& last) {
  return std::string(kind) + ":" + format_number(start_s) + ":" + format_number(duration_s) + ":" + format_number(amount) + ":" + last;
}

}  // namespace base
