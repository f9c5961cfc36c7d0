#include "run/stopped_process.h"

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "base/text.h"

namespace tools {
namespace {

const std::filesystem::path all("/proc");

struct Status {
  char state = ' ';  // T: by a signal, t: by a debugger
  pid_t group = 0;
  bool is_stopped() const { return state == 'T' || state == 't'; }
};

// Of /proc/PID/stat: "PID (NAME) STATE PARENT GROUP ..."; a name may have any characters.
Status status_of(const std::filesystem::path& process) {
  std::string text;
  std::getline(std::ifstream(process / "stat"), text, '\0');
  std::istringstream words(text.substr(text.find_last_of(')') + 1));
  Status status;
  pid_t parent = 0;
  words >> status.state >> parent >> status.group;
  return status;
}

}  // namespace

bool is_stopped(pid_t pid) { return status_of(all / std::to_string(pid)).is_stopped(); }

std::optional<pid_t> stopped_process(pid_t pid) {
  if (is_stopped(pid)) return pid;
  std::error_code ignored;  // processes come and go
  for (const auto& entry : std::filesystem::directory_iterator(all, ignored)) {
    const auto other = base::parse_integer(entry.path().filename().string());
    if (!other) continue;
    const auto status = status_of(entry.path());
    if (status.group == pid && status.is_stopped()) return static_cast<pid_t>(*other);
  }
  return std::nullopt;
}

}  // namespace tools
