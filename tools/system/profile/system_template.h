// A saved system as a template: a name in braces, as {robot}, stands for each value of a list, {robot#} for the number of the value (from
// 0). Components, connections and list entries that contain it are repeated, value by value. Other braces stay as they are. Values; any
// thread. The lists are those of base/name_list.h.
#pragma once

#include <string>
#include <vector>

#include "base/name_list.h"
#include "system/profile/rts_profile.h"

namespace tools {

// The system with each of `lists` ("robot=r0..r99") filled in; a system without names in braces as it is. Fails when a list is not used,
// when a name in braces has no list, and when two components get one name. `file` is for messages.
base::Result<SavedSystem> filled_in(SavedSystem system, const std::vector<std::string>& lists, const std::string& file);

// Texts that contain a name are repeated in the same way, as properties of components.
base::Result<std::vector<std::string>> filled_in(std::vector<std::string> texts, const std::vector<std::string>& lists);

// read_system() and filled_in().
base::Result<SavedSystem> read_system(const std::string& file, const std::vector<std::string>& lists);

}  // namespace tools
