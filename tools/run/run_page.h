// The HTML page of a run, which rtse-page writes from the run's recording. One thread at a time.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "run/run_system.h"

namespace editor {

struct PageCall {
  std::string recording;  // MCAP
  std::string file;       // the page
  double camera_rate = 1;
  double limit_mib = 64;
  std::string other = {};  // a second recording to compare with; empty: none
};

// What the page says about a run: passed, why, failures, marks, seed, hash, command, simulated. `command` repeats the run.
nlohmann::ordered_json page_summary(const RunResult& result, const std::string& command);
// Runs rtse-page and returns what it printed. `summary`: as above, or other members that rtse-page reads. An error names the page.
Result<std::string> write_run_page(const PageCall& call, const nlohmann::ordered_json& summary);

}  // namespace editor
