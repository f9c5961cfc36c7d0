#include "core/fault.h"

#include <algorithm>
#include <array>
#include <utility>

#include "base/fault_text.h"
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
constexpr double longest_delay = 1000;

// From 0 up to, not including, 1; the same for the same seed and count.
double chance(std::uint64_t seed, std::uint64_t count) {
  return base::unit_interval(base::mix64(seed * 0xd1342543de82ef95ULL + (count + 1) * base::mix64_step));
}

}  // namespace

base::Result<std::vector<Fault>> parse_faults(std::string_view text) {
  std::vector<Fault> faults;
  for (const auto& word : base::split_list(text, ' ')) {
    const auto parsed = base::parse_fault_text(word, "SEED");
    if (!parsed) return parsed.error();
    const auto kind = std::ranges::find_if(kinds, [&](const auto& one) { return one.first == parsed->kind; });
    const auto seed = base::parse_integer(parsed->last);
    const double amount = parsed->amount.value_or(-1);
    if (kind == kinds.end() || !seed || amount < 0 || amount > longest_delay)
      return base::Error{"fault " + base::in_quotes(word) +
                         ": expected KIND:START:DURATION:AMOUNT:SEED with error, exception, slow, hang, drop, delay, duplicate or reorder, "
                         "an amount from 0 to 1000 and a whole number"};
    faults.push_back({kind->second, parsed->from, parsed->until, amount, static_cast<std::uint64_t>(*seed)});
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
