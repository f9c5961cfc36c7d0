// One object of a class per process, made at the first use. Any thread.
#pragma once

#include "coil/NonCopyable.h"

namespace coil {

template <class SingletonClass>
class Singleton {
 public:
  static SingletonClass& instance() {
    // Never destroyed: modules and threads may use it until the very end of the process.
    static SingletonClass* const object = new SingletonClass();
    return *object;
  }
  Singleton(const Singleton&) = delete;
  Singleton& operator=(const Singleton&) = delete;

 protected:
  Singleton() = default;
  ~Singleton() = default;
};

}  // namespace coil
