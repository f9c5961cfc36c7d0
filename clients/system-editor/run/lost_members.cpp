#include "run/lost_members.h"

#include <algorithm>
#include <thread>
#include <utility>

#include "base/text.h"

namespace editor {

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

// Who was called then, and when, the contexts say; how its process has ended is known where that was the command itself. Both are there in
// a moment.
Error LostMembers::tell(std::optional<ForeignProcesses::Ended> ended, std::vector<RunHosts::Gone> gone) {
  for (const auto end = Clock::now() + end_of_process; Clock::now() < end && (!ended || gone.empty());
       std::this_thread::sleep_for(pause_between_looks)) {
    if (!ended) ended = foreign_.ended();
    if (gone.empty()) gone = hosts_.gone_members();
  }
  if (!ended) return Error{"component " + gone.front().said};
  const auto known = std::ranges::find_if(gone, [&](const auto& one) { return has(ended->components, one.instance); });
  const auto time = known == gone.end() ? simulator_.time() : known->time;
  if (ended->is_open && ended->components.size() > 1) {
    // Those that answer are not of the process that has ended.
    auto silent = ended->components;
    std::erase_if(silent, answers_);
    if (!silent.empty()) ended->components = std::move(silent);
  }
  return Error{ended->text() + (time && *time > 0 ? ", at " + base::format_number(*time) + " s" : "")};
}

}  // namespace editor
