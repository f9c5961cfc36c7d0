// run --like.
#include <memory>
#include <optional>
#include <utility>

#include "recording/ring.h"
#include "rtse/command.h"
#include "rtse/commands/run.h"
#include "rtse/recorder/recorder_commands.h"
#include "run/recorded_run.h"

namespace recorder {

void add_run_like(base::Command& app, tools::Chosen& chosen) {
  const auto kept = std::make_shared<std::optional<RecordedRun>>();  // its files, until the run has ended
  tools::add_run_like(
      app, chosen,
      [kept](tools::Console& console, const std::string& recording) -> base::Result<tools::RunOptions> {
        auto run = RecordedRun::unpack(recording);
        if (!run) return run.error();
        if (const auto lost = run->lost(); !lost.empty()) console.warn(lost);
        return kept->emplace(std::move(*run)).options();
      },
      recording_format_problem);
}

}  // namespace recorder
