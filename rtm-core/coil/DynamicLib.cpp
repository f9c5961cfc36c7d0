#include "coil/DynamicLib.h"

#include <dlfcn.h>

#include <stdexcept>

namespace coil {
namespace {

std::string last_error() {
  const char* text = ::dlerror();
  return text != nullptr ? text : "unknown error of the dynamic loader";
}

}  // namespace

DynamicLib::DynamicLib(int dlflags) : flags_(dlflags) {}

DynamicLib::DynamicLib(const char* dynlib, int dlflags) : flags_(dlflags) {
  if (open(dynlib) != 0) throw std::runtime_error(error_);
}

DynamicLib::~DynamicLib() { close(); }

DynamicLib::DynamicLib(const DynamicLib& other) : flags_(other.flags_) {
  if (other.handle_ != nullptr) open(other.name_);
}

DynamicLib& DynamicLib::operator=(const DynamicLib& other) {
  if (this == &other) return *this;
  close();
  flags_ = other.flags_;
  if (other.handle_ != nullptr) open(other.name_);
  return *this;
}

int DynamicLib::open(const char* dll_name) {
  close();
  error_.clear();
  handle_ = ::dlopen(dll_name, flags_);
  if (handle_ == nullptr) {
    error_ = last_error();
    return -1;
  }
  name_ = dll_name;
  return 0;
}

int DynamicLib::close() {
  if (handle_ == nullptr) return -1;
  const int result = ::dlclose(handle_);
  handle_ = nullptr;
  return result == 0 ? 0 : -1;
}

void* DynamicLib::symbol(const char* symbol_name) {
  error_.clear();
  if (handle_ == nullptr) {
    error_ = "no library is open";
    return nullptr;
  }
  void* address = ::dlsym(handle_, symbol_name);
  if (address == nullptr) error_ = last_error();
  return address;
}

}  // namespace coil
