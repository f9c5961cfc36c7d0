// What the simulator costs, each number beside its limit and beside the bare libraries doing the same work in the same run. Prints a table.
//   sim_bench [rays] [steps] [robots] [vehicles] [load] [calls]      all of them when none is named
#include "sim_bench.h"

#include <string_view>
#include <utility>

#include "base/log.h"
#include "support/usage.h"

namespace sim::bench {

void print(const std::string& what, double value, const char* unit, Goal goal, double limit) {
  const bool is_good = goal == Goal::at_least ? value >= limit : value <= limit;
  std::printf("%-84s %9.3f %-6s %s %8.2f  %s\n", what.c_str(), value, unit, goal == Goal::at_least ? ">=" : "<=", limit,
              is_good ? "ok" : "MISSED");
  std::fflush(stdout);
}

}  // namespace sim::bench

int main(int argc, char** argv) {
  ::test::answer_help(
      argc, argv, "sim_bench [rays|steps|robots|vehicles|load|calls]...\nMeasures the simulator beside plain ODE and Embree (all parts).");
  base::set_log_level(base::Level::error);
  const std::pair<const char*, void (*)()> parts[] = {{"rays", sim::bench::bench_rays},     {"steps", sim::bench::bench_steps},
                                                      {"robots", sim::bench::bench_robots}, {"vehicles", sim::bench::bench_vehicles},
                                                      {"load", sim::bench::bench_load},     {"calls", sim::bench::bench_calls}};
  for (const auto& [name, part] : parts) {
    const bool is_wanted =
        argc == 1 || std::any_of(argv + 1, argv + argc, [&, name = name](const char* word) { return std::string_view(word) == name; });
    if (is_wanted) part();
  }
}
