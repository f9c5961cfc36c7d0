// Exports samples of a recording as tables and images. One thread.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "recording/selection.h"

namespace recorder {

struct ExportOptions {
  Selection selection;
  std::string folder;
  bool png = false;
};

struct Exported {
  std::size_t files = 0;            // tables or pictures
  std::vector<base::Error> errors;  // of channels and chunks that are left out
};

// FOLDER/CHANNEL.csv for each channel. Fails when the recording cannot be read or the folder cannot be made.
base::Result<Exported> export_tables(const ExportOptions& options, tools::Reporter& reporter);
// FOLDER/CHANNEL/000001.png, ... of each channel that has pictures.
base::Result<Exported> export_pictures(const ExportOptions& options, tools::Reporter& reporter);

}  // namespace recorder
