// Receives what a long operation reports before it returns. The caller of the operation decides where that is shown.
#pragma once

#include <string>

namespace tools {

// Implementations accept calls from any thread.
class Reporter {
 public:
  virtual ~Reporter() = default;
  // One line for a person: something takes long, was replaced or was left out, and the operation continues.
  virtual void warn(const std::string& text) = 0;
  // Simulated time so far, and at the end [s]; about once a second of wall-clock time.
  virtual void show_progress(double /*done_s*/, double /*all_s*/) {}
  // After the last show_progress().
  virtual void end_progress() {}
};

// For operations whose result says enough.
class SilentReporter final : public Reporter {
 public:
  void warn(const std::string&) override {}
};

}  // namespace tools
