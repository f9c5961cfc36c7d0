// Ctrl-C for commands with processes to end: SIGINT, SIGTERM and SIGHUP set a mark that waiting code can read. Any thread.
#pragma once

#include <functional>
#include <thread>

namespace base {

// From now on the signals set the mark and do nothing else.
void catch_interrupts();
bool is_interrupted();
// Readable from the first interrupt on, for poll(); -1 before catch_interrupts().
int interrupt_handle();

// While it lives, an interrupt has this done, once, on a thread of its own: for what blocks and cannot look at the mark.
class OnInterrupt {
 public:
  explicit OnInterrupt(std::function<void()> act);
  ~OnInterrupt();
  OnInterrupt(const OnInterrupt&) = delete;
  OnInterrupt& operator=(const OnInterrupt&) = delete;

 private:
  const int end_;  // readable when it ends
  std::thread thread_;
};

}  // namespace base
