// The exceptions of the module. Each is a Python exception of the same name (module.cpp) with one line. Values; any thread.
#pragma once

#include <stdexcept>
#include <string>

#include "base/result.h"

namespace python {

// The simulator rejected what was asked, or the arguments do not fit.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};
class NotFound : public Error {
 public:
  using Error::Error;
};
class TimedOut : public Error {
 public:
  using Error::Error;
};
class ServerDied : public Error {
 public:
  using Error::Error;
};

template <class T>
T value_of(base::Result<T> result) {
  if (!result) throw Error(result.error().message);
  return std::move(*result);
}
inline void check(const base::Result<void>& result) {
  if (!result) throw Error(result.error().message);
}

}  // namespace python
