// Keeps this process running when another one truncates a file of shared memory. Access to a missing page raises SIGBUS; the
// handler of the first guard replaces the whole mapping by private zeros. In an iface zeros mean: no simulator, no lease, no
// request. A reader of a port segment calls was_cut() afterwards. Other SIGBUS faults go to the previous handler. Any
// thread.
#pragma once

#include <cstddef>

namespace base {

class CutGuard {
 public:
  // The mapping must live as long as the guard. Past 65536 guards of a process the others guard nothing.
  CutGuard(void* base, std::size_t size);
  ~CutGuard();
  CutGuard(const CutGuard&) = delete;
  CutGuard& operator=(const CutGuard&) = delete;

 private:
  std::size_t slot_;
};

// True when the mapping that starts there has been replaced by zeros.
bool was_cut(const void* base);
// How often that has happened in this process.
std::size_t cuts();

}  // namespace base
