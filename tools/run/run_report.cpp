// What a run has shown, and the same as JUnit XML.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <pugixml.hpp>

#include "base/text.h"
#include "run/run_files.h"
#include "run/run_system.h"

namespace editor {
namespace {

std::string seconds(double time) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3f", time);
  return text;
}

class Suite {
 public:
  explicit Suite(const std::string& name) : node_(document_.append_child("testsuite")) { node_.append_attribute("name") = name.c_str(); }

  pugi::xml_node add(const std::string& group, const std::string& name, double time) {
    auto test = node_.append_child("testcase");
    test.append_attribute("classname") = printable(group).c_str();
    test.append_attribute("name") = printable(name).c_str();
    test.append_attribute("time") = seconds(time).c_str();
    ++tests_;
    seconds_ += time;
    return test;
  }
  void fail(pugi::xml_node test, const std::string& why, const std::string& details) {
    auto node = test.append_child("failure");
    node.append_attribute("message") = printable(why).c_str();
    if (!details.empty()) node.text().set(printable(details).c_str());
    ++failures_;
  }
  void error(pugi::xml_node test, const std::string& why, const std::string& details) {
    auto node = test.append_child("error");
    node.append_attribute("message") = printable(why).c_str();
    ++errors_;
    if (!details.empty()) test.append_child("system-err").text().set(printable(details).c_str());
  }
  bool save(const std::string& file) {
    node_.append_attribute("tests") = tests_;
    node_.append_attribute("failures") = failures_;
    node_.append_attribute("errors") = errors_;
    node_.append_attribute("time") = seconds(seconds_).c_str();
    return document_.save_file(file.c_str(), "  ");
  }

 private:
  pugi::xml_document document_;
  pugi::xml_node node_;
  int tests_ = 0, failures_ = 0, errors_ = 0;
  double seconds_ = 0;
};

}  // namespace

bool RunResult::is_passed() const {
  return problem.empty() && std::all_of(verdicts.begin(), verdicts.end(), [](const Verdict& verdict) { return verdict.problem.empty(); });
}

Result<void> write_junit(const std::string& file, const RunOptions& options, const std::vector<RunResult>& results) {
  Suite suite(std::filesystem::path(options.system).stem().string());
  const auto world = std::filesystem::path(options.world).stem().string();
  for (const auto& result : results) {
    const auto group = world + ".seed_" + std::to_string(result.seed);
    auto whole = suite.add(group, "runs for " + base::format_number(options.duration_s) + " s", result.wall_s);
    if (!result.problem.empty()) suite.error(whole, result.problem, result.logs);
    if (!result.state_hash.empty()) whole.append_child("system-out").text().set(("state " + result.state_hash).c_str());
    for (const auto& verdict : result.verdicts) {
      const auto test = suite.add(group, verdict.expectation, 0);
      if (!verdict.problem.empty()) suite.fail(test, verdict.problem, verdict.details);
    }
  }
  if (!suite.save(file)) return Error{"file " + base::in_quotes(file) + ": cannot be written"};
  return {};
}

}  // namespace editor
