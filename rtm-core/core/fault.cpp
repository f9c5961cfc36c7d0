#include "core/fault.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "base/random.h"
#include "base/text.h"

namespace rt {
namespace {

constexpr std::array<std::pair<std::string_view, Fault::Kind>, 8> kinds = {{{"error", Fault::Kind::error},
                                                                            {"exception", Fault::Kind::exception},
                                                                            {"slow", Fault::Kind::slow},
                                                                            {"hang", Fault::Kind::hang},
                                                                            {"drop", Fault::Kind::drop},
                                                                            {"delay", Fault::Kind::delay},
                                                                            {"duplicate", Fault::Kind::duplicate},
                                                                            {"reorder", Fault::Kind::reorder}}};
constexpr double longest_s = 1e9, longest_delay = 1000;

std::chrono::nanoseconds nanoseconds(double seconds) { return std::chrono::nanoseconds(std::llround(seconds * 1e9)); }

std::optional<Fault> parse_one(const std::string& text) {
  const auto words = base::split_list(text, ':');
  if (words.size() != 5) return std::nullopt;
  const auto kind = std::ranges::find_if(kinds, [&](const auto& one) { return one.first == words[0]; });
  const auto from = base::parse_number(words[1]), length = base::parse_number(words[2]), amount = base::parse_number(words[3]);
  const auto seed = base::parse_integer(words[4]);
  if (kind == kinds.end() || !from || !length || !amount || !seed || *from < 0 || *length < 0) return std::nullopt;
  if (*from > longest_s || *length > longest_s || *amount < 0 || *amount > longest_delay) return std::nullopt;
  Fault fault{kind->second, nanoseconds(*from), std::chrono::nanoseconds::max(), *amount, static_cast<std::uint64_t>(*seed)};
  if (*length > 0) fault.until = nanoseconds(*from + *length);
  return fault;
}

// From 0 up to, not including, 1; the same for the same seed and count.
double chance(std::uint64_t seed, std::uint64_t count) {
  return base::unit_interval(base::mix64(seed * 0xd1342543de82ef95ULL + (count + 1) * base::mix64_step));
}

}  // namespace

base::Result<std::vector<Fault>> parse_faults(std::string_view text) {
  std::vector<Fault> faults;
  for (const auto& word : base::split_list(text, ' ')) {
    const auto fault = parse_one(word);
    if (!fault) return base::Error{"fault " + base::in_quotes(word) + ": expected KIND:FROM:FOR:AMOUNT:SEED"};
    faults.push_back(*fault);
  }
  return faults;
}

std::vector<Sample> FaultyLink::pass(Sample sample, std::chrono::nanoseconds now) {
  auto state = state_.lock();
  const auto number = state->count++;
  std::vector<Sample> out{std::move(sample)};
  bool is_held_back = false;
  for (const Fault& fault : faults_) {
    if (!fault.is_at(now) || out.empty()) continue;
    const bool happens = chance(fault.seed, number) < fault.amount;
    if (fault.kind == Fault::Kind::drop && happens) out.clear();
    if (fault.kind == Fault::Kind::duplicate && happens) out.push_back(out.front());
    if (fault.kind == Fault::Kind::reorder && happens) is_held_back = true;
  }
  if (is_held_back && !out.empty() && state->later.empty()) {
    state->later.assign(out.begin(), out.end());
    out.clear();
  } else if (!out.empty()) {
    out.insert(out.end(), state->later.begin(), state->later.end());
    state->later.clear();
  }
  delay(*state, now, out);
  return out;
}

// A sample goes out so many samples later. What is held when the fault has ended goes out with the next one.
void FaultyLink::delay(State& state, std::chrono::nanoseconds now, std::vector<Sample>& out) const {
  std::size_t most = 0;
  for (const Fault& fault : faults_) {
    if (fault.kind == Fault::Kind::delay && fault.is_at(now)) most = std::max(most, static_cast<std::size_t>(fault.amount));
  }
  if (most == 0 && state.held.empty()) return;
  state.held.insert(state.held.end(), out.begin(), out.end());
  out.clear();
  while (state.held.size() > most) {
    out.push_back(std::move(state.held.front()));
    state.held.pop_front();
  }
}

}  // namespace rt
