// Holds a mutex (coil::Mutex, std::mutex, ...) from construction to destruction.
#pragma once

#include "coil/NonCopyable.h"

namespace coil {

template <class M>
class Guard : private NonCopyable {
 public:
  explicit Guard(M& mutex) : mutex_(mutex) { mutex_.lock(); }
  ~Guard() { mutex_.unlock(); }

 private:
  M& mutex_;
};

}  // namespace coil
