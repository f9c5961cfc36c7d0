// Tells of members of other processes that take long: the log names each call that has lasted a second, once, and how long it took in the
// end. Nothing depends on it. One per execution context that has such members; any thread. Its own thread sleeps while nobody is called.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <string>
#include <thread>
#include <vector>

#include "base/guarded.h"
#include "core/lifecycle.h"

namespace corba {

class MemberWatch {
 public:
  static constexpr std::chrono::seconds long_time{1};

  MemberWatch() : thread_([this] { run(); }) {}
  ~MemberWatch();
  MemberWatch(const MemberWatch&) = delete;
  MemberWatch& operator=(const MemberWatch&) = delete;

  // A call that runs as long as this lives. The name must live as long.
  class Call {
   public:
    Call(MemberWatch& watch, const std::string& member, rt::Action action);
    ~Call();
    Call(const Call&) = delete;
    Call& operator=(const Call&) = delete;

   private:
    MemberWatch& watch_;
    std::uint64_t number_;
  };

 private:
  using Clock = std::chrono::steady_clock;
  struct Running {
    std::uint64_t number;
    const std::string* member;
    rt::Action action;
    Clock::time_point since;
    bool is_told;
  };
  struct Data {
    bool stopping = false;
    bool sleeps = false;  // until somebody is called
    std::uint64_t last = 0;
    std::vector<Running> running{};
  };
  void run();
  bool look(std::uint64_t& seen);

  base::Guarded<Data, base::Rank::connector> shared_;
  std::condition_variable changed_;
  std::thread thread_;  // last: it works with what is above
};

}  // namespace corba
