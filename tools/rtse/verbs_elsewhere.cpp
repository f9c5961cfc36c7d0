#include "rtse/verbs_elsewhere.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>

#include "rtse/command.h"

namespace tools {

namespace {

struct Verb {
  std::string_view name;
  std::string_view program;
  std::string_view description;
};

constexpr std::array verbs = {
    Verb{"demo", "rtse-demo", "Show a driving robot: simulator, components, connections, an image"},
    Verb{"record", "rtse-recorder", "Record the samples of ports into an MCAP file"},
    Verb{"play", "rtse-recorder", "Send a recording into the ports of a running system"},
    Verb{"sweep", "rtse-campaign", "Run all rows of a campaign's plan and store their results"},
    Verb{"hunt", "rtse-campaign", "Search for faults, events and parameters that violate the plan"},
    Verb{"results", "rtse-campaign", "Show the results of a campaign: tables, rates, pages"},
    Verb{"replay", "rtse-recorder", "Send recorded inputs to one component and compare its outputs"},
    Verb{"goto", "rtse-recorder", "Repeat a recorded run and stop at a given time"},
    Verb{"page", "rtse-recorder", "Write a recording, or two to compare, as one HTML page"},
    Verb{"recording", "rtse-recorder", "Inspect recordings: info, ls, cat, export, compare, repair"},
};

constexpr std::array<std::string_view, 2> options_with_value = {"--ns", "--call-timeout"};

// `rtse run --like FILE` reads a recording.
constexpr Verb run_like{"run", "rtse-recorder", ""};

bool is_like(int argc, char** argv) {
  return std::any_of(argv + 1, argv + argc,
                     [](const char* word) { return std::string_view(word) == "--like" || std::string_view(word).starts_with("--like="); });
}

// The verb that stands where a command is expected; with --complete only when the cursor is behind it.
const Verb* verb_of(int argc, char** argv) {
  const bool completes = argc > 1 && std::string_view(argv[1]) == "--complete";
  for (int i = completes ? 2 : 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    if (std::find(options_with_value.begin(), options_with_value.end(), word) != options_with_value.end()) {
      ++i;
      continue;
    }
    if (word.starts_with("-")) continue;
    if (completes && i + 1 == argc) return nullptr;
    if (!completes && word == run_like.name && is_like(argc, argv)) return &run_like;
    const auto verb = std::find_if(verbs.begin(), verbs.end(), [&](const Verb& one) { return one.name == word; });
    return verb == verbs.end() ? nullptr : &*verb;
  }
  return nullptr;
}

std::string path_of(const Verb& verb) {
  std::error_code error;
  return (std::filesystem::read_symlink("/proc/self/exe", error).parent_path() / verb.program).string();
}

}  // namespace

void become_program_of_verb(int argc, char** argv) {
  const Verb* verb = verb_of(argc, argv);
  if (!verb) return;
  const auto path = path_of(*verb);
  ::execv(path.c_str(), argv);
  if (std::string_view(argv[1]) == "--complete") return;
  std::fprintf(stderr, "rtse: program %s: cannot be started; expected it beside rtse\n", path.c_str());
  std::_Exit(1);
}

void add_verbs_elsewhere(base::Command& app, Chosen&) {
  for (const Verb& verb : verbs) app.add_subcommand(std::string(verb.name), std::string(verb.description))->prefix_command();
}

}  // namespace tools
