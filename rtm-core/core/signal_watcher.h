// Hands signals to a thread, so that what they cause need not be async-signal-safe. One watcher per process at a time.
// A signal that the program handles or ignores itself when the watcher is made is left to it. Another signal of the same number has its
// default effect: a second Ctrl-C ends the process at once. Within 50 ms it counts as the same one.
#pragma once

#include <functional>
#include <memory>
#include <vector>

namespace rt {

class SignalWatcher {
 public:
  // `call` runs on threads of the watcher, one call after the other.
  SignalWatcher(const std::vector<int>& signals, std::function<void(int)> call);
  // Restores the default handlers, 50 ms after the last signal; not from within the call.
  ~SignalWatcher();
  SignalWatcher(const SignalWatcher&) = delete;
  SignalWatcher& operator=(const SignalWatcher&) = delete;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rt
