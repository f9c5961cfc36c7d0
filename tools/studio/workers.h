// Threads for slow work: calls to components, requests to the simulator, programs. The loop posts work and never waits. Any thread can
// post; the destructor drops work that has not started and waits for the rest.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <thread>
#include <vector>

#include "base/guarded.h"

namespace studio {

class Workers {
 public:
  using Work = std::function<void()>;

  explicit Workers(std::size_t threads);
  ~Workers();
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  // False: so much waits already that it would not be done soon.
  bool give(Work work);

 private:
  Workers() = default;
  struct Data {
    std::deque<Work> waiting;
    bool is_ending = false;
  };
  void run();

  base::Guarded<Data, base::Rank::manager> data_;
  std::condition_variable changed_;
  std::vector<std::thread> threads_;  // last: they use all of these
};

}  // namespace studio
