// An asynchronous notifier: sends messages to one peer in order, on a thread of its own, so that a hanging peer delays no other thread. It
// also runs periodic work on that thread. Any thread.
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "base/guarded.h"

namespace corba {

class Courier {
 public:
  // Calls another process; may throw CORBA exceptions. After one the notifier logs one line and stops.
  using Message = std::function<void()>;
  // Maximum number of waiting messages. Further ones are dropped: such a queue belongs to a peer that hangs.
  static constexpr std::size_t max_waiting = 1000;

  explicit Courier(std::string name);
  ~Courier();
  Courier(const Courier&) = delete;
  Courier& operator=(const Courier&) = delete;

  void send(Message message);
  // Replaces what was there.
  struct Regular {
    std::chrono::nanoseconds interval;
    Message message;
  };
  void repeat(std::vector<Regular> regulars);
  // Still sends the waiting messages, for at most `timeout`. Then like stop(). Not to be called from a message.
  void finish(std::chrono::nanoseconds timeout = std::chrono::seconds(1));
  // Sends nothing more after return, except for one message that may be in progress.
  void stop();

 private:
  using Time = std::chrono::steady_clock::time_point;
  struct Due {
    Regular regular;
    Time next;
  };
  struct Data {
    bool stopping = false;
    bool gave_up = false;
    bool is_finishing = false;
    bool is_carrying = false;
    bool rescheduled = false;
    std::deque<Message> waiting{};
    std::vector<Due> regulars{};
  };
  void run();
  bool carry(const Message& message);

  const std::string name_;
  base::Guarded<Data, base::Rank::queue> shared_;
  std::condition_variable condition_;
  std::condition_variable finished_;
  std::thread thread_;
};

}  // namespace corba
