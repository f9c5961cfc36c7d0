// `rtse run --page`: a run leaves one HTML page, which rtse-page writes from its recording. One thread at a time.
#pragma once

#include <optional>

#include "rtse/console.h"
#include "run/run_options.h"
#include "run/run_page.h"
#include "run/run_system.h"

namespace tools {

// The run with a recording for its page: a temporary one beside the page, if the user wants none. Without --page the options as they are.
RunOptions recorded_for_page(const RunOptions& options);

// The page of a run that recorded_for_page() made. It is written while the run goes on, unless all of the recording can be replaced until
// its end.
class WrittenPage {
 public:
  WrittenPage(const RunOptions& given, const RunOptions& made) : given_(given), made_(made) {}

  // The recording has begun.
  void begin();
  // Ends the page. A temporary recording is removed, unless the page failed. Problems go to `console`. Returns whether there is a page of
  // this run: one that left no recording leaves an older page as it is.
  bool end(Console& console, const RunResult& result);

 private:
  PageCall call() const {
    return {.recording = made_.record,
            .file = given_.page,
            .camera_rate = given_.page_camera_rate,
            .limit_mib = given_.page_limit_mib,
            .is_temporary = given_.record.empty()};
  }

  const RunOptions& given_;
  const RunOptions& made_;
  std::optional<PageBesideRun> beside_;
};

// The command that repeats the run, as words of a shell.
std::string repeating_command(const RunOptions& options);

}  // namespace tools
