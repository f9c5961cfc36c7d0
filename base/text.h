// Text functions, and strict parsing of numbers. Any thread. They do not depend on the locale.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace base {

std::string_view trim(std::string_view text);
std::string to_lower(std::string_view text);
// ASCII letters only.
bool equal_ignoring_case(std::string_view a, std::string_view b);

// Splits at every separator and trims the pieces; empty pieces are dropped.
std::vector<std::string> split_list(std::string_view text, char separator = ',');
std::string join(const std::vector<std::string>& parts, std::string_view separator);

// The whole text (blanks at the ends apart) must be the number; no overflow. parse_number also rejects NaN and infinities.
std::optional<std::int64_t> parse_integer(std::string_view text);
std::optional<double> parse_number(std::string_view text);
// A time in seconds: a number alone, or with us, ms, s, min (m) or h behind it.
std::optional<double> parse_seconds(std::string_view text);
// YES/NO, TRUE/FALSE, ON/OFF, 1/0 in any case.
std::optional<bool> parse_bool(std::string_view text);

// The shortest text that reads back as the same number.
std::string format_number(double value);
// [s] The number nearest to the time: 60 ms are 0.06, whose text is short.
inline double to_seconds(std::chrono::nanoseconds time) { return static_cast<double>(time.count()) / 1e9; }

struct Character {
  char32_t code = 0;
  std::size_t size = 0;  // [octets]
};
// What a text that is not empty begins with; nothing when that is no UTF-8.
std::optional<Character> first_character(std::string_view text);
// Whether a terminal does not show the character but obeys it: controls, those of C1 too, those that turn the direction of writing, and
// the line ends of Unicode.
bool is_obeyed(char32_t code);
// A text that comes from outside, fit for a terminal: what would be obeyed as \x1b, but for `kept` ones, and U+FFFD for each octet that is
// no UTF-8.
std::string printable(std::string_view text, std::string_view kept = {});
// The same for one line of a message: in quotes, cut after 120 characters.
std::string in_quotes(std::string_view text);

}  // namespace base
