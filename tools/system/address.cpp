#include "system/address.h"

#include <cstdlib>

#include "base/text.h"

namespace tools {
namespace {

std::vector<std::string> split_path(std::string_view text) {
  std::vector<std::string> segments;
  std::string segment;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\\' && i + 1 < text.size()) {
      segment += text[i];
      segment += text[++i];
    } else if (text[i] == '/') {
      if (!segment.empty()) segments.push_back(segment);
      segment.clear();
    } else {
      segment += text[i];
    }
  }
  if (!segment.empty()) segments.push_back(segment);
  return segments;
}

std::size_t find_unescaped(const std::string& text, char wanted) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\\') {
      ++i;
    } else if (text[i] == wanted) {
      return i;
    }
  }
  return std::string::npos;
}

std::string unescape(std::string_view text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\\' && i + 1 < text.size()) ++i;
    result += text[i];
  }
  return result;
}

}  // namespace

std::string Address::text() const { return (is_absolute ? "/" : "") + base::join(segments, "/") + (port.empty() ? "" : ":" + port); }

base::Result<Address> parse_address(std::string_view text, std::string_view working) {
  const auto trimmed = base::trim(text);
  Address address;
  address.is_absolute = trimmed.starts_with('/');
  auto segments = split_path(trimmed);
  const bool is_directory = trimmed.ends_with('/');
  // A colon in the last segment separates the port, but "/host:2809/" and "/host:2809" name a server.
  bool only_server = address.is_absolute && segments.size() == 1;
  // "host:2809" without a slash names a server too: no port of a component is called by a number of TCP's size, and no server ends in .rtc.
  if (!address.is_absolute && !is_directory && segments.size() == 1) {
    const auto& name = segments.front();
    const auto colon = name.rfind(':');
    const auto number = colon == std::string::npos ? std::string() : name.substr(colon + 1);
    only_server =
        number.size() >= 4 && number.find_first_not_of("0123456789") == std::string::npos && !name.substr(0, colon).ends_with(".rtc");
    address.is_absolute = only_server;
  }
  if (!segments.empty() && !is_directory && !only_server) {
    auto& last = segments.back();
    if (const auto colon = find_unescaped(last, ':'); colon != std::string::npos) {
      address.port = last.substr(colon + 1);
      last.resize(colon);
      if (address.port.empty()) return base::Error{"path " + base::in_quotes(text) + ": a port name must follow the colon"};
      if (last.empty()) return base::Error{"path " + base::in_quotes(text) + ": a component name must stand before the colon"};
    }
  }
  // Only paths that step through contexts are relative to the working path; a bare name is looked for everywhere.
  const bool relative = !address.is_absolute && !working.empty() && (segments.size() > 1 || trimmed.starts_with('.') || segments.empty());
  std::vector<std::string> all;
  if (relative) {
    all = split_path(working);
    address.is_absolute = true;
  }
  for (auto& segment : segments) {
    if (segment == ".") continue;
    if (segment == "..") {
      if (!all.empty()) all.pop_back();
      continue;
    }
    all.push_back(std::move(segment));
  }
  address.segments = std::move(all);
  return address;
}

std::string escape_name(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '/' || c == '.' || c == '\\') result += '\\';
    result += c;
  }
  return result;
}

std::pair<std::string, std::string> split_kind(const std::string& segment) {
  const auto dot = find_unescaped(segment, '.');
  if (dot == std::string::npos) return {unescape(segment), ""};
  return {unescape(segment.substr(0, dot)), unescape(segment.substr(dot + 1))};
}

bool matches(const std::string& segment, const std::string& id, const std::string& kind) {
  const auto [wanted_id, wanted_kind] = split_kind(segment);
  if (find_unescaped(segment, '.') == std::string::npos) return wanted_id == id;
  // A name with a dot of its own, written without an escape, is understood too.
  return (wanted_id == id && wanted_kind == kind) || unescape(segment) == id || unescape(segment) == id + "." + kind;
}

std::string working_path() {
  const char* path = std::getenv("RTCSH_CWD");
  return path ? path : "";
}

}  // namespace tools
