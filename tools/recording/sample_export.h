// Exports samples of a recording as tables and images. One thread.
#pragma once

#include <string>

#include "recording/selection.h"
#include "system/editor.h"

namespace recorder {

struct ExportOptions {
  Selection selection;
  std::string folder;
  bool png = false;
};

// FOLDER/CHANNEL.csv for each channel; what cannot be shown is told and left out.
void export_tables(editor::Editor& editor, const ExportOptions& options);
// FOLDER/CHANNEL/000001.png, ... of each channel that has pictures.
void export_pictures(editor::Editor& editor, const ExportOptions& options);

}  // namespace recorder
