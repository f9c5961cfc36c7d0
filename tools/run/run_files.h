// The folder of a run's files, and the content of its logs. One thread at a time.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/abnormal_exit.h"
#include "base/scratch_folder.h"

namespace tools {

inline constexpr const char* scratch_prefix = "rtse-run-";  // of temporary folders of runs

// A folder for what is to be looked at afterwards, and one for everything else, which is gone at the end.
class Workplace {
 public:
  // `keep`: the folder for logs and records, made if need be; empty: the temporary one. Throws std::filesystem::filesystem_error.
  explicit Workplace(const std::string& keep);

  // A new file among those to be looked at.
  std::string new_file(const std::string& name) const;
  std::string file(const std::string& name) const { return (files_ / name).string(); }
  std::string scratch(const std::string& name) const { return scratch_.path() + "/" + name; }

 private:
  base::ScratchFolder scratch_;
  std::filesystem::path files_;
};

// Of the folder of a run.
std::string folder_problem(const std::filesystem::filesystem_error& error);

std::vector<std::string> lines_of(const std::string& file);
// Of a line of a log of rtcd or sim-server.
enum class LogLevel { none, info, warning, error };
LogLevel level_of(const std::string& line);
// The line of a log that tells most: the first error, else the last warning, else the last line.
std::string telling_line(const std::string& file);
// ": " and that line when it is a warning or an error; else nothing.
std::string complaint(const std::string& file);
// What a process that ended suddenly had written last: up to three lines that are no lines of its log, as of an exception that nobody
// caught; where there are none, its complaint. Begins with ": "; nothing when there is nothing to say.
std::string last_output(const std::string& file);
// "ValueError: no scan", of the last traceback of Python; empty: there is none.
std::string last_line_of_traceback(const std::string& file);
// The callback in which the process ended, if it has said so; see base/abnormal_exit.h.
std::optional<base::AbnormalExit> abnormal_exit_in(const std::string& file);
// The last 40 lines, each with its end.
std::string tail_of(const std::vector<std::string>& lines);
// The last lines of a log under its name; nothing for one that is empty.
std::string last_lines(const std::string& file);
// What is no UTF-8, or no character that XML 1.0 allows, becomes a question mark.
std::string printable(std::string_view text);

}  // namespace tools
