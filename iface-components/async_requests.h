// Asynchronous requests to a simulation. A component in lock step must not wait for an answer: the simulator answers between ticks, and the
// tick waits for the component. post() from any thread.
#pragma once

#include <base/guarded.h>
#include <shm/requests.h>

#include <condition_variable>
#include <deque>
#include <thread>

#include "iface_link.h"

namespace iface {

class AsyncRequests {
 public:
  explicit AsyncRequests(Say say);
  ~AsyncRequests();  // what has not been asked yet is dropped

  // In the order of the calls. Failures are said. Posts beyond a hundred that wait are rejected and said.
  void post(int server_id, const shm::Request& request);

 private:
  struct Job {
    int server_id;
    shm::Request request;
  };
  void run(const std::stop_token& stop);

  Say say_;
  base::Guarded<std::deque<Job>, base::Rank::queue> jobs_;
  std::condition_variable_any posted_;
  base::Turn<> starting_;  // the thread, with the first post
  std::jthread thread_;    // last: it uses the others
};

}  // namespace iface
