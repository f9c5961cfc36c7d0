// The configuration of a manager: built-in defaults, the file, what the system says, then the command line. One thread at a time.
#pragma once

#include <coil/Properties.h>

#include <map>
#include <string>
#include <vector>

namespace RTC {

class ManagerConfig {
 public:
  static const char* const default_config[];    // key, value, ..., ""
  static const char* const config_file_path[];  // where rtc.conf is looked for, after -f, RTC_MANAGER_CONFIG and ./rtc.conf

  ManagerConfig() = default;
  ManagerConfig(int argc, char** argv) { init(argc, argv); }

  // False if the command line or the file is wrong: error() says why and exitCode() is 1 or 2.
  bool init(int argc, char** argv, bool strict = false);
  void configure(coil::Properties& properties) const;

  const std::string& error() const { return error_; }
  int exitCode() const { return exit_code_; }
  // The file that was read; empty if none.
  const std::string& configFile() const { return file_; }
  // One line per unknown or malformed key, with file and line.
  const std::vector<std::string>& warnings() const { return warnings_; }
  // Where each key that somebody has set comes from: `file:line` or `option -o`.
  const std::map<std::string, std::string>& origins() const { return origins_; }

 private:
  coil::Properties properties_;
  std::string file_;
  std::string error_;
  int exit_code_ = 0;
  std::vector<std::string> warnings_;
  std::map<std::string, std::string> origins_;
};

}  // namespace RTC
