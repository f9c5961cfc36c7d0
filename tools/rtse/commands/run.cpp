// run: one run, or one for each of several seeds, some of them at a time.
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>

#include "base/child_process.h"
#include "base/command_line.h"
#include "base/file_handle.h"
#include "base/guarded.h"
#include "base/interrupt.h"
#include "base/text.h"
#include "base/valid_file.h"
#include "base/whole_file.h"
#include "rtse/command.h"
#include "rtse/commands/commands.h"
#include "rtse/commands/run.h"
#include "rtse/commands/run_page.h"
#include "run/run_options.h"
#include "run/run_system.h"
#include "run/run_twice.h"

namespace tools {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::chrono::seconds interrupted_limit{60};  // of a run that was interrupted
constexpr const char* options_from_input = "--options-from-input";

double times_real_time(const RunResult& result) { return result.wall_s > 0 ? result.runs * result.simulated_s / result.wall_s : 0; }

std::string metres(double length) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f m", length);
  return text;
}

void print_heading() {
  std::printf("%10s  %-6s  %11s  %9s  %9s  %-16s  %s\n", "seed", "result", "simulated", "speed", "path", "state", "unmet");
}

void print_row(const RunResult& result) {
  std::string unmet = result.problem.empty() ? "" : "did not run to the end";
  for (const auto& verdict : result.verdicts) {
    if (!verdict.problem.empty()) unmet += (unmet.empty() ? "" : ", ") + verdict.expectation;
  }
  const auto path = result.problem.empty() ? metres(result.path_m) : "-";
  std::printf("%10llu  %-6s  %9.1f s  %7.1f x  %9s  %-16s  %s\n", static_cast<unsigned long long>(result.seed),
              result.is_passed() ? "passed" : "FAILED", result.simulated_s, times_real_time(result), path.c_str(),
              result.state_hash.empty() ? "-" : result.state_hash.c_str(), unmet.empty() ? "-" : base::printable(unmet).c_str());
}

// A line on standard output, or a row of the table of seeds; what is wrong on standard error, with the seed before it when there are
// several.
// Of what was not run because it was asked for wrongly there is no result.
void report(Console& console, const RunResult& result, bool is_row) {
  const bool is_refused = result.refusal != RunResult::Refusal::none;
  if (is_refused && !console.json()) return console.reject({result.problem});
  if (console.json()) {
    std::cout << to_json(result).dump(-1, ' ', false, Json::error_handler_t::replace) << '\n';
  } else if (is_row) {
    print_row(result);
  } else {
    // How far the models went is known of a run that came to its end.
    const auto path = result.problem.empty() ? "  path " + metres(result.path_m) : "";
    std::printf("%s  seed %llu  %s%.1f s simulated in %.1f s (%.1f x real time)%s  state %s%s%s\n",
                result.is_passed() ? "passed" : "FAILED", static_cast<unsigned long long>(result.seed), result.runs > 1 ? "2 x " : "",
                result.simulated_s, result.wall_s, times_real_time(result), path.c_str(),
                result.state_hash.empty() ? "-" : result.state_hash.c_str(), result.run_hash.empty() ? "" : "  run ",
                result.run_hash.c_str());
  }
  std::fflush(stdout);
  const std::string seed = is_row ? "seed " + std::to_string(result.seed) + ": " : "";
  for (const auto& note : result.notes) console.warn(seed + note);
  if (is_refused) return console.reject({result.problem});
  if (!result.problem.empty()) console.fail({seed + result.problem});
  for (const auto& verdict : result.verdicts) {
    if (!verdict.problem.empty()) console.fail({seed + failure_text(verdict)});
  }
}

// "out/picture.png" -> "out/picture-7.png"
std::string for_seed(const std::string& file, std::uint64_t seed) {
  const std::filesystem::path path(file);
  return (path.parent_path() / (path.stem().string() + "-" + std::to_string(seed) + path.extension().string())).string();
}

// A file that is read from its beginning, and gone when all have closed it.
Result<base::FileHandle> memory_file(const std::string& text) {
  base::FileHandle file(memfd_create("options", MFD_CLOEXEC));
  if (write(file.get(), text.data(), text.size()) != static_cast<ssize_t>(text.size()) || lseek(file.get(), 0, SEEK_SET) != 0)
    return Error{std::string("run: no memory for the options of a seed: ") + std::strerror(errno)};
  return file;
}

RunOptions of_seed(RunOptions options, std::uint64_t seed) {
  options.seed = seed;
  options.junit.clear();
  for (auto* file : {&options.picture, &options.record, &options.page, &options.hash_log}) {
    if (!file->empty()) *file = for_seed(*file, seed);
  }
  if (!options.keep.empty()) options.keep = (std::filesystem::path(options.keep) / ("seed-" + std::to_string(seed))).string();
  return options;
}

// Each seed in a process of its own, so that one that fails takes no other with it. It reads its options from its standard input.
RunResult run_apart(const RunOptions& options, std::uint64_t seed) {
  RunResult failed;
  failed.seed = seed;
  const auto text = to_json(of_seed(options, seed), RunOptionSet::all).dump(-1, ' ', false, Json::error_handler_t::replace);
  const auto input = memory_file(text);
  if (!input) {
    failed.problem = input.error().message;
    return failed;
  }
  auto child = base::ChildProcess::start(
      {.words = {base::own_program("rtse"), "--json", "run", options.system, "--world", options.world, options_from_input},
       .environment = {},
       .input = input->get()});
  if (!child) {
    failed.problem = child.error().message;
    return failed;
  }
  // A run that is interrupted takes its processes down and says so itself.
  if (child->wait_or_interrupt(std::chrono::hours(24 * 365)) == base::Ending::interrupted) {
    child->terminate();
    child->wait(interrupted_limit);
  }
  const auto lines = base::split_list(child->said(), '\n');
  for (const auto& line : lines) {
    const auto json = Json::parse(line, nullptr, false);
    if (json.is_object()) return run_result_of(json);
  }
  failed.problem = "rtse " + child->how_it_ended() + (lines.empty() ? "" : ": " + lines.back());
  return failed;
}

// Each file that is written is one of its own.
Result<void> check_files(const RunOptions& options) {
  std::error_code error;
  std::vector<std::filesystem::path> taken;
  for (const auto& file : {options.system, options.world, options.expectations})
    taken.push_back(std::filesystem::weakly_canonical(file, error));
  for (const auto& file : {options.junit, options.picture, options.record, options.page, options.hash_log}) {
    if (file.empty()) continue;
    const auto path = std::filesystem::weakly_canonical(file, error);
    if (std::ranges::find(taken, path) != taken.end()) return Error{"file " + base::in_quotes(file) + ": is used for something else too"};
    if (const auto writable = base::check_writable_file(file); !writable) return writable;
    taken.push_back(path);
  }
  return {};
}

std::vector<RunResult> run_seeds(const Session& session, Console& console, const RunOptions& options,
                                 const std::vector<std::uint64_t>& seeds, int jobs) {
  base::Turn<> telling;                   // one result at a time
  std::map<std::size_t, RunResult> done;  // by place in `seeds`
  std::size_t reported = 0;               // rows come in the order of the seeds
  std::atomic<bool> is_refused{false};
  std::vector<RunResult> results;
  const bool shows = isatty(2);
  const auto show = [&] {
    constexpr std::size_t width = 30;
    const auto filled = done.size() * width / seeds.size();
    std::fprintf(stderr, "\r[%s%s] %zu of %zu", std::string(filled, '#').c_str(), std::string(width - filled, '.').c_str(), done.size(),
                 seeds.size());
  };
  const auto hide = [] { std::fprintf(stderr, "\r%60s\r", ""); };
  if (shows) show();
  in_parallel(
      seeds.size(), session.call_timeout(),
      [&](std::size_t i) {
        if (base::is_interrupted() || is_refused) return;
        auto result = run_apart(options, seeds[i]);
        const auto mine = telling.take();
        if (result.refusal != RunResult::Refusal::none) {
          if (is_refused.exchange(true)) return;  // as each seed would be
          console.reject({result.problem});
          results.push_back(std::move(result));
          return;
        }
        done.emplace(i, std::move(result));
        if (shows) hide();
        if (done.size() == 1 && !console.json()) print_heading();
        for (auto next = done.find(reported); next != done.end(); next = done.find(reported)) {
          report(console, next->second, true);
          ++reported;
        }
        if (shows) show();
      },
      static_cast<std::size_t>(jobs));
  if (shows) hide();
  std::size_t passed = 0;
  for (auto& [place, result] : done) {
    if (place >= reported) report(console, result, true);  // an earlier one was interrupted
    passed += result.is_passed() ? 1U : 0U;
    results.push_back(std::move(result));
  }
  if (is_refused) return results;
  if (!console.json()) std::printf("%zu of %zu seeds passed\n", passed, seeds.size());
  if (results.size() < seeds.size())
    console.fail({"run: interrupted after " + std::to_string(results.size()) + " of " + std::to_string(seeds.size()) + " seeds"});
  return results;
}

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

// Shows the simulated time of one run on a terminal. Of many runs at a time, as in campaigns, nobody could read it.
class RunProgress final : public Reporter {
 public:
  explicit RunProgress(Console& console) : console_(console) {}
  void warn(const std::string& text) override { console_.warn(text); }
  void show_progress(double done_s, double all_s) override {
    if (is_shown_) std::fprintf(stderr, "\r%6.1f of %.1f s", done_s, all_s);
  }
  void end_progress() override {
    if (is_shown_) std::fprintf(stderr, "\r                         \r");
  }

 private:
  Console& console_;
  const bool is_shown_ = isatty(STDERR_FILENO) != 0;
};

// Prints one line per run and one per unmet expectation. Without `seeds_text` one run with the seed of the options, else one for each,
// `jobs` of them at a time.
void run(const Session& session, Console& console, const RunOptions& options, const std::optional<std::string>& seeds_text, int jobs) {
  if (const auto good = check_files(options); !good) return console.reject(good.error());
  base::catch_interrupts();
  std::vector<RunResult> results;
  if (seeds_text) {
    const auto seeds = parse_seeds(*seeds_text);
    if (!seeds) return console.reject(seeds.error());
    results = run_seeds(session, console, options, *seeds, jobs);
  } else {
    RunProgress progress(console);
    const auto made = recorded_for_page(options);
    WrittenPage page(options, made);
    const RunHooks hooks{.recording = [&page] { page.begin(); }};
    results.push_back(made.twice ? run_twice(session.orb(), made, progress) : run_system(session.orb(), made, progress, hooks));
    if (!console.json()) report(console, results.back(), false);
    if (page.end(console, results.back())) results.back().page = options.page;
    if (console.json()) report(console, results.back(), false);
    if (!results.back().logs.empty() && options.keep.empty() && !console.json()) console.warn("--keep DIR keeps the logs of all processes");
  }
  if (options.junit.empty()) return;
  if (const auto written = write_junit(options.junit, options, results); !written) console.fail(written.error());
}

// What run_apart() has written.
Result<RunOptions> read_input() {
  const std::string text(std::istreambuf_iterator<char>(std::cin), {});
  return parse_run_options(text);
}

void declare_run(base::Command& app, Chosen& chosen, ReadLike read_like, const std::function<std::string(const std::string&)>& check) {
  auto* run = app.add_subcommand("run", "Run a saved system in a simulated world, in lock step, and check the expectations");
  auto given = std::make_shared<RunOptions>();
  auto seeds = std::make_shared<std::optional<std::string>>();
  auto jobs = std::make_shared<int>(1);
  auto like = std::make_shared<std::string>();
  auto has_input = std::make_shared<bool>(false);
  std::vector<std::string_view> names;
  for (const auto& row : run_option_rows) {
    if (!read_like || row.name != "system") names.push_back(row.name);
  }
  add_run_options(*run, *given, names);
  if (read_like) {
    run->add_option("--like", *like, "Repeat the run of this recording (of rtse run --record)")->required()->check(base::valid_file(check));
  } else {
    run->option("SYSTEM")->required();
    run->option("--world")->required();
  }
  run->add_option("--seeds", *seeds, "Run once per seed FIRST..LAST")->excludes(run->option("--seed"))->check([](const std::string& text) {
    const auto parsed = parse_seeds(text);
    return parsed ? std::string() : parsed.error().message;
  });
  run->add_option("-j,--jobs", *jobs, "Number of seeds to run in parallel")->check(base::integer_between(1, 64))->capture_default_str();
  run->add_flag(options_from_input, *has_input)->group("");  // of run_apart() alone
  run->callback([=, &chosen] {
    chosen.work = [=](const Session& session, Console& console) {
      auto base = read_like ? read_like(console, *like) : *has_input ? read_input() : RunOptions();
      if (!base) return console.reject(base.error());
      tools::run(session, console, with_given(std::move(*base), *given, *run), *seeds, *jobs);
    };
  });
}

}  // namespace

void add_run(base::Command& app, Chosen& chosen) { declare_run(app, chosen, nullptr, nullptr); }

void add_run_like(base::Command& app, Chosen& chosen, ReadLike read_like, std::function<std::string(const std::string&)> check) {
  declare_run(app, chosen, std::move(read_like), check);
}

}  // namespace tools
