// Calls listeners periodically from one thread of its own. Any thread, listeners included.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <thread>

#include "coil/Listener.h"
#include "coil/TimeValue.h"

namespace coil {

// What registering returns: valid until the listener is unregistered.
using ListenerId = const void*;

class Timer {
 public:
  // The timer wakes up once per interval: listeners are called at the first wake-up after their period has passed.
  explicit Timer(TimeValue interval);
  ~Timer();
  Timer(const Timer&) = delete;
  Timer& operator=(const Timer&) = delete;

  void start();
  void stop();
  // Waits until the thread has ended, after stop().
  void join();
  // One wake-up, by hand.
  void invoke();

  // The timer deletes the listener.
  ListenerId registerListener(ListenerBase* listener, TimeValue period);
  template <class ListenerClass>
  ListenerId registerListenerObj(ListenerClass* object, void (ListenerClass::*callback)(), TimeValue period) {
    return registerListenerFunc([object, callback] { (object->*callback)(); }, period);
  }
  ListenerId registerListenerFunc(std::function<void()> callback, TimeValue period);
  // False for an unknown one. A call that is under way is not waited for.
  bool unregisterListener(ListenerId id);

 private:
  struct Entry {
    std::shared_ptr<ListenerBase> listener;
    std::chrono::nanoseconds period;
    std::chrono::nanoseconds remains;
  };

  void run();

  const std::chrono::nanoseconds interval_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool is_running_ = false;
  std::list<Entry> entries_;
  std::thread thread_;
};

}  // namespace coil
