#include "run/run_files.h"

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <sstream>

#include "base/text.h"

namespace tools {
namespace {

base::ScratchFolder made_scratch() {
  errno = ENOTDIR;  // where nothing else is said
  auto made = base::ScratchFolder::make(scratch_prefix);
  if (!made) throw std::filesystem::filesystem_error(made.error().message, {}, std::error_code(errno, std::generic_category()));
  return std::move(*made);
}

// How many octets the UTF-8 character at the start has; 0: it is none, or none that XML 1.0 allows.
std::size_t character_at(std::string_view text) {
  const auto octet = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U; };
  const unsigned first = octet(0);
  if (first < 0x80) return first >= 0x20 || first == '\n' || first == '\t' ? 1 : 0;
  const std::size_t size = first >= 0xf0 && first < 0xf5 ? 4 : first >= 0xe0 ? 3 : 2;
  if (first < 0xc2 || first >= 0xf5) return 0;
  unsigned code = first & (0x7fU >> size);
  for (std::size_t i = 1; i < size; ++i) {
    if ((octet(i) & 0xc0U) != 0x80U) return 0;
    code = code << 6U | (octet(i) & 0x3fU);
  }
  const bool is_shortest = size == 2 || code >= (size == 3 ? 0x800U : 0x10000U);
  const bool is_character = (code < 0xd800 || code > 0xdfff) && code < 0xfffe;
  return is_shortest && (is_character || (code >= 0x10000 && code < 0x110000)) ? size : 0;
}

}  // namespace

Workplace::Workplace(const std::string& keep)
    : scratch_(made_scratch()), files_(keep.empty() ? std::filesystem::path(scratch_.path()) : std::filesystem::absolute(keep)) {
  std::filesystem::create_directory(scratch("names"));
  std::filesystem::create_directory(scratch("tmp"));
  std::filesystem::create_directories(files_);
}

std::string Workplace::new_file(const std::string& name) const {
  std::error_code ignored;  // then it cannot be opened either, which is said
  std::filesystem::remove(files_ / name, ignored);
  return file(name);
}

std::vector<std::string> lines_of(const std::string& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return base::split_list(text.str(), '\n');
}

LogLevel level_of(const std::string& line) {
  const auto has = [&](const char* one, const char* other) {
    return line.find(one) != std::string::npos || line.find(other) != std::string::npos;
  };
  if (has(" ERROR: ", " error: ")) return LogLevel::error;
  if (has(" WARN: ", " warning: ")) return LogLevel::warning;
  return has(" INFO: ", " info: ") ? LogLevel::info : LogLevel::none;
}

std::string telling_line(const std::string& file) {
  const auto lines = lines_of(file);
  std::string telling = lines.empty() ? "its log is empty" : lines.back();
  for (const auto& line : lines) {
    if (level_of(line) == LogLevel::error) return line;
    if (level_of(line) == LogLevel::warning) telling = line;
  }
  return telling;
}

std::string complaint(const std::string& file) {
  const auto line = telling_line(file);
  const auto level = level_of(line);
  return level == LogLevel::warning || level == LogLevel::error ? ": " + line : "";
}

std::string last_output(const std::string& file) {
  constexpr std::size_t most = 3;
  auto lines = lines_of(file);
  std::erase_if(lines, [](const std::string& line) { return line.empty() || base::parse_abnormal_exit(line).has_value(); });
  auto begin = lines.end();
  while (begin != lines.begin() && level_of(*std::prev(begin)) == LogLevel::none && lines.end() - begin < static_cast<std::ptrdiff_t>(most))
    --begin;
  if (begin == lines.end()) return complaint(file);
  return ": " + base::join(std::vector<std::string>(begin, lines.end()), "; ");
}

// Lines as they are: what is indented belongs to the traceback.
std::string last_line_of_traceback(const std::string& file) {
  constexpr std::string_view heading = "Traceback (most recent call last)";
  std::ifstream lines(file);
  std::string line, last;
  bool is_inside = false;
  while (std::getline(lines, line)) {
    if (line.find(heading) != std::string::npos) {
      is_inside = true;
    } else if (is_inside && !line.starts_with(' ') && !line.empty()) {
      last = line;
      is_inside = false;
    }
  }
  return last;
}

std::optional<base::AbnormalExit> abnormal_exit_in(const std::string& file) {
  for (const auto& line : lines_of(file)) {
    if (auto end = base::parse_abnormal_exit(line)) return end;
  }
  return std::nullopt;
}

std::string tail_of(const std::vector<std::string>& lines) {
  constexpr std::size_t enough = 40;
  std::string text;
  for (std::size_t i = lines.size() > enough ? lines.size() - enough : 0; i < lines.size(); ++i) text += lines[i] + "\n";
  return text;
}

std::string last_lines(const std::string& file) {
  const auto lines = lines_of(file);
  return lines.empty() ? "" : "--- " + std::filesystem::path(file).filename().string() + "\n" + tail_of(lines);
}

std::string printable(std::string_view text) {
  std::string result;
  while (!text.empty()) {
    const auto size = character_at(text);
    result += size > 0 ? text.substr(0, size) : "?";
    text.remove_prefix(std::max<std::size_t>(size, 1));
  }
  return result;
}

std::string folder_problem(const std::filesystem::filesystem_error& error) {
  const char* temporary = std::getenv("TMPDIR");
  const auto path = error.path1().empty() ? std::filesystem::path(temporary ? temporary : "/tmp") : error.path1();
  return "folder " + base::in_quotes(path.string()) + ": " + error.code().message();
}

}  // namespace tools
