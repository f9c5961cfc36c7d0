#include "base/shell_word.h"

#include <algorithm>
#include <cstdio>

#include "base/text.h"

namespace base {
namespace {

// What no shell obeys. A word that begins with '=' or '%' is a path or a job to some.
constexpr std::string_view plain = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-/:=,+@%";

bool is_printable_ascii(char c) { return c >= ' ' && c <= '~'; }

std::string in_single_quotes(std::string_view text) {
  std::string word = "'";
  for (const char c : text) word += c == '\'' ? "'\\''" : std::string(1, c);
  return word + "'";
}

// Always two digits: what follows may be one, too.
std::string with_escapes(std::string_view text) {
  std::string word = "$'";
  for (const char c : text) {
    if (c == '\0') continue;
    if (c == '\'' || c == '\\') word += '\\';
    if (is_printable_ascii(c) && c != '!') {  // which interactive shells may replace by a line of their history
      word += c;
      continue;
    }
    char escape[8];
    std::snprintf(escape, sizeof escape, "\\x%02x", static_cast<unsigned>(static_cast<unsigned char>(c)));
    word += escape;
  }
  return word + "'";
}

}  // namespace

std::string shell_word(std::string_view text) {
  return std::ranges::all_of(text, is_printable_ascii) ? script_word(text) : with_escapes(text);
}

std::string script_word(std::string_view text) {
  const bool is_plain = !text.empty() && text.find_first_not_of(plain) == std::string_view::npos && text[0] != '=' && text[0] != '%';
  return is_plain ? std::string(text) : in_single_quotes(text);
}

std::string shell_line(const std::vector<std::string>& words) {
  std::string line;
  for (const auto& word : words) line += (line.empty() ? "" : " ") + shell_word(word);
  return line;
}

std::vector<std::string> command_words(std::vector<std::string> verb, const std::vector<std::string>& operands,
                                       const std::vector<std::string>& options) {
  const auto looks_like_an_option = [](const std::string& word) { return word.starts_with('-') && !parse_number(word); };
  const bool are_marked = std::ranges::any_of(operands, looks_like_an_option);
  const auto append = [&](const std::vector<std::string>& words) { verb.insert(verb.end(), words.begin(), words.end()); };
  if (are_marked) append(options), verb.emplace_back("--");
  append(operands);
  if (!are_marked) append(options);
  return verb;
}

std::vector<std::string> option_words(const std::string& name, const std::string& value) {
  if (!value.starts_with('-')) return {name, value};
  return {name + (name.starts_with("--") ? "=" : "") + value};
}

}  // namespace base
