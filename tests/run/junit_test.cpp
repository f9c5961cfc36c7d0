#include "run/junit.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace tools {
namespace {

// The text of a suite with one case, which has this attachment.
std::string suite_with(const std::string& attachment, const std::string& output) {
  const auto file = std::filesystem::path(testing::TempDir()) / ("junit-" + std::to_string(getpid()) + ".xml");
  EXPECT_TRUE(write_junit_suite(file.string(), "suite", {{.group = "g", .name = "n", .output = output, .attachment = attachment}}).ok());
  std::stringstream text;
  text << std::ifstream(file).rdbuf();
  std::filesystem::remove(file);
  return text.str();
}

class Junit : public testing::Test {
 protected:
  void SetUp() override { unsetenv("CI_PROJECT_DIR"); }
  void TearDown() override { unsetenv("CI_PROJECT_DIR"); }
};

TEST_F(Junit, an_attachment_is_an_absolute_path_on_a_line_of_its_own) {
  const auto path = (std::filesystem::current_path() / "out/run.html").string();
  EXPECT_NE(suite_with("out/run.html", "state 1").find("<system-out>state 1\n[[ATTACHMENT|" + path + "]]</system-out>"), std::string::npos);
}

TEST_F(Junit, in_a_job_of_gitlab_an_attachment_is_relative_to_the_project) {
  setenv("CI_PROJECT_DIR", std::filesystem::current_path().c_str(), 1);
  EXPECT_NE(suite_with("out/run.html", "").find("<system-out>[[ATTACHMENT|out/run.html]]</system-out>"), std::string::npos);
  EXPECT_NE(suite_with("/elsewhere/run.html", "").find("[[ATTACHMENT|/elsewhere/run.html]]"), std::string::npos);
}

TEST_F(Junit, without_an_attachment_there_is_none) { EXPECT_EQ(suite_with("", "").find("system-out"), std::string::npos); }

}  // namespace
}  // namespace tools
