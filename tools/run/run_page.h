// The HTML page of a run, which rtse-page writes from the run's recording. One thread at a time.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "base/child_process.h"
#include "base/command.h"
#include "base/file_handle.h"
#include "run/run_system.h"

namespace tools {

struct PageCall {
  std::string recording;  // MCAP
  std::string file;       // the page
  double camera_rate = 1;
  double limit_mib = 64;
  std::string other = {};     // a second recording to compare with; empty: none
  bool is_temporary = false;  // the recording: messages do not name it
};

// --page-camera-rate and --page-limit of a command that writes a page.
void add_page_options(base::Command& command, PageCall& call);
// What the page says about a run: passed, why, failures, marks, seed, hash, command, simulated. `command` repeats the run.
nlohmann::ordered_json page_summary(const RunResult& result, const std::string& command);
// Runs rtse-page and returns what it printed. `summary`: as above, or other members that rtse-page reads. An error names the page.
Result<std::string> write_run_page(const PageCall& call, const nlohmann::ordered_json& summary);

// The same beside the run: writes what is recorded meanwhile, on processors that nobody else wants. One that is not finished leaves
// nothing.
class PageBesideRun {
 public:
  // An error leaves the page to write_run_page().
  static Result<PageBesideRun> start(const PageCall& call);
  PageBesideRun(PageBesideRun&&) noexcept = default;
  PageBesideRun& operator=(PageBesideRun&&) noexcept = delete;
  ~PageBesideRun();

  // The recording is whole. If rtse-page was killed meanwhile, the page is written anew.
  Result<std::string> finish(const nlohmann::ordered_json& summary);

 private:
  friend Result<std::string> write_run_page(const PageCall& call, const nlohmann::ordered_json& summary);
  static Result<PageBesideRun> start(const PageCall& call, const std::vector<std::string>& words);
  Result<std::string> written(const nlohmann::ordered_json& summary);
  PageBesideRun(PageCall call, base::ChildProcess process, base::FileHandle line)
      : call_(std::move(call)), process_(std::move(process)), line_(std::move(line)) {}

  PageCall call_;
  base::ChildProcess process_;
  base::FileHandle line_;
};

}  // namespace tools
