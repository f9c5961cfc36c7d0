// The allocator of the 1.x API is the standard one.
#pragma once

#include <memory>

namespace coil {

template <class T>
using Allocator = std::allocator<T>;

}  // namespace coil
