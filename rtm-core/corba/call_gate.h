// Lets calls in to something that will go, and out again: close() returns when nobody is inside. For servants that outlive what they serve.
// Any thread; a thread that is inside must not close.
#pragma once

#include <omniORB4/CORBA.h>

#include <chrono>
#include <condition_variable>

#include "base/guarded.h"

namespace corba {

class CallGate {
 public:
  // Throws CORBA::OBJECT_NOT_EXIST when the gate is closed.
  class Inside {
   public:
    explicit Inside(CallGate& gate) : gate_(gate) {
      auto data = gate_.shared_.lock();
      if (data->closed) throw CORBA::OBJECT_NOT_EXIST();
      ++data->inside;
    }
    ~Inside() {
      --gate_.shared_.lock()->inside;
      gate_.empty_.notify_all();
    }
    Inside(const Inside&) = delete;
    Inside& operator=(const Inside&) = delete;

   private:
    CallGate& gate_;
  };

  void close() {
    auto data = shared_.lock();
    data->closed = true;
    while (data->inside > 0) data.wait_for(empty_, std::chrono::hours(1), [&] { return data->inside == 0; });
  }

 private:
  struct Data {
    bool closed = false;
    int inside = 0;
  };
  base::Guarded<Data, base::Rank::registry> shared_;
  std::condition_variable empty_;
};

}  // namespace corba
