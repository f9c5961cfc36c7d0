// A plan of a campaign: system, world, variation, measures, events and faults. docs/campaign-plan.md has the format. Values; any
// thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "campaign/plan/actions.h"
#include "run/run_options.h"
#include "run/yaml_shape.h"

namespace campaign {

using base::Error;
using base::Result;

struct Range {
  enum class Kind { uniform, normal, log };
  Kind kind = Kind::uniform;
  double a = 0, b = 1;
};

// A parameter and what it takes: values of a grid, or a range that samples are drawn from.
struct Axis {
  std::string path;
  std::vector<std::string> values;
  std::optional<Range> range;
};

struct Scatter {
  std::vector<std::string> models;
  tools::Region region;
  double clearance = 0.05;  // [m]
  bool turns = true;
};

struct Measure {
  enum class Kind { path_length, time_to, clearance, contacts, value, joint, holds, wall_time };
  enum class Take { min, max, mean, last, count };
  Kind kind = Kind::wall_time;
  std::string name;  // in the results
  std::string text;  // in one line
  std::string model;
  recorder::Expression reached;  // of time_to
  std::vector<std::string> to;
  std::string port, member;
  std::string joint, gripper;
  Take take = Take::last;
};

// What a hunt may break: the object, and how; none given: all ways that fit.
struct HuntTarget {
  Fault::Object object = Fault::Object::component;
  std::string name;
  std::vector<Fault::Kind> kinds;
};

struct HuntSpace {
  std::vector<HuntTarget> targets;  // empty: all that the system allows
  std::vector<Event> events;
  std::size_t most = 3;
  std::uint64_t seed = 1;
};

struct Plan {
  enum class Sampling { random, latin, sobol };
  std::string file;
  std::string text;
  tools::RunOptions run;    // of each row; its seed is that of the row
  std::string expect_text;  // YAML, when the expectations stand in the plan itself
  std::uint64_t seed = 1;
  std::size_t repeat = 1;
  std::vector<Axis> axes;
  std::vector<Scatter> scatters;
  std::size_t samples = 10;
  Sampling sampling = Sampling::random;
  std::uint64_t sampling_seed = 1;
  std::vector<Measure> measures;
  std::vector<Event> events;
  std::vector<Fault> faults;
  std::vector<Condition> never, eventually;
  HuntSpace hunt;
  bool has_pictures = true;
  bool checks_invariants = false;  // no port sends a NaN

  std::string folder() const;
};

// Errors are one line: plan "FILE":LINE:COLUMN: what is wrong.
Result<Plan> read_plan(const std::string& file);

inline constexpr std::uint64_t max_rows = 1'000'000;

}  // namespace campaign
