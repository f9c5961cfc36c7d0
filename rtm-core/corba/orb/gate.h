// Counts calls from outside into an object. Before the object is destroyed, the gate waits until all calls have returned. Any thread.
#pragma once

#include <condition_variable>

#include "base/guarded.h"

namespace corba {

class Gate {
 public:
  class Visit {
   public:
    explicit Visit(Gate& gate) : gate_(gate.enter() ? &gate : nullptr) {}
    ~Visit() {
      if (gate_) gate_->leave();
    }
    Visit(const Visit&) = delete;
    Visit& operator=(const Visit&) = delete;
    // False: the gate is closed, stay out.
    explicit operator bool() const { return gate_; }

   private:
    Gate* gate_;
  };

  // Nobody gets in any more; returns when nobody is inside. Not to be called from inside. A second call waits as well.
  void close();

 private:
  struct State {
    bool is_closed = false;
    int inside = 0;
  };
  bool enter();
  void leave();

  base::Guarded<State, base::Rank::port> state_;
  std::condition_variable empty_;
};

}  // namespace corba
