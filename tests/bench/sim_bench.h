// The parts of sim_bench: the costs of the simulator, each number beside its limit. Each part prints its rows. One thread at a time.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <string>
#include <vector>

namespace sim::bench {

void bench_rays();
void bench_steps();
void bench_robots();
void bench_vehicles();
void bench_load();
void bench_calls();

using Clock = std::chrono::steady_clock;

inline double us_since(Clock::time_point start) { return std::chrono::duration<double, std::micro>(Clock::now() - start).count(); }
inline double least(const std::vector<double>& values) { return *std::min_element(values.begin(), values.end()); }

enum class Goal { at_least, at_most };

void print(const std::string& what, double value, const char* unit, Goal goal, double limit);

template <class... Values>
std::string text(const char* format, Values... values) {
  char line[200];
  std::snprintf(line, sizeof line, format, values...);
  return line;
}

}  // namespace sim::bench
