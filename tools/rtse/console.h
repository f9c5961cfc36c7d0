// Output of a command of rtse: results on standard output, as text or JSON; problems on standard error, as "rtse: ...". It knows whether
// the command failed, for the exit code. warn() may be called on any thread, everything else on one at a time.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "base/result.h"
#include "system/reporter.h"

namespace tools {

class Console final : public Reporter {
 public:
  explicit Console(bool json) : json_(json) {}

  // The user wants JSON.
  bool json() const { return json_; }
  void print(const nlohmann::ordered_json& value) const;
  // Prints the error; the command has failed.
  void fail(const base::Error& error);
  void fail(const std::vector<base::Error>& errors);
  // The same of what the user has asked for: the exit code is that of a wrong command line.
  void reject(const base::Error& error);
  // For a failure that is printed in another way.
  void set_failed() { failed_ = true; }
  bool failed() const { return failed_; }
  int exit_code() const { return is_rejected_ ? 2 : failed_ ? 1 : 0; }

  void warn(const std::string& text) override;

 private:
  const bool json_;
  bool failed_ = false;
  bool is_rejected_ = false;
};

}  // namespace tools
