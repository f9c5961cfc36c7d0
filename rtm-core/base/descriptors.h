// How many files and connections this process may have open. Any thread.
#pragma once

#include <cstddef>

namespace base {

// Raises the soft limit to the hard one, which only programs that use select() need lower. The limit that holds now; 0 when it is not
// known.
std::size_t raise_descriptor_limit();

}  // namespace base
