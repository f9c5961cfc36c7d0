#include "page/failure_marks.h"

#include <gtest/gtest.h>

namespace page {
namespace {

using namespace std::chrono_literals;

studio::RecordingFacts facts() {
  studio::RecordingFacts facts;
  facts.to = 10s;
  facts.components =
      Json::parse(R"([{"path": "/host/RTCLaser0.rtc", "instance": "RTCLaser0"}, {"path": "/host/Laser0.rtc", "instance": "Laser0"}])");
  facts.states["/host/Laser0.rtc"] = {{0.0, "Active"}, {4.5, "Error"}, {6.0, "Inactive"}};
  return facts;
}

const Json models = Json::parse(R"([{"name": "pioneer2dx"}])");

Json marked(const std::string& failures, Json more = Json::object()) {
  more["failures"] = Json::parse(failures);
  mark_failures(more, facts(), models);
  return more;
}

TEST(FailureMarks, the_page_opens_at_the_first_failure_with_its_object) {
  const auto summary = marked(R"([{"text": "late", "time": 8, "subject": "b"}, {"text": "early", "time": 3, "subject": "a"}])");
  EXPECT_EQ(summary["at"], 3);
  EXPECT_EQ(summary["select"], "a");
  EXPECT_EQ(summary["marks"].size(), 2U);
  EXPECT_EQ(summary["marks"][0]["text"], "early");
  EXPECT_FALSE(summary.contains("failures"));
}

TEST(FailureMarks, an_event_before_the_failure_does_not_open_the_page) {
  const auto summary =
      marked(R"([{"text": "x", "time": 3}])", Json::parse(R"({"marks": [{"time": 1, "kind": "fault", "text": "noise"}]})"));
  EXPECT_EQ(summary["at"], 3);
  EXPECT_EQ(summary["marks"][0]["kind"], "fault");
}

TEST(FailureMarks, a_failure_without_object_is_about_the_first_name_in_its_text) {
  EXPECT_EQ(marked(R"([{"text": "component Laser0 is Error"}])")["select"], "Laser0");
  EXPECT_EQ(marked(R"([{"text": "host of RTCLaser0, Laser0 was killed"}])")["select"], "RTCLaser0");
  EXPECT_EQ(marked(R"([{"text": "model pioneer2dx: fell"}])")["select"], "pioneer2dx");
  EXPECT_FALSE(marked(R"([{"text": "run: interrupted"}])").contains("select"));
}

TEST(FailureMarks, a_component_in_error_fails_when_it_enters_that_state) {
  EXPECT_EQ(marked(R"([{"text": "component Laser0 is Error"}])")["at"], 4.5);
}

TEST(FailureMarks, a_failure_of_unknown_time_is_at_the_end_of_the_run) {
  EXPECT_EQ(marked(R"([{"text": "x"}])")["at"], 10);
  EXPECT_EQ(marked(R"([{"text": "x"}])", Json::parse(R"({"simulated": 7.5})"))["at"], 7.5);
  EXPECT_EQ(marked(R"([{"text": "x", "time": 1e9}])")["at"], 10) << "no time is behind the recording";
}

TEST(FailureMarks, a_passed_run_opens_at_its_begin) { EXPECT_FALSE(marked("[]").contains("at")); }

}  // namespace
}  // namespace page
