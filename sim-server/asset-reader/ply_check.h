// Checks a PLY file before Assimp reads it, which searches for ever for the missing end of a header, and makes room for all that the header
// and the lists of a text count.
// Source: "The PLY Polygon File Format", G. Turk, 1994. Any thread.
#pragma once

#include <string_view>

#include "base/result.h"

namespace sim {

// The header has an end, and the file is long enough for the elements that it counts, each as short as its properties allow, and for the
// lists of a text. The error is one line without the file.
base::Result<void> check_ply(std::string_view content);

}  // namespace sim
