// Polls the name server and its components on a thread of its own, and reports changes. Hanging components delay only this thread, by their
// timeout. Any thread.
#pragma once

#include <omniORB4/CORBA.h>

#include <chrono>
#include <condition_variable>
#include <functional>
#include <string>
#include <thread>

#include "base/guarded.h"
#include "studio/client_message.h"

namespace studio {

// A look at the system. Of the two texts one is enough: a new structure holds the states.
struct SystemNews {
  std::string structure;  // the event "system"; empty: as before
  std::string states;     // the event "states"; empty: as before
};

class SystemWatch {
 public:
  using Tell = std::function<void(SystemNews)>;  // on the thread of the watch

  SystemWatch(CORBA::ORB_ptr orb, std::string server, std::chrono::milliseconds limit, Tell tell);
  ~SystemWatch();
  SystemWatch(const SystemWatch&) = delete;
  SystemWatch& operator=(const SystemWatch&) = delete;

  // Nobody sees it: nothing is asked.
  void set_watched(bool is_watched);
  // Something was done to the system: look at once.
  void look_now();

 private:
  struct Data {
    bool is_watched = false, is_hurried = false, is_ending = false;
  };
  void run();
  Json look() const;
  void tell_changes(Json now);

  const CORBA::ORB_var orb_;
  const std::string server_;
  const std::chrono::milliseconds limit_;
  const Tell tell_;
  std::string structure_, states_;  // as told last; the thread's
  std::uint64_t revision_ = 0;
  base::Guarded<Data, base::Rank::manager> data_;
  std::condition_variable changed_;
  std::thread thread_;  // last: it uses all of these
};

}  // namespace studio
