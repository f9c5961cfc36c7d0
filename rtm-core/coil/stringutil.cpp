#include "coil/stringutil.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace coil {
namespace {

std::string upper(std::string s) {
  for (char& c : s) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return s;
}

std::string lower(std::string s) {
  for (char& c : s) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return s;
}

std::string without_blanks(std::string s) {
  std::erase_if(s, [](char c) { return c == ' ' || c == '\t'; });
  return s;
}

std::string without_head_blanks(std::string s) {
  s.erase(0, std::min(s.find_first_not_of(" \t"), s.size()));
  return s;
}

// An escaped blank at the end stays.
std::string without_tail_blanks(std::string s) {
  while (!s.empty() && (s.back() == ' ' || s.back() == '\t') && !isEscaped(s, s.size() - 1)) s.pop_back();
  return s;
}

std::string trimmed(std::string s) { return without_tail_blanks(without_head_blanks(std::move(s))); }

std::string normal_form(std::string s) { return lower(trimmed(std::move(s))); }

std::string replaced(std::string s, const std::string& from, const std::string& to) {
  if (from.empty()) return s;
  for (auto pos = s.find(from); pos != std::string::npos; pos = s.find(from, pos + to.size())) s.replace(pos, from.size(), to);
  return s;
}

std::string with_environment(const std::string& s) {
  std::string out;
  std::string::size_type done = 0;
  while (true) {
    auto open = s.find("${", done);
    auto close = open == std::string::npos ? open : s.find('}', open);
    if (close == std::string::npos) return out.append(s, done);
    out.append(s, done, open - done);
    if (const char* value = std::getenv(s.substr(open + 2, close - open - 2).c_str())) out += value;
    done = close + 1;
  }
}

// Splits into numbers between separators; false unless every part is 1 to `digits` characters of `allowed`.
bool is_made_of(const std::string& part, std::size_t digits, const char* allowed) {
  return !part.empty() && part.size() <= digits && part.find_first_not_of(allowed) == std::string::npos;
}

vstring raw_split(const std::string& s, char separator) {
  vstring parts(1);
  for (char c : s) {
    if (c == separator)
      parts.emplace_back();
    else
      parts.back() += c;
  }
  return parts;
}

int number(const std::string& digits) {
  int value = -1;
  std::from_chars(digits.data(), digits.data() + digits.size(), value);
  return value;
}

}  // namespace

std::string toUpper(const std::string& str) { return upper(str); }
ChangedString toUpper(std::string& str) { return {str, upper(str)}; }
std::string toUpper(std::string&& str) { return upper(std::move(str)); }
std::string toLower(const std::string& str) { return lower(str); }
ChangedString toLower(std::string& str) { return {str, lower(str)}; }
std::string toLower(std::string&& str) { return lower(std::move(str)); }
int getlinePortable(std::istream& in, std::string& line) {
  std::getline(in, line);
  if (line.ends_with('\r')) line.pop_back();
  return static_cast<int>(line.size());
}

std::string eraseBlank(const std::string& str) { return without_blanks(str); }
ChangedString eraseBlank(std::string& str) { return {str, without_blanks(str)}; }
std::string eraseBlank(std::string&& str) { return without_blanks(std::move(str)); }
std::string eraseHeadBlank(const std::string& str) { return without_head_blanks(str); }
ChangedString eraseHeadBlank(std::string& str) { return {str, without_head_blanks(str)}; }
std::string eraseHeadBlank(std::string&& str) { return without_head_blanks(std::move(str)); }
std::string eraseTailBlank(const std::string& str) { return without_tail_blanks(str); }
ChangedString eraseTailBlank(std::string& str) { return {str, without_tail_blanks(str)}; }
std::string eraseTailBlank(std::string&& str) { return without_tail_blanks(std::move(str)); }
std::string eraseBothEndsBlank(const std::string& str) { return trimmed(str); }
ChangedString eraseBothEndsBlank(std::string& str) { return {str, trimmed(str)}; }
std::string eraseBothEndsBlank(std::string&& str) { return trimmed(std::move(str)); }
std::string normalize(const std::string& str) { return normal_form(str); }
ChangedString normalize(std::string& str) { return {str, normal_form(str)}; }
std::string normalize(std::string&& str) { return normal_form(std::move(str)); }
std::string replaceString(const std::string& str, const std::string& from, const std::string& to) { return replaced(str, from, to); }
ChangedString replaceString(std::string& str, const std::string& from, const std::string& to) { return {str, replaced(str, from, to)}; }
std::string replaceString(std::string&& str, const std::string& from, const std::string& to) { return replaced(std::move(str), from, to); }
std::string replaceEnv(const std::string& str) { return with_environment(str); }
ChangedString replaceEnv(std::string& str) { return {str, with_environment(str)}; }
std::string replaceEnv(std::string&& str) { return with_environment(str); }

std::wstring string2wstring(const std::string& str) { return std::wstring(str.begin(), str.end()); }

std::string wstring2string(const std::wstring& wstr) {
  std::string out;
  for (wchar_t c : wstr) out += static_cast<char>(c);
  return out;
}

int getline(std::istream& istr, std::string& line) {
  if (!std::getline(istr, line)) return -1;
  if (!line.empty() && line.back() == '\r') line.pop_back();
  return static_cast<int>(line.size());
}

bool isEscaped(const std::string& str, std::string::size_type pos) {
  std::size_t backslashes = 0;
  while (pos > backslashes && str[pos - backslashes - 1] == '\\') ++backslashes;
  return backslashes % 2 == 1;
}

std::string escape(const std::string& str) {
  std::string out;
  for (char c : str) {
    switch (c) {
      case '\t':
        out += "\\t";
        break;
      case '\n':
        out += "\\n";
        break;
      case '\r':
        out += "\\r";
        break;
      case '\f':
        out += "\\f";
        break;
      case '"':
        out += "\\\"";
        break;
      case '\'':
        out += "\\'";
        break;
      case '\\':
        out += "\\\\";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string unescape(const std::string& str) {
  std::string out;
  for (std::size_t i = 0; i < str.size(); ++i) {
    if (str[i] != '\\' || i + 1 == str.size()) {
      out += str[i];
      continue;
    }
    switch (char c = str[++i]) {
      case 't':
        out += '\t';
        break;
      case 'n':
        out += '\n';
        break;
      case 'r':
        out += '\r';
        break;
      case 'f':
        out += '\f';
        break;
      default:
        out += c;
    }
  }
  return out;
}

vstring split(const std::string& input, const std::string& delimiter, bool ignore_empty) {
  vstring parts;
  if (input.empty()) return parts;
  if (delimiter.empty()) return {input};
  std::string::size_type start = 0;
  while (true) {
    auto end = input.find(delimiter, start);
    std::string part = trimmed(input.substr(start, end == std::string::npos ? end : end - start));
    if (!ignore_empty || !part.empty()) parts.push_back(std::move(part));
    if (end == std::string::npos) return parts;
    start = end + delimiter.size();
  }
}

std::string flatten(const vstring& sv, const std::string& delimiter) {
  std::string out;
  for (std::size_t i = 0; i < sv.size(); ++i) {
    if (i > 0) out += delimiter;
    out += sv[i];
  }
  return out;
}

vstring unique_sv(const vstring& sv) {
  vstring out(sv);
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

bool toBool(const std::string& str, const std::string& yes, const std::string& no, bool default_value) {
  const std::string text = upper(str);
  if (text.find(upper(yes)) != std::string::npos) return true;
  if (text.find(upper(no)) != std::string::npos) return false;
  return default_value;
}

bool includes(const vstring& list, const std::string& value, bool ignore_case) {
  const std::string wanted = ignore_case ? lower(value) : value;
  return std::any_of(list.begin(), list.end(), [&](const std::string& item) { return (ignore_case ? lower(item) : item) == wanted; });
}

bool includes(const std::string& list, const std::string& value, bool ignore_case) {
  return includes(split(list, ","), value, ignore_case);
}

bool isAbsolutePath(const std::string& str) { return !str.empty() && str[0] == '/'; }

bool isURL(const std::string& str) {
  auto pos = str.find("://");
  return pos != std::string::npos && pos > 0;
}

bool isIPv4(const std::string& str) {
  const vstring parts = raw_split(str, '.');
  return parts.size() == 4 &&
         std::all_of(parts.begin(), parts.end(), [](const std::string& p) { return is_made_of(p, 3, "0123456789") && number(p) <= 255; });
}

bool isIPv6(const std::string& str) {
  const vstring parts = raw_split(str.substr(0, str.find('%')), ':');
  if (parts.size() < 3 || parts.size() > 8) return false;
  const bool shortened = str.find("::") != std::string::npos;
  if (!shortened && parts.size() != 8) return false;
  return std::all_of(parts.begin(), parts.end(),
                     [&](const std::string& p) { return p.empty() ? shortened : is_made_of(p, 4, "0123456789abcdefABCDEF"); });
}

bool isIPPort(const std::string& str) { return is_made_of(str, 5, "0123456789") && number(str) <= 65535; }

mapstring urlparam2map(const std::string& str) {
  mapstring out;
  auto question = str.find('?');
  for (const std::string& pair : split(question == std::string::npos ? str : str.substr(question + 1), "&", true)) {
    auto equals = pair.find('=');
    if (equals == std::string::npos)
      out[pair];
    else
      out[trimmed(pair.substr(0, equals))] = trimmed(pair.substr(equals + 1));
  }
  return out;
}

std::string sprintf(const char* fmt, ...) {
  va_list args;
  va_start(args, fmt);
  va_list again;
  va_copy(again, args);
  const int length = std::vsnprintf(nullptr, 0, fmt, args);
  va_end(args);
  std::string out(length > 0 ? static_cast<std::size_t>(length) : 0, '\0');
  if (length > 0) std::vsnprintf(out.data(), out.size() + 1, fmt, again);
  va_end(again);
  return out;
}

Argv::Argv(const vstring& args) : strings_(args) {
  for (std::string& s : strings_) pointers_.push_back(s.data());
  pointers_.push_back(nullptr);
}

Argv& Argv::operator=(const Argv& other) {
  if (this == &other) return *this;
  strings_ = other.strings_;
  pointers_.clear();
  for (std::string& s : strings_) pointers_.push_back(s.data());
  pointers_.push_back(nullptr);
  return *this;
}

char** toArgv(const vstring& args) {
  char** argv = new char*[args.size() + 1];
  for (std::size_t i = 0; i < args.size(); ++i) {
    argv[i] = new char[args[i].size() + 1];
    std::memcpy(argv[i], args[i].c_str(), args[i].size() + 1);
  }
  argv[args.size()] = nullptr;
  return argv;
}

namespace detail {

bool read_bool(bool& value, const char* str) {
  const std::string text = normal_form(str);
  for (const char* yes : {"1", "true", "yes", "on"}) {
    if (text == yes) return value = true;
  }
  for (const char* no : {"0", "false", "no", "off"}) {
    if (text != no) continue;
    value = false;
    return true;
  }
  return false;
}

bool read_seconds(double& seconds, const char* str) {
  std::istringstream in{std::string(str)};
  double value = 0;
  in >> value;
  // What no duration can hold is not a duration: 9.2e9 s are the 64-bit nanoseconds.
  if (in.fail() || !std::isfinite(value) || std::abs(value) > 9.2e9) return false;
  seconds = value;
  return true;
}

}  // namespace detail
}  // namespace coil
