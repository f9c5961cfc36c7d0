// A run file: the third-party processes that a run starts beside our component hosts, as YAML. Values; any thread.
//
//   processes:
//     - command: python3 controller.py    # a line for sh
//       folder: controller                # where it is started; relative to the run file; default: the folder of the run file
//       environment: {PYTHONPATH: lib}
//       wait: 30                          # [s] of real time, for its components to be on the name server; without it --start-timeout
//       components:                       # of the system, by their instance names
//         - Controller0
//         - {name: Filter0, phase: 2, rate: 50, join: tick}
//
// phase: default 1; rate [Hz]: default that of the profile; join: how they take part in simulated time (TimeMember::How). Unknown keys,
// wrong kinds and values are rejected with one line that names the file, the place and what was expected.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "run/time_members.h"

namespace tools {

struct ForeignComponent {
  std::string instance;
  std::optional<int> phase{};
  std::string rate{};  // empty: not said
  TimeMember::How how = TimeMember::How::member;
};

struct ForeignProcess {
  std::string command;
  std::string folder{};  // empty: that of rtse
  std::map<std::string, std::string> environment{};
  std::optional<double> wait_s{};
  std::vector<ForeignComponent> components{};
};

base::Result<std::vector<ForeignProcess>> parse_run_file(const std::string& text, const std::string& file);
base::Result<std::vector<ForeignProcess>> read_run_file(const std::string& file);

}  // namespace tools
