// Questions to many managers, so that those that hang cost the time of one. Any thread.
#pragma once

#include <cstddef>
#include <functional>

namespace RTM {

// Calls work(0) to work(count - 1), up to 64 of them at the same time, on behalf of whoever the calling thread works for. Returns when all
// have returned. `work` must not throw.
void at_once(std::size_t count, const std::function<void(std::size_t)>& work);

}  // namespace RTM
