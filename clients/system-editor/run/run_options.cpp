#include "run/run_options.h"

#include <CLI/CLI.hpp>

#include "run/run_system.h"

namespace editor {

void add_repeatability_options(CLI::App& run, RunOptions& options) {
  const auto* group = "Repeatability";
  run.add_option("--hash-log", options.hash_log, "Write hashes of the world, the components and what went through each port, for rtse diff")
      ->group(group);
  run.add_flag("--twice", options.twice, "Run it twice and name the first difference")->group(group);
  run.add_flag("--strict", options.strict, "Fail when something happened that could depend on chance")->group(group);
}

}  // namespace editor
