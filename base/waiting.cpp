#include "base/waiting.h"

namespace base {
namespace {

std::chrono::nanoseconds& account() {
  thread_local std::chrono::nanoseconds waited{0};
  return waited;
}

}  // namespace

ScopedWait::~ScopedWait() { account() += std::chrono::steady_clock::now() - start_; }

std::chrono::nanoseconds time_waited() { return account(); }

}  // namespace base
