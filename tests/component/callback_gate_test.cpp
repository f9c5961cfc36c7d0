#include "core/callback_gate.h"

#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <optional>
#include <thread>
#include <vector>

namespace {

using namespace std::chrono_literals;
using rt::CallbackGate;
using Answer = CallbackGate::Answer;
using Caller = CallbackGate::Caller;
using Visit = CallbackGate::Visit;

std::chrono::steady_clock::time_point at_once() { return std::chrono::steady_clock::now(); }
std::chrono::steady_clock::time_point watchdog() { return std::chrono::steady_clock::now() + 60s; }

// A thread that is inside until it is told to leave.
class Insider {
 public:
  explicit Insider(CallbackGate& gate, const char* callback = "onExecute")
      : thread_([this, &gate, callback] {
          Visit visit(gate, callback, Caller::local);
          if (visit.answer() != Answer::inside) visit.wait(watchdog());
          entered_.set_value(visit.answer());
          leave_.get_future().wait();
        }) {}
  ~Insider() { leave(); }
  void leave() {
    if (!thread_.joinable()) return;
    leave_.set_value();
    thread_.join();
  }
  Answer answer() { return entered_.get_future().get(); }

 private:
  std::promise<Answer> entered_;
  std::promise<void> leave_;
  std::thread thread_;
};

// What a thread of its own is answered.
Answer ask(CallbackGate& gate, Caller caller, std::chrono::steady_clock::time_point deadline) {
  return std::async(std::launch::async,
                    [&] {
                      Visit visit(gate, "onError", caller);
                      return visit.answer() == Answer::inside ? visit.answer() : visit.wait(deadline);
                    })
      .get();
}

// The turn of a thread that waits cannot be seen: so many wait as are refused when the time is over.
struct Waiter {
  Waiter(CallbackGate& gate, Caller caller, std::chrono::steady_clock::time_point deadline)
      : answer(std::async(std::launch::async, [&gate, caller, deadline, this] {
          Visit visit(gate, "onReset", caller);
          is_asking = true;
          return visit.answer() == Answer::inside ? visit.answer() : visit.wait(deadline);
        })) {}
  std::atomic<bool> is_asking{false};
  std::future<Answer> answer;
};

TEST(CallbackGate, lets_in_one_thread_at_a_time) {
  CallbackGate gate;
  std::atomic<int> inside{0}, most{0}, entered{0};
  {
    std::vector<std::jthread> threads;
    for (int i = 0; i < 8; ++i)
      threads.emplace_back([&, i] {
        for (int n = 0; n < 500; ++n) {
          Visit visit(gate, "onExecute", i % 2 ? Caller::remote : Caller::local);
          if (visit.answer() != Answer::inside && visit.wait(watchdog()) != Answer::inside) continue;
          const int now = ++inside;
          if (now > most) most = now;
          ++entered;
          --inside;
        }
      });
  }
  EXPECT_EQ(most, 1);
  EXPECT_EQ(entered, 4000);
  EXPECT_TRUE(gate.inside().empty());
}

TEST(CallbackGate, a_callback_calls_another_one_on_its_own_thread) {
  CallbackGate gate;
  Visit outer(gate, "onExecute", Caller::local);
  {
    Visit inner(gate, "onRateChanged", Caller::remote);
    EXPECT_EQ(inner.answer(), Answer::inside);
    EXPECT_EQ(gate.inside().size(), 2u);
  }
  EXPECT_EQ(gate.inside().size(), 1u);
  EXPECT_TRUE(gate.others_inside().empty());
  EXPECT_EQ(gate.describe(), "");
  EXPECT_TRUE(gate.is_inside());
}

TEST(CallbackGate, a_callback_calls_another_one_although_others_wait) {
  CallbackGate gate;
  std::optional<Visit> outer;
  outer.emplace(gate, "onExecute", Caller::local);
  Waiter waiter(gate, Caller::local, watchdog());
  while (!waiter.is_asking) std::this_thread::yield();
  {
    const Visit inner(gate, "onRateChanged", Caller::local);
    EXPECT_EQ(inner.answer(), Answer::inside);
  }
  EXPECT_TRUE(gate.wait_until_empty(watchdog())) << "nor does it wait for those who wait for it";
  outer.reset();
  EXPECT_EQ(waiter.answer.get(), Answer::inside);
}

TEST(CallbackGate, who_comes_too_early_is_answered_busy) {
  CallbackGate gate;
  Insider insider(gate);
  ASSERT_EQ(insider.answer(), Answer::inside);
  Visit visit(gate, "onError", Caller::remote);
  EXPECT_EQ(visit.answer(), Answer::busy);
  EXPECT_EQ(visit.wait(at_once()), Answer::busy);
  EXPECT_TRUE(gate.describe().starts_with("onExecute has run for ")) << gate.describe();
  insider.leave();
  EXPECT_EQ(visit.wait(at_once()), Answer::inside);
}

TEST(CallbackGate, who_gives_up_does_not_hold_those_behind) {
  CallbackGate gate;
  Insider insider(gate);
  ASSERT_EQ(insider.answer(), Answer::inside);
  Waiter impatient(gate, Caller::local, std::chrono::steady_clock::now() + 20ms);
  while (!impatient.is_asking) std::this_thread::yield();
  Insider behind(gate, "onReset");
  EXPECT_EQ(impatient.answer.get(), Answer::busy);
  insider.leave();
  EXPECT_EQ(behind.answer(), Answer::inside);
}

TEST(CallbackGate, a_limited_number_of_remote_callers_waits) {
  CallbackGate gate;
  Insider insider(gate);
  ASSERT_EQ(insider.answer(), Answer::inside);
  std::vector<std::future<Answer>> answers;
  std::atomic<int> crowded{0};
  constexpr int more = 6;
  for (std::size_t i = 0; i < CallbackGate::max_waiting + more; ++i)
    answers.push_back(std::async(std::launch::async, [&] {
      Visit visit(gate, "onError", Caller::remote);
      if (visit.wait(watchdog()) == Answer::crowded) ++crowded;
      return visit.answer();
    }));
  while (crowded < more) std::this_thread::yield();
  EXPECT_EQ(ask(gate, Caller::local, at_once()), Answer::busy) << "local callers have no such limit";
  insider.leave();
  int inside = 0;
  for (auto& answer : answers) inside += answer.get() == Answer::inside;
  EXPECT_EQ(inside, static_cast<int>(CallbackGate::max_waiting));
  EXPECT_EQ(crowded, more);
}

TEST(CallbackGate, a_gate_that_is_closed_refuses_remote_callers_and_those_who_wait) {
  CallbackGate gate;
  Insider insider(gate);
  ASSERT_EQ(insider.answer(), Answer::inside);
  Waiter waiter(gate, Caller::remote, watchdog());
  while (!waiter.is_asking) std::this_thread::yield();
  gate.close_to_remote();
  EXPECT_EQ(waiter.answer.get(), Answer::closed);
  insider.leave();
  EXPECT_EQ(ask(gate, Caller::remote, watchdog()), Answer::closed);
  EXPECT_EQ(ask(gate, Caller::local, watchdog()), Answer::inside);
}

TEST(CallbackGate, nobody_waits_for_a_callback_that_was_given_up) {
  CallbackGate gate;
  Insider insider(gate);
  ASSERT_EQ(insider.answer(), Answer::inside);
  Waiter waiter(gate, Caller::local, watchdog());
  EXPECT_FALSE(gate.wait_until_empty(std::chrono::steady_clock::now() + 20ms));
  EXPECT_EQ(waiter.answer.get(), Answer::busy) << "one that waited before";
  EXPECT_EQ(ask(gate, Caller::local, watchdog()), Answer::busy);
  EXPECT_FALSE(gate.wait_until_empty(watchdog()));
  insider.leave();
  EXPECT_EQ(ask(gate, Caller::remote, watchdog()), Answer::inside);
  EXPECT_TRUE(gate.wait_until_empty(at_once()));
}

TEST(CallbackGate, the_wait_for_an_empty_gate_ends_however_many_come) {
  CallbackGate gate;
  std::atomic<bool> stop{false};
  std::vector<std::jthread> threads;
  for (int i = 0; i < 4; ++i)
    threads.emplace_back([&] {
      while (!stop) {
        Visit visit(gate, "onExecute", Caller::remote);
        if (visit.answer() != Answer::inside) visit.wait(watchdog());
      }
    });
  for (int i = 0; i < 100; ++i) EXPECT_TRUE(gate.wait_until_empty(watchdog()));
  stop = true;
}

}  // namespace
