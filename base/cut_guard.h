// Keeps this process alive when another one cuts a file of shared memory short. A page that is no longer behind a mapping raises SIGBUS
// where it is touched; the first guard installs a handler that then puts private zeros in the place of the whole mapping. In an iface zeros
// mean: no server, no lease, no request, so all code goes on as with an empty one; who reads a segment of a port asks was_cut() afterwards.
// Faults elsewhere go to the handler that was there before. Any thread.
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
