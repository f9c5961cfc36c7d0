// rtse-page: a recording as one HTML file. `rtse recording export --html` and `rtse run --page` start it.
#include <signal.h>

#include <iostream>
#include <new>

#include "base/command_line.h"
#include "base/output_name.h"
#include "base/text.h"
#include "base/valid_file.h"
#include "page/followed_run.h"
#include "page/run_page.h"
#include "recording/ring.h"
#include "studio/page_files.h"

namespace {

constexpr double largest_page = 4096;  // [MiB]
constexpr double bytes_per_mib = 1 << 20;

struct Settings {
  page::PageOptions page;
  double limit_mib = 64;
  bool has_summary = false;
  double share = 0;  // of a processor for a recording that is followed; 0: it is complete
};

void add_options(base::Command& app, Settings& settings) {
  app.add_option("RECORDING", settings.page.recording, "Recording (MCAP)")->required();
  app.add_option("-o,--output", settings.page.file, "HTML file to write")->required()->check(base::output_name());
  app.add_option("--other", settings.page.second, "Recording to compare with (MCAP); its models are shown as ghosts")
      ->check(base::valid_file(recorder::recording_format_problem));
  app.add_option("--page-camera-rate", settings.page.camera_rate, "Images of each camera per simulated second; 0: none")
      ->check(base::number_between(0, 1000.0))
      ->capture_default_str();
  app.add_option("--page-limit", settings.limit_mib, "Maximum size of the page [MiB]")
      ->check(base::number_between(1.0, largest_page))
      ->capture_default_str();
  app.add_flag("--summary", settings.has_summary, "Read the result of the run from the standard input, JSON (from rtse)");
  app.add_option(
         "--follow", settings.share,
         "Follow a recording that is being written, with this share of a processor; its result comes by the standard input when it is "
         "complete (from rtse)")
      ->check(base::number_between(0, 1.0));
  app.add_option("--viewer", settings.page.viewer, "run.html of the built page of rtm-studio")->capture_default_str();
}

int fail(const base::Error& error, int code = 1) {
  std::cerr << "rtse-page: " << error.message << '\n';
  return code;
}

int write_page(Settings& settings) {
  settings.page.limit = static_cast<std::uint64_t>(settings.limit_mib * bytes_per_mib);
  if (settings.has_summary) {
    settings.page.summary = studio::Json::parse(std::cin, nullptr, false);
    if (!settings.page.summary.is_object()) return fail({"the result of the run is not a JSON object"});
  }
  const auto problem = settings.share == 0 ? recorder::recording_format_problem(settings.page.recording) : std::string();
  if (!problem.empty()) return fail({problem}, 2);
  page::FollowedRun run(settings.share);
  if (settings.share > 0) {
    ::signal(SIGINT, SIG_IGN);  // it is for the run, which then ends our input
    settings.page.follow = [&run](studio::Json& summary) { return run.wait(summary); };
  }
  const auto report = page::write_run_page(settings.page);
  if (!report) return fail(report.error());
  std::cout << settings.page.file << ": " << (report->bytes + 1023) / 1024 << " KiB\n";
  for (const auto& line : report->left_out) std::cout << "left out: " << base::printable(line) << '\n';
  return 0;
}

int page_of(int argc, char** argv) {
  base::Command app{"rtse-page: writes a recording as one HTML file that a browser opens without a server and without a network"};
  base::add_standard_options(app, "rtse-page", RTMSIM_VERSION);
  Settings settings;
  settings.page.viewer = studio::default_page_folder() + "/run.html";
  add_options(app, settings);
  if (const auto end = base::parse_command_line(app, "rtse-page", argc, argv)) return *end;
  return write_page(settings);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return page_of(argc, argv);
  } catch (const std::bad_alloc&) {
    return fail({"out of memory"});
  } catch (const std::exception& e) {
    return fail({e.what()});
  }
}
