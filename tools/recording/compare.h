// Finds the first difference of two recordings (recording compare). One thread.
#pragma once

#include <string>
#include <vector>

#include "recording/sample_difference.h"
#include "system/editor.h"

namespace recorder {

struct CompareOptions {
  std::string first, second;
  std::vector<std::string> topics;
  DifferenceOptions tolerated;
};

// Says what it found by the editor, which has failed when the recordings differ or can't be read.
void compare(editor::Editor& editor, const CompareOptions& options);

}  // namespace recorder
