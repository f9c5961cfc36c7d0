// Checks a PLY file before Assimp reads it. Assimp searches endlessly for a missing end of the header, and allocates memory for the numbers
// that the header and the lists of a text file declare.
// Source: "The PLY Polygon File Format", G. Turk, 1994. Any thread.
#pragma once

#include <string_view>

#include "base/result.h"

namespace sim {

// Checks that the header has an end, and that the file is long enough for the declared elements (each as short as its properties allow) and
// for the lists of a text file. The error is one line without the name of the file.
base::Result<void> check_ply(std::string_view content);

}  // namespace sim
