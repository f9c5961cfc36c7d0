// Loads, starts and stops saved systems, for all commands that do so. One thread at a time.
#pragma once

#include <string>

namespace editor {

class Editor;

struct LoadOptions {
  std::string file;
  bool dry_run = false;
  bool with_states = false;
  bool force = false;  // also values that the components' own types and constraints forbid
};

// Connects and configures the running components as the file says. They report failures through editor.fail().
void load(Editor& editor, const LoadOptions& options);
// Activates the components of the file.
void start(Editor& editor, const std::string& file, bool dry_run);

}  // namespace editor
