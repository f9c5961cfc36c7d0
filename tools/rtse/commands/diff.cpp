// diff: where two runs differ first.
#include <unistd.h>

#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <vector>

#include "base/child_process.h"
#include "rtse/command.h"
#include "rtse/commands/commands.h"
#include "run/hash_report.h"
#include "run/run_hashes.h"

namespace tools {
namespace {

bool is_recording(const std::string& file) {
  std::string start(5, '\0');
  std::ifstream(file, std::ios::binary).read(start.data(), static_cast<std::streamsize>(start.size()));
  return start == "\x89MCAP";
}

void diff(Console& console, const std::string& a, const std::string& b) {
  if (is_recording(a) && is_recording(b)) {
    const auto program = base::own_program("rtse-recorder");
    std::vector<const char*> words = {program.c_str(), "recording", "compare", a.c_str(), b.c_str(), nullptr};
    if (console.json()) words.insert(words.begin() + 1, "--json");
    execv(program.c_str(), const_cast<char* const*>(words.data()));  // it changes none of them
    return console.fail({"program " + program + ": cannot be started; expected it beside rtse"});
  }
  const auto comparison = base::compare_hash_logs(a, b);
  if (!comparison) return console.reject(comparison.error());
  const auto difference = difference_text(*comparison);
  if (console.json()) {
    std::cout << difference_json(*comparison).dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << '\n';
  } else if (difference.empty()) {
    std::printf("the same in %llu ticks, hash %s\n", static_cast<unsigned long long>(comparison->ticks),
                hash_text(comparison->hash).c_str());
  }
  if (!difference.empty()) console.fail({difference});
}

}  // namespace

void add_diff(base::Command& app, Chosen& chosen) {
  auto* command =
      app.add_subcommand("diff", "Compare two runs: hash logs of rtse run --hash-log, or recordings; name the first difference");
  auto files = std::make_shared<std::pair<std::string, std::string>>();
  command->add_option("RUN1", files->first, "Hash log or recording")->required()->check(base::existing_file());
  command->add_option("RUN2", files->second, "Hash log or recording to compare with")->required()->check(base::existing_file());
  command->callback([&chosen, files] {
    chosen.needs_orb = false;
    chosen.work = [files](const Session&, Console& console) { diff(console, files->first, files->second); };
  });
}

}  // namespace tools
