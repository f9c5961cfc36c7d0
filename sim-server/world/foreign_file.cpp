#include "world/foreign_file.h"

#include <cctype>
#include <string>
#include <vector>

namespace sim {
namespace {

// The first words and signs outside of comments ("# ..." to the end of the line) and of quotes.
std::vector<std::string> first_words(std::string_view text) {
  constexpr std::size_t max_text = 100'000, max_words = 2'000;
  std::vector<std::string> words;
  text = text.substr(0, max_text);
  for (std::size_t i = 0; i < text.size() && words.size() < max_words;) {
    const auto c = static_cast<unsigned char>(text[i]);
    if (c == '#') {
      while (i < text.size() && text[i] != '\n') ++i;
    } else if (c == '"') {
      const std::size_t end = text.find('"', i + 1);
      words.emplace_back("\"");
      i = end == std::string_view::npos ? text.size() : end + 1;
    } else if (std::isalpha(c) != 0 || c == '_') {
      std::size_t end = i;
      while (end < text.size() && (std::isalnum(static_cast<unsigned char>(text[end])) != 0 || text[end] == '_')) ++end;
      words.emplace_back(text.substr(i, end - i));
      i = end;
    } else {
      if (c == '(' || c == '[') words.emplace_back(1, static_cast<char>(c));
      ++i;
    }
  }
  return words;
}

}  // namespace

std::optional<std::string> foreign_file(std::string_view text) {
  const std::size_t start = text.find_first_not_of(" \t\r\n\xef\xbb\xbf");
  if (start == std::string_view::npos || text[start] == '<') return std::nullopt;
  const std::vector<std::string> words = first_words(text);
  for (std::size_t i = 0; i + 1 < words.size(); ++i) {
    const std::string &word = words[i], &next = words[i + 1];
    if (word == "driver" && next == "(") {
      return "is a configuration file of Player; player-gateway serves the robots of a world without one, "
             "and docs/stage.md says what replaces its drivers";
    }
    // "define NAME TYPE (" and "TYPE (" with a property of Stage, "include "pioneer.inc""
    const bool is_definition = word == "define" && i + 3 < words.size() && words[i + 3] == "(";
    const bool is_include = word == "include" && next == "\"";
    const bool is_model =
        next == "(" && (word == "window" || word == "floorplan" || word == "position" || word == "model" || word == "map");
    if (is_definition || is_include || is_model)
      return "is a world of Stage; SDFormat is expected. docs/stage.md shows how to write such a world in SDFormat";
  }
  return std::nullopt;
}

}  // namespace sim
