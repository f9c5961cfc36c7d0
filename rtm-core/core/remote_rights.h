// What callers of a manager may change over the wire, whoever they are: manager.remote_rights. Any thread; no state.
#pragma once

#include <string_view>

namespace rt {

enum class RemoteRights {
  read,        // look, nothing else
  components,  // load modules, make and delete components, set keys that are not protected
  everything,  // protected keys too
};

// "read", "components", "everything" in any case; components for all other texts.
RemoteRights parse_remote_rights(std::string_view text);

// Keys that name programs, libraries, files or doors: who sets them becomes the account of the process. `config_file` counts at the end of
// any key.
bool is_protected_key(std::string_view key);

}  // namespace rt
