// JUnit XML as continuous integration reads it: one suite of test cases. Texts may hold any bytes. One thread at a time.
#pragma once

#include <string>
#include <vector>

#include "base/result.h"

namespace tools {

struct JunitCase {
  enum class Outcome { passed, failed, broken } outcome = Outcome::passed;  // failed: an expectation; broken: it did not run to its end
  std::string group, name;
  double wall_s = 0;
  std::string problem{}, details{};  // of one that did not pass
  std::string output{}, errors{};    // of its programs
  std::string attachment{};          // a file that GitLab and Jenkins show beside the case; empty: none
};

// Attachments are named in "system-out": relative to CI_PROJECT_DIR where GitLab sets it, else absolute, as Jenkins expects it. A file that
// cannot be written is an Error.
base::Result<void> write_junit_suite(const std::string& file, const std::string& name, const std::vector<JunitCase>& cases);

}  // namespace tools
