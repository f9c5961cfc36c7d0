// A shared library opened at run time, closed with this object. One thread at a time.
#pragma once

#include <string>

namespace coil {

class DynamicLib {
 public:
  // Flags as for dlopen; the default is RTLD_NOW.
  explicit DynamicLib(int dlflags = 0x2);
  // Opens it; throws std::runtime_error if that fails.
  explicit DynamicLib(const char* dynlib, int dlflags = 0x2);
  ~DynamicLib();
  // Both refer to the library then.
  DynamicLib(const DynamicLib& other);
  DynamicLib& operator=(const DynamicLib& other);

  // 0, or -1 with error() set.
  int open(const char* dll_name);
  int open(const std::string& dll_name) { return open(dll_name.c_str()); }
  int close();
  // nullptr with error() set if there is none.
  void* symbol(const char* symbol_name);
  void* symbol(const std::string& symbol_name) { return symbol(symbol_name.c_str()); }
  // What went wrong last, or nullptr.
  const char* error() const { return error_.empty() ? nullptr : error_.c_str(); }

 private:
  std::string name_;
  int flags_;
  void* handle_ = nullptr;
  std::string error_;
};

}  // namespace coil
