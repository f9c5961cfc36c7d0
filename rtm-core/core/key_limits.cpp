#include "core/key_limits.h"

#include <algorithm>
#include <string>

#include "base/text.h"

namespace rt {

base::Result<void> check_key(std::string_view what, std::string_view key) {
  const auto fail = [&](const std::string& problem) { return base::Error{std::string(what) + " " + base::in_quotes(key) + " " + problem}; };
  if (key.size() > key_limits.length) {
    return fail("has " + std::to_string(key.size()) + " characters, expected at most " + std::to_string(key_limits.length));
  }
  const auto depth = static_cast<std::size_t>(std::count(key.begin(), key.end(), '.')) + 1;
  if (depth > key_limits.depth) {
    return fail("has " + std::to_string(depth) + " steps, expected at most " + std::to_string(key_limits.depth));
  }
  return {};
}

bool KeysOfCallers::take(const std::string& key, std::string_view value) {
  const auto at = octets_.find(key);
  const std::size_t octets = key.size() + value.size();
  const std::size_t total = total_ - (at == octets_.end() ? 0 : at->second) + octets;
  if (total > entry_limits.manager_octets || (at == octets_.end() && octets_.size() == entry_limits.manager_keys)) return false;
  octets_[key] = octets;
  total_ = total;
  return true;
}

base::Result<void> KeyCounter::add(std::string_view key) {
  if (auto checked = check_key(what_, key); !checked) return checked;
  total_length_ += key.size();
  if (++keys_ > key_limits.keys) return base::Error{std::string(what_) + ": expected at most " + std::to_string(key_limits.keys)};
  if (total_length_ > key_limits.total_length) {
    return base::Error{std::string(what_) + ": expected at most " + std::to_string(key_limits.total_length) + " characters in all names"};
  }
  return {};
}

}  // namespace rt
