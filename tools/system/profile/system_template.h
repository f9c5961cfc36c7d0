// A saved system as a template: a name in braces, as {robot}, stands for each value of a list, {robot#} for the number of the value (from
// 0). Components, connections and list entries that contain it are repeated, value by value. Other braces stay as they are. Values; any
// thread.
#pragma once

#include <string>
#include <vector>

#include "system/profile/rts_profile.h"

namespace editor {

struct ForEach {
  std::string name;
  std::vector<std::string> values;

  // "robot=r0..r99", "robot=r00..r99", "robot=left,right", several with commas; "robot=100" is robot0..robot99. At most 100,000 values.
  static base::Result<ForEach> parse(const std::string& text);
  // With {name} and {name#} replaced.
  std::string filled(std::string text, std::size_t number) const;
  bool is_in(const std::string& text) const;
};

inline constexpr const char* for_each_help = "NAME=LIST: repeat what contains {NAME} for each value: robot=r0..r99, robot=a,b, robot=100";

// The system with each of `lists` ("robot=r0..r99") filled in; a system without names in braces as it is. Fails when a list is not used,
// when a name in braces has no list, and when two components get one name. `file` is for messages.
base::Result<SavedSystem> filled_in(SavedSystem system, const std::vector<std::string>& lists, const std::string& file);

// Texts that contain a name are repeated in the same way, as properties of components.
base::Result<std::vector<std::string>> filled_in(std::vector<std::string> texts, const std::vector<std::string>& lists);

// read_system() and filled_in().
base::Result<SavedSystem> read_system(const std::string& file, const std::vector<std::string>& lists);

}  // namespace editor
