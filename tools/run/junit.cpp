#include "run/junit.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <pugixml.hpp>

#include "base/text.h"
#include "run/run_files.h"

namespace tools {
namespace {

void set_text(pugi::xml_node node, const char* name, const std::string& text) { node.append_attribute(name) = printable(text).c_str(); }

void set_seconds(pugi::xml_node node, double time) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3f", time);
  set_text(node, "time", text);
}

void add_text(pugi::xml_node parent, const char* name, const std::string& text) {
  if (!text.empty()) parent.append_child(name).text().set(printable(text).c_str());
}

std::string attachment_line(const std::string& file) {
  if (file.empty()) return "";
  std::error_code ignored;
  auto path = std::filesystem::absolute(file, ignored).lexically_normal();
  if (const char* project = std::getenv("CI_PROJECT_DIR")) {
    const auto relative = path.lexically_relative(std::filesystem::path(project).lexically_normal());
    if (!relative.empty() && *relative.begin() != "..") path = relative;
  }
  return "[[ATTACHMENT|" + path.string() + "]]";
}

}  // namespace

base::Result<void> write_junit_suite(const std::string& file, const std::string& name, const std::vector<JunitCase>& cases) {
  pugi::xml_document document;
  auto suite = document.append_child("testsuite");
  set_text(suite, "name", name);
  double seconds = 0;
  for (const auto& one : cases) {
    seconds += one.wall_s;
    auto test = suite.append_child("testcase");
    set_text(test, "classname", one.group);
    set_text(test, "name", one.name);
    set_seconds(test, one.wall_s);
    if (one.outcome != JunitCase::Outcome::passed) {
      auto problem = test.append_child(one.outcome == JunitCase::Outcome::broken ? "error" : "failure");
      set_text(problem, "message", one.problem);
      if (!one.details.empty()) problem.text().set(printable(one.details).c_str());
    }
    const bool has_both = !one.output.empty() && !one.attachment.empty();
    add_text(test, "system-out", one.output + (has_both ? "\n" : "") + attachment_line(one.attachment));
    add_text(test, "system-err", one.errors);
  }
  suite.append_attribute("tests") = static_cast<unsigned long long>(cases.size());
  suite.append_attribute("failures") = static_cast<long long>(std::ranges::count(cases, JunitCase::Outcome::failed, &JunitCase::outcome));
  suite.append_attribute("errors") = static_cast<long long>(std::ranges::count(cases, JunitCase::Outcome::broken, &JunitCase::outcome));
  set_seconds(suite, seconds);
  if (!document.save_file(file.c_str(), "  ")) return base::Error{"file " + base::in_quotes(file) + ": cannot be written"};
  return {};
}

}  // namespace tools
