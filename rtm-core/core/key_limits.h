// Limits of names that peers send: keys of connector properties, configuration parameters and creation arguments. They become paths in
// trees, so each step of each name costs memory. A table of constants; any thread.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>

#include "base/result.h"

namespace rt {

struct KeyLimits {
  std::size_t length = 1024;                          // [octets] of one key
  std::size_t depth = 64;                             // steps of one key
  std::size_t keys = 4096;                            // of one list
  std::size_t total_length = std::size_t{256} << 10;  // [octets] of all keys of one list
};
inline constexpr KeyLimits key_limits{};

// What peers may leave behind, call after call. Far more than anybody needs, so that it stays memory that a process can spare.
struct EntryLimits {
  std::size_t manager_keys = 4096;                           // of a manager, set by callers
  std::size_t manager_octets = std::size_t{8} << 20;         // of them with their values; every component inherits some
  std::size_t configuration_sets = 4096;                     // of a component
  std::size_t configuration_octets = std::size_t{64} << 20;  // of all its sets
  std::size_t organization_properties = 256;                 // of an organization
  std::size_t members = 4096;                                // of an organization or an execution context
};
inline constexpr EntryLimits entry_limits{};

// A port of one connection calls the next one while the first still waits, so their number is the depth of a chain of calls.
inline constexpr std::size_t max_ports_of_a_connection = 256;

// `what` begins the message: "property of the connection".
base::Result<void> check_key(std::string_view what, std::string_view key);

// The keys that callers have set in a manager, and how long their values are.
class KeysOfCallers {
 public:
  // False when there is no room for it (EntryLimits).
  bool take(const std::string& key, std::string_view value);

 private:
  std::map<std::string, std::size_t> octets_;
  std::size_t total_ = 0;
};

// Counts the keys of one list.
class KeyCounter {
 public:
  explicit KeyCounter(std::string_view what) : what_(what) {}
  base::Result<void> add(std::string_view key);

 private:
  std::string_view what_;
  std::size_t keys_ = 0;
  std::size_t total_length_ = 0;
};

}  // namespace rt
