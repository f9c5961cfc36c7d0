// Asynchronous requests to the simulator: a thread sends them, and the event loop receives the answers. The public functions belong to one
// thread at a time, and answers are delivered in it.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <thread>

#include "base/guarded.h"
#include "base/result.h"
#include "shm/requests.h"

namespace gateway {

class AsyncRequests {
 public:
  // Shorter than what a client waits for (5 s), so that it hears of a failure.
  static constexpr std::chrono::seconds limit{3};
  static constexpr std::size_t max_waiting = 1000;

  using Done = std::function<void(base::Result<shm::Reply>)>;
  // Slow work with the reply, on the thread of the requests, before `done`.
  using Work = std::function<void(const base::Result<shm::Reply>&)>;

  explicit AsyncRequests(std::uint32_t server_id);
  ~AsyncRequests();  // what has not been asked yet is dropped
  AsyncRequests(const AsyncRequests&) = delete;
  AsyncRequests& operator=(const AsyncRequests&) = delete;

  // In the order of the calls. `done` is called by deliver(), with an error too when the simulator rejected.
  void post(shm::Request request, Done done, std::chrono::nanoseconds timeout = limit, Work work = {});
  // Readable when there are answers; an eventfd.
  int descriptor() const { return descriptor_; }
  void deliver();

 private:
  struct Job {
    shm::Request request;
    Done done;
    std::chrono::steady_clock::time_point deadline;
    Work work;
  };
  struct Answer {
    Done done;
    base::Result<shm::Reply> reply;
  };
  void run(const std::stop_token& stop);

  const std::uint32_t server_id_;
  int descriptor_ = -1;
  struct Queues {
    std::deque<Job> jobs;
    std::deque<Answer> answers;
  };
  base::Guarded<Queues, base::Rank::queue> queues_;
  std::condition_variable_any posted_;
  std::jthread thread_;  // last: it uses the others
};

}  // namespace gateway
