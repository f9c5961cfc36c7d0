// Where the sources and the programs of this build lie. Kept out of the command line of the compiler, so that what is compiled for one
// folder is good for another. Any thread.
#pragma once

namespace paths {

extern const char* const source_dir;
extern const char* const bin_dir;

}  // namespace paths
