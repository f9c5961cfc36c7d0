// The rights of all remote callers of a manager: manager.remote_rights. Any thread; no state.
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

// Keys that name programs, libraries, files or doors: who sets them becomes the account of the process. `config_file` and
// `hash_log` count at the end of any key.
bool is_protected_key(std::string_view key);

// Whether the value would show what the environment of the process holds (core/name_format.h): from strangers that is not taken.
bool shows_environment(std::string_view key, std::string_view value);

// Keys whose values strangers do not see.
bool is_secret_key(std::string_view key);

// Whether the function that a caller names is one that makes a module known: the manager calls it, and the loader finds those of every
// library below the module under their names as well (abort, exit). `module` may be "FILE(FUNCTION)"; no function is the usual one.
bool is_init_function(std::string_view module, std::string_view function, std::string_view prefix, std::string_view suffix);

}  // namespace rt
