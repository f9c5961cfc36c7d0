// The memory of a reader of files under test. The address sanitizer needs more address space than a limit leaves, and then nothing stops
// a file that says it has 4294967295 corners: most of the time goes into clearing pages. Here operator new counts instead, and fails as it
// does at the limit, by std::bad_alloc. Linking this replaces it in the whole program.
#pragma once

#include <cstddef>
#include <cstdint>

namespace fuzz {

// From now on this process has so many bytes more than it has now.
void limit_memory(std::size_t bytes);

// Whether a frame of a stack is operator new or delete as they are here: what is wrong there is the caller's fault.
bool is_allocation(std::uintptr_t address);

}  // namespace fuzz
