#include "run/lost_members.h"

#include <algorithm>
#include <thread>
#include <utility>

#include "base/text.h"

namespace tools {

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds end_of_process{300};  // from the break of its connections until it can be waited for
constexpr std::chrono::milliseconds pause_between_looks{20};

bool has(const std::vector<std::string>& names, const std::string& name) { return std::ranges::find(names, name) != names.end(); }

}  // namespace

Result<void> LostMembers::check() {
  if (told_) return *told_;
  auto ended = foreign_.ended();
  auto gone = hosts_.gone_members();
  if (!ended && gone.empty()) return {};
  return told_.emplace(tell(std::move(ended), std::move(gone)));
}

Error LostMembers::with_reason(const Error& problem) {
  const auto end = Clock::now() + end_of_process;
  const auto look = [this] {
    const auto whole = check();
    return whole ? hosts_.check() : whole;
  };
  auto whole = look();
  for (; whole && Clock::now() < end; std::this_thread::sleep_for(pause_between_looks)) whole = look();
  return whole || problem.message.starts_with(whole.error().message) ? problem : Error{whole.error().message + "; " + problem.message};
}

// Who was called then, and when, the contexts say; how its process has ended is known where that was the command itself. Both are there in
// a moment.
Error LostMembers::tell(std::optional<ForeignProcesses::Ended> ended, std::vector<RunHosts::Gone> gone) {
  for (const auto end = Clock::now() + end_of_process; Clock::now() < end && (!ended || gone.empty());
       std::this_thread::sleep_for(pause_between_looks)) {
    if (!ended) ended = foreign_.ended();
    if (gone.empty()) gone = hosts_.gone_members();
  }
  if (!ended) return Error{"component " + gone.front().said};
  // Those that were called when they had gone: the first of them before the others, which may have been ended with it.
  const auto known = std::ranges::find_if(gone, [&](const auto& one) { return has(ended->components, one.instance); });
  double time_s = 0;  // [s], simulated; 0: not known
  if (known != gone.end()) {
    time_s = known->time.value_or(0);
  } else if (const auto now = simulator_.now()) {
    time_s = now->time_s;
  }
  auto names = ended->components;
  if (known != gone.end()) {
    names = {known->instance};
  } else if (ended->is_open && can_ask_()) {
    std::erase_if(names, answers_);  // are of another process
  } else if (ended->is_open && !ended->is_only_one) {
    names.clear();
  }
  return Error{"process " + (names.empty() ? "" : "of " + base::join(names, ", ") + " ") + "(" + ended->command + ") " + ended->how +
               (time_s > 0 ? ", at " + base::format_number(time_s) + " s" : "") + ": " + ended->said};
}

}  // namespace tools
