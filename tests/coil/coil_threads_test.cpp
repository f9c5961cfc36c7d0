// Tasks, timers and the small classes of coil.
#include <coil/Affinity.h>
#include <coil/Async.h>
#include <coil/ClockManager.h>
#include <coil/Condition.h>
#include <coil/DynamicLib.h>
#include <coil/Factory.h>
#include <coil/File.h>
#include <coil/Guard.h>
#include <coil/Mutex.h>
#include <coil/OS.h>
#include <coil/PeriodicTask.h>
#include <coil/Process.h>
#include <coil/Signal.h>
#include <coil/Task.h>
#include <coil/Time.h>
#include <coil/Timer.h>
#include <coil/UUID.h>
#include <coil/atomic.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <future>
#include <memory>
#include <set>

namespace {

using namespace std::chrono_literals;

// Counts calls and lets a test wait for a number of them.
class Counter {
 public:
  void call() {
    coil::Guard<coil::Mutex> guard(mutex_);
    ++calls_;
    changed_.broadcast();
  }
  int svc() {
    call();
    return 0;
  }
  int wait_for(int calls) {
    coil::Guard<coil::Mutex> guard(mutex_);
    while (calls_ < calls && changed_.wait(60)) {
    }
    return calls_;
  }
  int calls() {
    coil::Guard<coil::Mutex> guard(mutex_);
    return calls_;
  }

 private:
  coil::Mutex mutex_;
  coil::Condition<coil::Mutex> changed_{mutex_};
  int calls_ = 0;
};

class CountingTask : public coil::Task {
 public:
  int svc() override {
    ++runs;
    return 0;
  }
  std::atomic<int> runs{0};
};

TEST(CoilTask, runs_svc_in_a_thread_of_its_own_and_can_be_activated_again) {
  CountingTask task;
  task.activate();
  task.wait();
  EXPECT_EQ(task.runs, 1);
  task.activate();
  task.wait();
  EXPECT_EQ(task.runs, 2);
  EXPECT_EQ(task.wait(), 0);
}

TEST(CoilPeriodicTask, runs_periodically_until_it_is_finalized) {
  Counter counter;
  coil::PeriodicTask task;
  EXPECT_FALSE(task.setTask(std::function<void()>()));
  EXPECT_TRUE(task.setTask(&counter, &Counter::svc));
  task.setPeriod(0.001);
  task.activate();
  EXPECT_GE(counter.wait_for(5), 5);
  task.finalize();
  const int calls = counter.calls();
  EXPECT_EQ(counter.calls(), calls);
  EXPECT_GT(task.getExecStat().max_interval, 0);
  task.activate();
  EXPECT_GE(counter.wait_for(calls + 1), calls + 1);
}

TEST(CoilPeriodicTask, a_suspended_task_runs_once_per_signal) {
  Counter counter;
  coil::PeriodicTask task;
  task.setTask(new coil::TaskFunc<Counter>(&counter, &Counter::svc));
  task.setPeriod(std::chrono::milliseconds(1));
  task.suspend();
  task.activate();
  for (int i = 1; i <= 20; ++i) {
    task.signal();
    EXPECT_EQ(counter.wait_for(i), i);
  }
  task.resume();
  EXPECT_GE(counter.wait_for(25), 25);
  task.finalize();
}

TEST(CoilPeriodicTask, a_signal_that_comes_while_the_function_runs_is_not_lost) {
  std::promise<void> entered, released;
  auto release = released.get_future();
  std::atomic<int> calls{0};
  Counter counter;
  coil::PeriodicTask task;
  task.setTask([&] {
    if (++calls == 1) {
      entered.set_value();
      release.wait();
    }
    counter.call();
  });
  task.suspend();
  task.activate();
  task.signal();
  entered.get_future().wait();
  task.signal();
  released.set_value();
  EXPECT_EQ(counter.wait_for(2), 2);
}

TEST(CoilTimer, a_listener_asks_the_timer_while_it_is_deleted) {
  coil::Timer timer(coil::TimeValue(0, 1000));
  const auto other = timer.registerListenerFunc([] {}, coil::TimeValue(1.0));
  std::shared_ptr<int> last_breath(new int, [&](const int* number) {
    delete number;
    EXPECT_TRUE(timer.unregisterListener(other));
  });
  auto id = timer.registerListenerFunc([owner = last_breath] {}, coil::TimeValue(1.0));
  last_breath.reset();
  EXPECT_TRUE(timer.unregisterListener(id));
}

TEST(CoilTimer, calls_listeners_when_their_period_has_passed) {
  coil::Timer timer(coil::TimeValue(0, 1000));
  Counter fast, slow;
  auto id = timer.registerListenerObj(&fast, &Counter::call, coil::TimeValue(0.001));
  timer.registerListenerFunc([&] { slow.call(); }, coil::TimeValue(0.003));
  for (int i = 0; i < 6; ++i) timer.invoke();
  EXPECT_EQ(fast.calls(), 6);
  EXPECT_EQ(slow.calls(), 2);
  EXPECT_TRUE(timer.unregisterListener(id));
  EXPECT_FALSE(timer.unregisterListener(id));
  timer.start();
  EXPECT_GE(slow.wait_for(4), 4);
  timer.stop();
  timer.join();
  EXPECT_EQ(fast.calls(), 6);
}

TEST(CoilAsync, invokes_a_member_function_in_another_thread) {
  Counter counter;
  std::unique_ptr<coil::Async> call(coil::AsyncInvoker(&counter, &Counter::call));
  EXPECT_FALSE(call->finished());
  call->invoke();
  call->wait();
  EXPECT_TRUE(call->finished());
  coil::AsyncInvoker(
      &counter, [](Counter* c) { c->call(); }, true)
      ->invoke();
  EXPECT_EQ(counter.wait_for(2), 2);
}

TEST(CoilTimeValue, keeps_seconds_and_microseconds_of_the_same_sign) {
  coil::TimeValue t(1, 1500000);
  EXPECT_EQ(t.sec(), 2);
  EXPECT_EQ(t.usec(), 500000);
  EXPECT_EQ(static_cast<double>(t - coil::TimeValue(3.0)), -0.5);
  EXPECT_EQ((coil::TimeValue() - t).sign(), -1);
  EXPECT_LT(coil::TimeValue(0.1), t);
  EXPECT_TRUE(t > 2.0);
  std::chrono::nanoseconds ns = t;
  EXPECT_EQ(ns, 2500ms);
  EXPECT_EQ(std::chrono::nanoseconds(t), 2500ms);
  EXPECT_EQ(coil::TimeValue(2500ms), t);
  t = 0.25;
  EXPECT_EQ(t.usec(), 250000);
}

TEST(CoilTimeMeasure, has_statistics_of_the_last_lengths) {
  coil::TimeMeasure measure(2);
  double max, min, mean, deviation;
  measure.tack();
  EXPECT_FALSE(measure.getStatistics(max, min, mean, deviation));
  for (int i = 0; i < 3; ++i) {
    measure.tick();
    measure.tack();
  }
  EXPECT_EQ(measure.count(), 2u);
  EXPECT_TRUE(measure.getStatistics(max, min, mean, deviation));
  EXPECT_LE(min, mean);
  EXPECT_LE(mean, max);
}

struct Animal {
  virtual ~Animal() = default;
};
struct Cow : Animal {};
struct Goat : Animal {};

TEST(CoilFactory, makes_and_deletes_objects_by_name) {
  auto& factory = coil::GlobalFactory<Animal>::instance();
  EXPECT_EQ(factory.addFactory("cow", coil::Creator<Animal, Cow>, coil::Destructor<Animal, Cow>), coil::FactoryReturn::OK);
  EXPECT_EQ(factory.addFactory("cow", coil::Creator<Animal, Cow>, coil::Destructor<Animal, Cow>),
            coil::GlobalFactory<Animal>::ALREADY_EXISTS);
  EXPECT_TRUE(factory.hasFactory("cow"));
  EXPECT_EQ(factory.createObject("goat"), nullptr);
  Animal* cow = factory.createObject("cow");
  ASSERT_NE(dynamic_cast<Cow*>(cow), nullptr);
  std::string id;
  EXPECT_EQ(factory.objectToIdentifier(cow, id), coil::FactoryReturn::OK);
  EXPECT_EQ(id, "cow");
  EXPECT_TRUE(factory.isProducerOf(cow));
  EXPECT_EQ(factory.deleteObject(cow), coil::FactoryReturn::OK);
  EXPECT_EQ(cow, nullptr);
  EXPECT_EQ(factory.removeFactory("cow"), coil::FactoryReturn::OK);
  EXPECT_EQ(factory.removeFactory("cow"), coil::FactoryReturn::NOT_FOUND);
}

TEST(CoilUuid, is_random_and_written_in_the_usual_form) {
  std::set<std::string> seen;
  coil::UUID_Generator generator;
  generator.init();
  for (int i = 0; i < 100; ++i) {
    std::unique_ptr<coil::UUID> uuid(generator.generateUUID(2, 0x01));
    EXPECT_EQ(uuid->to_string().size(), 36u);
    seen.insert(uuid->to_string());
  }
  EXPECT_EQ(seen.size(), 100u);
}

TEST(CoilFile, splits_paths_and_lists_folders) {
  EXPECT_EQ(coil::dirname("/usr/lib/x.so"), "/usr/lib/");
  EXPECT_EQ(coil::dirname("x.so"), "./");
  EXPECT_EQ(coil::basename("/usr/lib/x.so"), "x.so");
  const std::string dir = testing::TempDir() + "coil_file_" + std::to_string(coil::getpid());
  std::filesystem::create_directories(dir + "/sub");
  for (const char* name : {"/b.so", "/a.so", "/a.txt", "/sub/c.so"}) std::ofstream(dir + name) << "x";
  EXPECT_EQ(coil::filelist(dir, "*.so"), (std::vector<std::string>{"a.so", "b.so"}));
  EXPECT_TRUE(coil::filelist(dir + "/none").empty());
  std::vector<std::string> found;
  coil::findFile(dir, "c.so", found);
  EXPECT_EQ(found, (std::vector<std::string>{dir + "/sub/c.so"}));
  coil::getFileList(dir, "txt", found);
  EXPECT_EQ(found.size(), 2u);
  std::filesystem::remove_all(dir);
}

TEST(CoilProcess, runs_commands) {
  std::vector<std::string> lines;
  EXPECT_EQ(coil::create_process("printf 'one\\ntwo'", lines), 0);
  EXPECT_EQ(lines, (std::vector<std::string>{"one", "two"}));
  EXPECT_EQ(coil::create_process("exit 3", lines), -1);
  EXPECT_EQ(coil::launch_shell("true"), 0);
}

TEST(CoilDynamicLib, opens_a_library_or_says_why_not) {
  coil::DynamicLib library;
  EXPECT_EQ(library.symbol("cos"), nullptr);
  EXPECT_EQ(library.open("libnosuch.so"), -1);
  EXPECT_NE(std::string(library.error()).find("libnosuch.so"), std::string::npos);
  ASSERT_EQ(library.open("libm.so.6"), 0);
  EXPECT_NE(library.symbol("cos"), nullptr);
  EXPECT_EQ(library.symbol("no_such_function"), nullptr);
  EXPECT_NE(library.error(), nullptr);
  coil::DynamicLib copy(library);
  EXPECT_EQ(library.close(), 0);
  EXPECT_NE(copy.symbol("cos"), nullptr);
  EXPECT_THROW(coil::DynamicLib("libnosuch.so"), std::runtime_error);
}

TEST(CoilAffinity, is_what_was_set) {
  coil::CpuMask mask;
  ASSERT_TRUE(coil::getThreadCpuAffinity(mask));
  ASSERT_FALSE(mask.empty());
  EXPECT_TRUE(coil::setThreadCpuAffinity(std::to_string(mask[0])));
  coil::CpuMask now;
  EXPECT_TRUE(coil::getThreadCpuAffinity(now));
  EXPECT_EQ(now, coil::CpuMask{mask[0]});
  EXPECT_TRUE(coil::setThreadCpuAffinity(mask));
  EXPECT_FALSE(coil::setThreadCpuAffinity("-1"));
  EXPECT_FALSE(coil::setThreadCpuAffinity("x"));
  EXPECT_FALSE(coil::setThreadCpuAffinity(coil::CpuMask{}));
}

TEST(CoilClock, logical_time_is_what_was_set) {
  auto& clocks = coil::ClockManager::instance();
  EXPECT_TRUE(clocks.getClock("logical").settime(coil::TimeValue(12, 5)));
  EXPECT_EQ(clocks.getClock("logical").gettime(), coil::TimeValue(12, 5));
  EXPECT_TRUE(clocks.getClock("adjusted").settime(coil::TimeValue(100, 0)));
  EXPECT_GE(clocks.getClock("adjusted").gettime(), coil::TimeValue(100, 0));
  EXPECT_GT(clocks.getClock("system").gettime(), coil::TimeValue(1e9));
}

volatile std::sig_atomic_t signals = 0;
void count_signal(int) { signals = signals + 1; }

TEST(CoilSignal, handler_is_called) {
  coil::SignalAction action(count_signal, SIGUSR1);
  std::raise(SIGUSR1);
  EXPECT_EQ(signals, 1);
  coil::signal(SIGUSR1, SIG_DFL);
}

TEST(CoilOs, options_and_environment) {
  const char* arguments[] = {"program", "-a", "-f", "file", "rest"};
  coil::GetOpt options(5, const_cast<char* const*>(arguments), "af:", 0);
  EXPECT_EQ(options(), 'a');
  EXPECT_EQ(options(), 'f');
  EXPECT_STREQ(options.optarg, "file");
  EXPECT_EQ(options(), -1);
  EXPECT_EQ(options.optind, 4);
  std::string value;
  EXPECT_FALSE(coil::getenv("COIL_NO_SUCH_VARIABLE", value));
  EXPECT_EQ(coil::getenv("COIL_NO_SUCH_VARIABLE"), nullptr);
  coil::utsname name;
  EXPECT_EQ(coil::uname(&name), 0);
}

TEST(CoilAtomic, returns_the_value_from_before) {
  int value = 5;
  EXPECT_EQ(coil::atomic_incr(&value), 5);
  EXPECT_EQ(coil::atomic_add(&value, 10), 6);
  EXPECT_EQ(coil::atomic_decr(&value), 16);
  EXPECT_EQ(value, 15);
}

TEST(CoilTime, both_forms_of_the_wall_clock_agree) {
  timeval tv;
  EXPECT_EQ(coil::gettimeofday(&tv, nullptr), 0);
  EXPECT_GE(coil::gettimeofday(), coil::TimeValue(tv.tv_sec, 0));
  EXPECT_EQ(coil::usleep(1), 0);
  coil::sleep(coil::TimeValue(0, 1));
}

}  // namespace
