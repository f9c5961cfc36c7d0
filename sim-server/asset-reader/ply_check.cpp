#include "asset-reader/ply_check.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <string>
#include <vector>

#include "asset-reader/scene_check.h"
#include "base/text.h"

namespace sim {
namespace {

constexpr std::string_view header_end = "end_header";

// Bytes of a scalar in a binary file; 0: not a type of PLY.
std::uint64_t bytes_of(std::string_view type) {
  for (const auto* name : {"char", "uchar", "int8", "uint8"})
    if (type == name) return 1;
  for (const auto* name : {"short", "ushort", "int16", "uint16"})
    if (type == name) return 2;
  for (const auto* name : {"int", "uint", "float", "int32", "uint32", "float32"})
    if (type == name) return 4;
  return type == "double" || type == "float64" || type == "int64" || type == "uint64" ? 8 : 0;
}

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::uint64_t least_bytes = 0;  // of one
  std::vector<bool> is_list;      // of its properties, up to the last list
};

base::Error damaged(const std::string& why) { return base::Error{"is damaged: " + why}; }

// Checks that the element fits into the `left` bytes, and subtracts its size.
base::Result<void> take(const Element& element, std::uint64_t& left) {
  if (element.least_bytes == 0 && element.count > left)
    return damaged("its header counts " + std::to_string(element.count) + " of " + base::in_quotes(element.name) +
                   ", which have no property");
  if (element.least_bytes != 0 && element.count > left / element.least_bytes)
    return damaged("its header counts " + std::to_string(element.count) + " of " + base::in_quotes(element.name) +
                   ", the file has room for " + std::to_string(left / element.least_bytes));
  left -= element.count * element.least_bytes;
  return {};
}

// Checks that no list declares more numbers than the file has bytes, because Assimp allocates them first. Checks that the line has the
// count of each list, because Assimp reads a missing count from the rest of the line before.
base::Result<void> check_line(std::string_view line, const Element& element, std::size_t file_size) {
  constexpr std::string_view space = " \t\r";
  std::size_t at = 0;
  const auto next_word = [&] {
    at = std::min(line.find_first_not_of(space, at), line.size());
    const std::string_view word = line.substr(at, line.find_first_of(space, at) - at);
    at += word.size();
    return word;
  };
  for (const bool is_list : element.is_list) {
    const std::string_view word = next_word();
    if (word.empty()) return damaged("a line of " + base::in_quotes(element.name) + " ends before the count of a list");
    if (!is_list) continue;
    std::uint32_t count = 0;  // 0 if the word is not a number in range
    std::from_chars(word.data(), word.data() + word.size(), count);
    if (count > max_unchecked_corners && count > file_size)
      return damaged("a list of " + base::in_quotes(element.name) + " counts " + std::to_string(count) + " numbers, the file has " +
                     std::to_string(file_size) + " bytes");
    while (count > 0 && at < line.size()) {
      next_word();
      --count;
    }
  }
  return {};
}

// Checks a text file, which has one line for each item of an element. Lines that do not begin with a number are skipped, so the check can
// only be ahead of Assimp's position.
base::Result<void> check_lists(std::string_view content, std::size_t header_size, const std::vector<Element>& elements) {
  std::size_t at = content.find('\n', header_size);
  for (const Element& element : elements) {
    for (std::uint64_t i = 0; i < element.count && at != std::string_view::npos; at = content.find('\n', at + 1)) {
      const std::string_view rest = content.substr(std::min(content.find_first_not_of(" \t", at + 1), content.size()));
      if (rest.empty() || std::string_view("0123456789+-.").find(rest.front()) == std::string_view::npos) continue;
      ++i;
      if (const auto fits = check_line(rest.substr(0, rest.find('\n')), element, content.size()); !fits) return fits;
    }
  }
  return {};
}

}  // namespace

base::Result<void> check_ply(std::string_view content) {
  const auto is_line = [content](std::size_t at) {
    const std::size_t after = at + header_end.size();
    return (at == 0 || content[at - 1] == '\n' || content[at - 1] == '\r') && after < content.size() &&
           std::string_view(" \t\r\n").find(content[after]) != std::string_view::npos;
  };
  std::size_t end = content.find(header_end);
  while (end != std::string_view::npos && !is_line(end)) end = content.find(header_end, end + 1);
  if (end == std::string_view::npos) return damaged("its header has no line " + base::in_quotes(header_end));
  std::uint64_t left = content.size() - end - header_end.size();
  bool is_text = true;
  Element element;
  std::size_t properties = 0;  // of the element, so far
  std::vector<Element> elements;
  for (std::size_t at = 0; at < end;) {
    const std::size_t stop = content.find_first_of("\r\n", at);
    std::string line(content.substr(at, stop - at));
    std::ranges::replace(line, '\t', ' ');  // Assimp accepts a tab, too
    const auto words = base::split_list(line, ' ');
    at = stop + 1;
    if (words.size() > 1 && words[0] == "format") is_text = words[1] == "ascii";
    if (words.size() > 2 && words[0] == "element") {
      if (const auto fits = take(element, left); !fits) return fits;
      elements.push_back(element);
      element = {words[1], 0, 0, {}};
      properties = 0;
      // Assimp does not skip unknown names, and reads this one as the count.
      if (element.name.front() >= '0' && element.name.front() <= '9')
        return damaged("its header has an element " + base::in_quotes(element.name) + ", expected a name that begins with no digit");
      const auto [rest, fault] = std::from_chars(words[2].data(), words[2].data() + words[2].size(), element.count);
      if (fault != std::errc() || rest != words[2].data() + words[2].size())
        return damaged("its header counts " + base::in_quotes(words[2]) + " of " + base::in_quotes(element.name) + ", expected a number");
    }
    if (words.size() > 2 && words[0] == "property") {
      ++properties;
      if (words[1] == "list") {
        element.is_list.resize(properties);
        element.is_list.back() = true;
      }
      const std::uint64_t bytes = bytes_of(words[words[1] == "list" ? 2 : 1]);
      element.least_bytes += is_text ? 2 : bytes;  // in text a digit and its separator
    }
  }
  ++left;  // the last number of a text needs no end
  if (const auto fits = take(element, left); !fits) return fits;
  elements.push_back(element);
  return is_text ? check_lists(content, end, elements) : base::Result<void>();
}

}  // namespace sim
