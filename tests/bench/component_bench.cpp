// Execution contexts: what rate is got, what a cycle costs, and how many components stay on time. Beside each number its limit; beside the
// thousand, the same number of bare threads that sleep until the same deadlines, for what the machine can do at this moment.
//   component_bench [SECONDS [COMPONENTS]]
#include <rtm/DataFlowComponentBase.h>
#include <rtm/ECFactory.h>
#include <rtm/ExecutionContextServant.h>
#include <rtm/NVUtil.h>
#include <sys/prctl.h>
#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <thread>
#include <vector>

#include "component/runtime_access.h"
#include "corba/orb/orb.h"
#include "support/usage.h"

namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

double seconds(Clock::duration time) { return std::chrono::duration<double>(time).count(); }

void row(const std::string& what, double value, const char* unit, const char* limit, bool is_good) {
  std::printf("| %-52s | %10.3f %-5s | %-14s | %s |\n", what.c_str(), value, unit, limit, is_good ? "ok  " : "MISS");
}
void row(const std::string& what, double value, const char* unit) {
  std::printf("| %-52s | %10.3f %-5s | %-14s |      |\n", what.c_str(), value, unit, "");
}

// Steps when it is told to, on the caller's thread.
class ManualContext final : public RTC::ExecutionContextServant<POA_RTC::ExecutionContextService> {
 public:
  ManualContext() : ExecutionContextServant("manual_ec") { setObjRef(RTC::ExecutionContextService_var(_this())); }
  void cycle() { invokeWorker(); }
};

// What an author's component is, without the author: keeps the begin of each cycle when it has been given room.
class Empty final : public RTC::DataFlowComponentBase {
 public:
  explicit Empty(const char* context, const char* rate, std::size_t room = 0) : RTC::DataFlowComponentBase(nullptr) {
    static std::atomic<int> number{0};
    setInstanceName(("Empty" + std::to_string(number++)).c_str());
    m_properties["exec_cxt.periodic.type"] = context;
    m_properties["exec_cxt.periodic.rate"] = rate;
    begins.reserve(room);
  }
  RTC::ReturnCode_t onExecute(RTC::UniqueId) override {
    if (begins.size() < begins.capacity()) begins.push_back(Clock::now());
    return RTC::RTC_OK;
  }
  RTC::ExecutionContextBase& context() { return *RTC::RuntimeAccess::own_contexts(*this).at(0); }
  std::uint64_t statistic(const char* name) {
    const RTC::ExecutionContextProfile_var profile = context().getProfile();
    return std::strtoull(NVUtil::toString(profile->properties, name).c_str(), nullptr, 10);
  }
  std::vector<Clock::time_point> begins;
};

void give_back(Empty* component) {
  component->exit();
  component->_remove_ref();
}

double percentile(std::vector<double>& values, double share) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, at);
  return *at;
}

void rate_of_1000_hz(double duration) {
  const auto cycles = static_cast<std::size_t>(duration * 1000);
  auto* component = new Empty("PeriodicExecutionContext", "1000", cycles);
  component->initialize();
  component->activate(0);
  while (component->statistic("statistics.cycles") <= cycles) std::this_thread::sleep_for(10ms);
  const auto& begins = component->begins;
  // The delay of each cycle against the ideal one: its growth is the drift, whatever single cycles suffer on a loaded machine.
  std::vector<double> delays;
  for (std::size_t i = 0; i < begins.size(); ++i) delays.push_back(seconds(begins[i] - begins[0]) - static_cast<double>(i) / 1000);
  const std::size_t quarter = delays.size() / 4;
  std::vector<double> first(delays.begin(), delays.begin() + static_cast<std::ptrdiff_t>(quarter));
  std::vector<double> last(delays.end() - static_cast<std::ptrdiff_t>(quarter), delays.end());
  const double drift = (percentile(last, 0.5) - percentile(first, 0.5)) / (duration * 3 / 4);  // [s/s]
  const double best = percentile(delays, 0);
  for (double& delay : delays) delay = (delay - best) * 1e6;
  row("1000 Hz asked: cycles a second", 1000 / (1 + drift), "Hz", "1000.0 +- 0.05", std::abs(drift) < 5e-5);
  row("1000 Hz: delay of a cycle, median", percentile(delays, 0.5), "us");
  row("1000 Hz: delay of a cycle, 99 %", percentile(delays, 0.99), "us");
  row("1000 Hz: missed cycles", static_cast<double>(component->statistic("statistics.missed_cycles")), "");
  give_back(component);
}

void cost_of_a_cycle() {
  RTC::ExecutionContextFactory::instance().addFactory("ManualContext", coil::Creator<RTC::ExecutionContextBase, ManualContext>,
                                                      coil::Destructor<RTC::ExecutionContextBase, ManualContext>);
  auto* component = new Empty("ManualContext", "1000");
  component->initialize();
  auto& context = dynamic_cast<ManualContext&>(component->context());
  const RTC::RTObject_var self = component->getObjRef();
  std::jthread activator([&] { component->activate(0); });
  while (context.getComponentState(self) != RTC::ACTIVE_STATE) context.cycle();
  activator.join();
  double best = 1e30;
  for (int burst = 0; burst < 200; ++burst) {
    constexpr int cycles = 2000;
    const auto start = Clock::now();
    for (int i = 0; i < cycles; ++i) context.cycle();
    best = std::min(best, seconds(Clock::now() - start) / cycles);
  }
  row("empty cycle of one component", best * 1e6, "us", "< 1", best < 1e-6);
  component->context().stop();
  give_back(component);
}

double cpu_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto of = [](const timeval& time) { return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_usec) * 1e-6; };
  return of(usage.ru_utime) + of(usage.ru_stime);
}

// Threads that do nothing but meet their deadlines; a deadline that is missed by more than ten periods counts as in PeriodicWorker.
void bare_threads(int count, double duration, double& cpu, std::uint64_t& missed) {
  std::atomic<bool> stops{false};
  std::atomic<std::uint64_t> all_missed{0};
  std::vector<std::thread> threads;
  for (int i = 0; i < count; ++i)
    threads.emplace_back([&] {
      prctl(PR_SET_TIMERSLACK, 1UL);
      auto cycle = Clock::now();
      while (!stops) {
        cycle += 10ms;
        std::this_thread::sleep_until(cycle);
        const auto late = (Clock::now() - cycle) / 10ms;
        if (late <= 10) continue;
        cycle += late * 10ms;
        all_missed += static_cast<std::uint64_t>(late);
      }
    });
  const double before = cpu_seconds();
  std::this_thread::sleep_for(std::chrono::duration<double>(duration));
  cpu = (cpu_seconds() - before) / duration;
  stops = true;
  for (std::thread& thread : threads) thread.join();
  missed = all_missed;
}

struct Crowd {
  Crowd(int count, const char* contexts) {
    for (int i = 0; i < count; ++i) {
      components.push_back(new Empty("PeriodicExecutionContext", "100"));
      if (contexts) components.back()->getProperties()["execution_contexts"] = contexts;
      if (contexts) components.back()->getProperties()["exec_cxt.sync_transition"] = "NO";
      components.back()->initialize();
      components.back()->activate(0);
    }
    contexts_of_its_own = contexts == nullptr;
  }
  ~Crowd() {
    for (Empty* component : components) give_back(component);
  }
  std::uint64_t sum(const char* name) {
    std::uint64_t all = 0;
    for (Empty* component : components) {
      all += component->statistic(name);
      if (!contexts_of_its_own) return all * components.size();
    }
    return all;
  }
  std::vector<Empty*> components;
  bool contexts_of_its_own = true;
};

void crowd(int count, double duration, const char* contexts, const std::string& how, double bare_cpu) {
  Crowd all(count, contexts);
  std::this_thread::sleep_for(2s);  // what was late at the beginning is made good
  // Asking takes its time: each count is that of the middle of it.
  const auto count_cycles = [&](Clock::time_point& when) {
    const auto begin = Clock::now();
    const std::uint64_t cycles = all.sum("statistics.cycles");
    when = begin + (Clock::now() - begin) / 2;
    return cycles;
  };
  Clock::time_point start, end;
  const auto missed = all.sum("statistics.missed_cycles");
  const auto cycles = count_cycles(start);
  const double before = cpu_seconds();
  std::this_thread::sleep_for(std::chrono::duration<double>(duration));
  const double cpu = (cpu_seconds() - before) / duration;
  const auto more = count_cycles(end) - cycles;
  const double took = seconds(end - start);
  const double got = static_cast<double>(more) / took / count;
  const auto lost = static_cast<double>(all.sum("statistics.missed_cycles") - missed);
  const std::string name = std::to_string(count) + " components, " + how + ": ";
  row(name + "cycles a second", got, "Hz", ">= 99.9", got + 1 / took >= 99.9);  // one cycle more or less is where the window ends
  row(name + "missed cycles", lost, "", "0", lost == 0);
  row(name + "processors used", cpu, "");
  if (bare_cpu > 0) row(name + "the same / bare threads", cpu / bare_cpu, "");
}

}  // namespace

int main(int argc, char** argv) {
  ::test::answer_help(argc, argv,
                      "component_bench [SECONDS [COMPONENTS]]\nMeasures execution contexts beside plain threads (5 s, 1000 components).");
  const double duration = argc > 1 ? std::atof(argv[1]) : 5;
  const int count = argc > 2 ? std::atoi(argv[2]) : 1000;
  auto orb = corba::Orb::start({.endpoints = {}, .arguments = {}});
  if (!orb) return std::fprintf(stderr, "%s\n", orb.error().message.c_str()), 1;
  (*orb)->activate();
  std::printf("| measured                                             | value            | limit          |      |\n|---|---|---|---|\n");
  cost_of_a_cycle();
  rate_of_1000_hz(duration);
  double cpu = 0;
  std::uint64_t missed = 0;
  bare_threads(count, duration, cpu, missed);
  row(std::to_string(count) + " bare threads at 100 Hz: missed cycles", static_cast<double>(missed), "");
  row(std::to_string(count) + " bare threads at 100 Hz: processors used", cpu, "");
  crowd(count, duration, nullptr, "a context each", cpu);
  crowd(count, duration, "PeriodicExecutionContext(together)", "one context", 0);
  return 0;
}
