// run: one run, or one for each of several seeds, some of them at a time.
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iostream>
#include <mutex>
#include <nlohmann/json.hpp>
#include <sstream>

#include "base/text.h"
#include "child_process.h"
#include "run_system.h"

namespace editor {
namespace {

using Json = nlohmann::ordered_json;

// "3", "1..20".
Result<std::vector<std::uint64_t>> parse_seeds(const std::string& text) {
  const auto dots = text.find("..");
  const auto first = base::parse_integer(text.substr(0, dots));
  const auto last = dots == std::string::npos ? first : base::parse_integer(text.substr(dots + 2));
  if (!first || !last || *first < 0 || *last < *first || *last - *first >= 10000)
    return Error{"seeds " + base::in_quotes(text) + ": expected N or FIRST..LAST, at most 10000 of them"};
  std::vector<std::uint64_t> seeds;
  for (auto seed = *first; seed <= *last; ++seed) seeds.push_back(static_cast<std::uint64_t>(seed));
  return seeds;
}

Json to_json(const RunResult& result, std::uint64_t seed) {
  Json json{{"seed", seed},
            {"passed", result.is_passed()},
            {"state_hash", result.state_hash},
            {"path", result.path_m},
            {"simulated", result.simulated_s},
            {"wall", result.wall_s},
            {"expectations", Json::array()}};
  for (const auto& verdict : result.verdicts)
    json["expectations"].push_back({{"expectation", verdict.expectation}, {"problem", verdict.problem}});
  return json;
}

RunResult from_json(const Json& json) {
  RunResult result;
  result.state_hash = json.value("state_hash", "");
  result.path_m = json.value("path", 0.0);
  result.simulated_s = json.value("simulated", 0.0);
  result.wall_s = json.value("wall", 0.0);
  for (const auto& entry : json.value("expectations", Json::array()))
    result.verdicts.push_back({entry.value("expectation", ""), entry.value("problem", "")});
  return result;
}

void report(Editor& editor, const RunResult& result, std::uint64_t seed) {
  if (editor.json()) {
    std::cout << to_json(result, seed).dump() << '\n';
  } else {
    std::printf("%s  seed %llu  %.1f s simulated in %.1f s (%.1f x real time)  path %.2f m  state %s\n",
                result.is_passed() ? "passed" : "FAILED", static_cast<unsigned long long>(seed), result.simulated_s, result.wall_s,
                result.simulated_s / result.wall_s, result.path_m, result.state_hash.c_str());
  }
  std::fflush(stdout);
  for (const auto& verdict : result.verdicts) {
    if (!verdict.problem.empty()) editor.fail({verdict.expectation + ": " + verdict.problem});
  }
}

// Each seed in a process of its own, so that one that fails takes no other with it.
Result<RunResult> run_apart(const RunOptions& options, std::uint64_t seed) {
  ProgramCall call{{own_program("rtse"), "--json", "run", options.system, "--world", options.world, "--duration",
                    base::format_number(options.duration_s), "--seed", std::to_string(seed)},
                   {},
                   ""};
  if (!options.expectations.empty()) call.words.insert(call.words.end(), {"--expect", options.expectations});
  if (options.one_process_each) call.words.emplace_back("--one-process-each");
  for (const auto& path : options.module_paths) call.words.insert(call.words.end(), {"--module-path", path});
  for (const auto& path : options.resource_paths) call.words.insert(call.words.end(), {"--resource-path", path});
  const auto file = std::filesystem::temp_directory_path() / ("rtse-seed-" + std::to_string(getpid()) + "-" + std::to_string(seed));
  call.output = file.string();
  auto child = ChildProcess::start(call);
  if (!child) return child.error();
  const bool ended = child->wait(std::chrono::hours(2));
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  std::filesystem::remove(file);
  if (!ended) return Error{"seed " + std::to_string(seed) + ": did not end within two hours"};
  for (const auto& line : base::split_list(text.str(), '\n')) {
    const auto json = Json::parse(line, nullptr, false);
    if (json.is_object()) return from_json(json);
  }
  const auto lines = base::split_list(text.str(), '\n');
  return Error{"seed " + std::to_string(seed) + ": " + (lines.empty() ? "said nothing" : lines.back())};
}

}  // namespace

void run(Editor& editor, const RunOptions& options, const std::string& seeds_text, int jobs) {
  std::vector<RunResult> results;
  if (seeds_text.empty()) {
    auto result = run_system(editor.orb(), options);
    if (!result) return editor.fail(result.error());
    report(editor, *result, options.seed);
    results.push_back(std::move(*result));
  } else {
    const auto seeds = parse_seeds(seeds_text);
    if (!seeds) return editor.fail(seeds.error());
    std::mutex mutex;
    std::size_t passed = 0;
    std::size_t finished = 0;
    in_parallel(
        seeds->size(), editor.limit(),
        [&](std::size_t i) {
          auto result = run_apart(options, (*seeds)[i]);
          const std::scoped_lock lock(mutex);
          ++finished;
          if (!result) return editor.fail(result.error());
          passed += result->is_passed();
          report(editor, *result, (*seeds)[i]);
          results.push_back(std::move(*result));
        },
        static_cast<std::size_t>(jobs));
    if (!editor.json()) std::printf("%zu of %zu seeds passed\n", passed, finished);
  }
  if (options.junit.empty()) return;
  if (const auto written = write_junit(options.junit, options, results); !written) editor.fail(written.error());
}

}  // namespace editor
