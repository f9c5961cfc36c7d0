// A module that ends the process that loads it, with half a profile on its output.
#include <cstdlib>
#include <iostream>

namespace {

[[maybe_unused]] const bool ended = [] {
  std::cout << "implementation_id: Half\n---\nimplementation_id:" << std::flush;
  std::abort();
  return true;
}();

}  // namespace
