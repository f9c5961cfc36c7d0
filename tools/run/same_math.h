// The same results on every processor. glibc's sin, cos, exp, pow and their like come in versions with and without fused multiply-add,
// whose last bits differ; which one runs depends on the processor. All processes of a run use the version without. Any thread.
#pragma once

#include <string>
#include <utility>

namespace tools {

// For the environment of a process: the variable of glibc that says so, with whatever else it says already.
std::pair<std::string, std::string> same_math();

}  // namespace tools
