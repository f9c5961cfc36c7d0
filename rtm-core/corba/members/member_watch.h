// Logs calls to other processes that take long while time waits for them: each call that exceeds one second, once, and its duration at the
// end. It changes no behaviour. One per execution context with remote members, and one for the ports of this process; any thread. Its own
// thread sleeps while there is no call.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "base/guarded.h"

namespace corba {

class MemberWatch {
 public:
  static constexpr std::chrono::seconds long_time{1};

  MemberWatch() : thread_([this] { run(); }) {}
  ~MemberWatch();
  MemberWatch(const MemberWatch&) = delete;
  MemberWatch& operator=(const MemberWatch&) = delete;

  // A call that runs as long as this lives. All must live as long. `who`: the member that is called, or the port that calls; then
  // `connection` is the one whose other end is called.
  class Call {
   public:
    Call(MemberWatch& watch, const std::string& who, std::string_view operation, const std::string* connection = nullptr);
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
    const std::string* who;
    std::string_view operation;
    const std::string* connection;
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
  static std::string text_of(const Running& call);

  base::Guarded<Data, base::Rank::connector> shared_;
  std::condition_variable changed_;
  std::thread thread_;  // last: it works with what is above
};

// What the log says of a port whose peer takes long; its name stands before it, the connection's behind it.
inline constexpr std::string_view port_waits_mark = ": the other end of connection ";

// Of the ports of this process, made with the first call; nullptr while there is no ORB.
void begin_port_watch();
std::shared_ptr<MemberWatch> port_watch();
void end_port_watch();

}  // namespace corba
