#include "base/suggestion.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "base/text.h"

namespace base {
namespace {

constexpr std::size_t longest = 200;  // [letters] of a word that is compared: the work grows with the product of both

// Letters to change, add, take away, or exchange with the next one.
std::size_t distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1), before, two_before;
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    two_before = std::exchange(before, row);
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({before[j] + 1, row[j - 1] + 1, before[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) row[j] = std::min(row[j], two_before[j - 2] + 1);
    }
  }
  return row.back();
}

std::string_view last_part(std::string_view name) {
  const auto at = name.find_last_of(":/");
  return at == std::string_view::npos ? name : name.substr(at + 1);
}

// Of the last parts of two names, what they have in common behind a dot: it makes no name nearer to another.
std::size_t common_extension(std::string_view a, std::string_view b) {
  const auto at = a.rfind('.');
  if (at == std::string_view::npos || at == 0 || !b.ends_with(a.substr(at)) || b.size() == a.size() - at) return 0;
  return a.size() - at;
}

}  // namespace

std::string nearest(std::string_view word, const std::vector<std::string>& known) {
  const std::string wanted = to_lower(word.substr(0, longest));
  std::string found;
  std::size_t fewest = 0;
  for (const auto& name : known) {
    const std::string whole = to_lower(std::string_view(name).substr(0, longest));
    for (const std::string_view part : {std::string_view(whole), last_part(whole)}) {
      const std::size_t letters = std::min(part.size(), wanted.size()) - common_extension(wanted, part);
      const std::size_t differing = distance(wanted, part);
      if (letters < 2 || differing > (letters < 4 ? 1 : (letters + 4) / 5)) continue;
      if (found.empty() || differing < fewest) found = name, fewest = differing;
    }
  }
  return found;
}

std::string suggestion(std::string_view word, const std::vector<std::string>& known) {
  const auto name = nearest(word, known);
  return name.empty() ? "" : "; did you mean " + name + "?";
}

}  // namespace base
