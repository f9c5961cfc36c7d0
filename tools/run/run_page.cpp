#include "run/run_page.h"

#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <filesystem>

#include "base/text.h"
#include "run/run_options.h"

namespace tools {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::chrono::minutes longest_writing{30};
constexpr std::chrono::seconds given_up_limit{5};
constexpr std::string_view share_beside_run = "0.015";  // of a processor, so that the run loses less than 2 %
constexpr int killed_by = 128;                          // exit codes above it: the signal

Error about(const std::string& page, const std::string& what) { return {"page " + base::in_quotes(page) + ": " + what}; }

// A failure: its text, and if they are known its time and object.
Json failure(const std::string& text, const std::optional<double>& time, const std::string& subject) {
  Json json{{"text", text}};
  if (time) json["time"] = *time;
  if (!subject.empty()) json["subject"] = subject;
  return json;
}

std::vector<std::string> words_of(const PageCall& call) {
  return {base::own_program("rtse-page"),
          call.recording,
          "--output",
          call.file,
          "--page-camera-rate",
          base::format_number(call.camera_rate),
          "--page-limit",
          base::format_number(call.limit_mib)};
}

std::string text_of(const Json& summary) { return summary.dump(-1, ' ', false, Json::error_handler_t::replace); }

std::string without(std::string text, const std::string& prefix) { return text.starts_with(prefix) ? text.substr(prefix.size()) : text; }

// What it printed, once it has ended.
Result<std::string> answer_of(base::ChildProcess& child, const PageCall& call) {
  const auto ending = child.wait_or_interrupt(longest_writing);
  if (ending == base::Ending::interrupted) return about(call.file, "not written, since the run was interrupted");
  if (ending == base::Ending::ended && child.exit_code() == 0) return child.said();
  const auto said = base::split_list(child.said(), '\n');
  if (said.empty()) return about(call.file, "rtse-page " + child.how_it_ended());
  auto text = without(without(said.back(), "rtse-page: "), call.file + ": ");
  for (const auto& name : {base::in_quotes(call.recording), call.recording}) {
    const auto at = call.is_temporary ? text.find(name) : std::string::npos;
    if (at != std::string::npos) text.replace(at, name.size(), "the recording of the run");
  }
  return about(call.file, text);
}

}  // namespace

void add_page_options(base::Command& command, PageCall& call) {
  const auto add = [&](std::string_view name, double& value) {
    const auto* row = std::ranges::find(run_option_rows, name, &RunOptionRow::name);
    command.add_option("--" + std::string(name), value, std::string(row->help))
        ->check(base::number_between(row->low, row->high))
        ->capture_default_str();
  };
  add("page-camera-rate", call.camera_rate);
  add("page-limit", call.limit_mib);
}

Json page_summary(const RunResult& result, const std::string& command) {
  Json summary{{"passed", result.is_passed()}, {"why", Json::array()},      {"failures", Json::array()}, {"marks", Json::array()},
               {"seed", result.seed},          {"hash", result.state_hash}, {"command", command},        {"simulated", result.simulated_s}};
  const auto add = [&](const std::string& text, const std::optional<double>& time, const std::string& subject) {
    summary["why"].push_back(text);
    summary["failures"].push_back(failure(text, time, subject));
  };
  if (!result.problem.empty()) add(result.problem, result.simulated_s, "");
  for (const auto& verdict : result.verdicts) {
    if (!verdict.problem.empty()) add(failure_text(verdict), verdict.time, verdict.subject);
  }
  for (const auto& mark : result.marks) {
    if (mark.time <= result.simulated_s)
      summary["marks"].push_back({{"time", mark.time}, {"kind", mark.kind}, {"text", mark.text}, {"subject", mark.subject}});
  }
  return summary;
}

Result<std::string> write_run_page(const PageCall& call, const Json& summary) {
  std::error_code none;
  for (const std::string& recording : {call.recording, call.other}) {
    if (!recording.empty() && std::filesystem::equivalent(call.file, recording, none))
      return about(call.file, "is the recording; expected another file");
  }
  auto words = words_of(call);
  words.emplace_back("--summary");
  if (!call.other.empty()) words.insert(words.end(), {"--other", call.other});
  auto page = PageBesideRun::start(call, words);
  return page ? page->written(summary) : page.error();
}

Result<PageBesideRun> PageBesideRun::start(const PageCall& call) {
  auto words = words_of(call);
  words.insert(words.end(), {"--follow", std::string(share_beside_run)});
  return start(call, words);
}

Result<PageBesideRun> PageBesideRun::start(const PageCall& call, const std::vector<std::string>& words) {
  std::array<int, 2> ends{-1, -1};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) return about(call.file, "no socket for rtse-page");
  base::FileHandle ours(ends[0]), theirs(ends[1]);
  auto child = base::ChildProcess::start({.words = words, .environment = {}, .input = theirs.get()});
  if (!child) return about(call.file, child.error().message);
  return PageBesideRun(call, std::move(*child), std::move(ours));
}

PageBesideRun::~PageBesideRun() {
  if (line_.get() < 0) return;
  line_ = base::FileHandle();
  process_.wait(given_up_limit);
}

Result<std::string> PageBesideRun::finish(const Json& summary) {
  auto answer = written(summary);
  const bool was_killed = !answer && !process_.is_running() && process_.exit_code() > killed_by;
  return was_killed ? write_run_page(call_, summary) : answer;
}

Result<std::string> PageBesideRun::written(const Json& summary) {
  const base::FileHandle line = std::exchange(line_, base::FileHandle());
  const auto text = text_of(summary);
  for (std::string_view rest = text; !rest.empty() && process_.is_running();) {
    const auto sent = ::send(line.get(), rest.data(), rest.size(), MSG_NOSIGNAL);
    if (sent <= 0) break;
    rest.remove_prefix(static_cast<std::size_t>(sent));
  }
  ::shutdown(line.get(), SHUT_RDWR);
  return answer_of(process_, call_);
}

}  // namespace tools
