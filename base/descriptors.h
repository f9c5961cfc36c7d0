// Limit of open files and connections of this process, and the state of its output. Any thread.
#pragma once

#include <cstddef>

namespace base {

// Raises the soft limit to the hard one, which only programs that use select() need lower. The limit that holds now; 0 when it is not
// known.
std::size_t raise_descriptor_limit();

// The reader of the pipe that standard output is has gone, as after `rtse print PORT | head`: there is nobody to be told of it.
bool output_is_closed();

}  // namespace base
