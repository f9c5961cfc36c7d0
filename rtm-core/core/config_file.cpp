#include "core/config_file.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <filesystem>

#include "base/guarded.h"
#include "base/text.h"

namespace rt {
namespace {

constexpr std::size_t max_key_length = 1024;
constexpr std::uintmax_t max_file_size = std::uintmax_t{16} << 20;

std::string_view without_leading_blanks(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r\f\v");
  return first == std::string_view::npos ? std::string_view() : text.substr(first);
}

bool ends_with_continuation(std::string_view text) {
  const auto last = text.find_last_not_of('\\');
  const auto backslashes = text.size() - (last == std::string_view::npos ? 0 : last + 1);
  return backslashes % 2 == 1;
}

std::string without_escapes(std::string_view text) {
  std::string result;
  result.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '\\' || i + 1 == text.size()) {
      result += text[i];
      continue;
    }
    switch (const char next = text[++i]) {
      case 't':
        result += '\t';
        break;
      case 'n':
        result += '\n';
        break;
      case 'r':
        result += '\r';
        break;
      case 'f':
        result += '\f';
        break;
      default:
        result += next;
    }
  }
  return result;
}

// The first : or = that no backslash precedes, else the first blank.
std::size_t separator_of(std::string_view line) {
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '\\') {
      ++i;
    } else if (line[i] == ':' || line[i] == '=') {
      return i;
    }
  }
  return line.find_first_of(" \t");
}

bool is_key(std::string_view key) {
  if (key.empty() || key.size() > max_key_length || key.front() == '.' || key.back() == '.' || key.find("..") != std::string_view::npos) {
    return false;
  }
  return std::none_of(key.begin(), key.end(), [](unsigned char c) { return std::isspace(c) || std::iscntrl(c); });
}

void parse_line(std::string_view line, int number, ConfigText& result) {
  const auto at = separator_of(line);
  if (at == std::string_view::npos) {
    result.findings.push_back({number, "expected `key: value`, got " + base::in_quotes(line) + "; ignored"});
    return;
  }
  auto key = without_escapes(base::trim(line.substr(0, at)));
  auto value = line.substr(at + 1);
  // With a separator inside the key's blanks, `key value: x`, the key ends at the blank no classic parser would look for: reject it.
  if (!is_key(key)) {
    result.findings.push_back({number, "not a key: " + base::in_quotes(key) + "; ignored"});
    return;
  }
  result.entries.push_back({std::move(key), without_escapes(base::trim(value)), number});
}

// Up to the end, which a pipe must reach without pauses of more than five seconds.
base::Result<std::string> read_all(int file) {
  constexpr int timeout_ms = 5000;
  std::string text;
  char buffer[65536];
  while (text.size() <= max_file_size) {
    const auto size = read(file, buffer, sizeof buffer);
    if (size == 0) return text;
    if (size > 0) {
      text.append(buffer, static_cast<std::size_t>(size));
    } else if (errno == EAGAIN) {
      pollfd ready{file, POLLIN, 0};
      if (poll(&ready, 1, timeout_ms) == 0) return base::Error{"does not end"};
    } else if (errno != EINTR) {
      return base::Error{"cannot be read"};
    }
  }
  return base::Error{"larger than 16 MiB"};
}

}  // namespace

ConfigText parse_config(std::string_view text) {
  ConfigText result;
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);  // byte order mark
  std::string line;
  int number = 0;
  int first = 0;
  bool continued = false;
  while (!text.empty()) {
    const auto end = text.find('\n');
    auto piece = text.substr(0, end);
    text = end == std::string_view::npos ? std::string_view() : text.substr(end + 1);
    ++number;
    if (piece.ends_with('\r')) piece.remove_suffix(1);
    piece = without_leading_blanks(piece);
    if (!continued) {
      if (piece.empty() || piece.front() == '#' || piece.front() == '!') continue;
      line.clear();
      first = number;
    }
    continued = ends_with_continuation(piece);
    if (continued) piece.remove_suffix(1);
    line += piece;
    if (!continued) parse_line(line, first, result);
  }
  if (continued) parse_line(line, first, result);
  return result;
}

base::Result<std::string> read_text_file(const std::string& path) {
  base::expect_no_data_held();
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (error || !std::filesystem::exists(status)) return base::Error{"file " + base::in_quotes(path) + ": does not exist"};
  if (std::filesystem::is_directory(status)) return base::Error{"file " + base::in_quotes(path) + ": is a folder"};
  const int file = open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);  // a pipe that nobody writes must not hold us up
  if (file < 0) return base::Error{"file " + base::in_quotes(path) + ": cannot be read"};
  auto text = read_all(file);
  close(file);
  if (!text) return base::Error{"file " + base::in_quotes(path) + ": " + text.error().message};
  return text;
}

}  // namespace rt
