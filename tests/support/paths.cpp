#include "support/paths.h"

namespace paths {

const char* const source_dir = RTMSIM_SOURCE_DIR;
const char* const bin_dir = RTMSIM_BIN_DIR;

}  // namespace paths
