// Searches for faults, events, starts and parameters that violate a plan. Cases are random, or changes of cases that reached something new.
// A seed always gives the same cases, for any number of parallel runs. Called from one thread.
#pragma once

#include <omniORB4/CORBA.h>

#include <chrono>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "campaign/hunt/hunt_case.h"
#include "campaign/run/row_run.h"

namespace campaign {

struct HuntOptions {
  std::chrono::seconds budget{600};
  std::size_t max_cases = 0;     // 0: as many as the budget allows
  std::size_t max_failures = 0;  // 0: any number
  int jobs = 1;
  std::string folder;         // for failures
  bool writes_pages = false;  // find-N.html beside find-N.yaml
  std::chrono::milliseconds call_limit{1000};
};

struct FoundFailure {
  std::string problem;
  HuntCase tried;  // shrunk
  std::size_t case_number = 0;
  double after_s = 0;         // real time until it was found
  std::string state_hash;     // empty: it does not run to its end
  std::string file;           // the plan that repeats it
  bool was_repeated = false;  // no interrupt came before
  bool is_repeatable = false;
};

struct HuntResult {
  std::vector<FoundFailure> failures;
  std::size_t cases = 0, corpus = 0, features = 0;
  double wall_s = 0;
  bool is_interrupted = false;
};

struct HuntProgress {
  std::size_t cases = 0, failures = 0, features = 0;
  double wall_s = 0;
  const FoundFailure* failure = nullptr;  // just now
  // Of a failure that is being shrunk; empty: none is.
  std::string problem{};
  std::size_t case_number = 0, actions = 0, tries = 0;  // actions of the simplest case so far
};

// `show` is called after every case; `reporter` receives what the runs report.
Result<HuntResult> hunt(CORBA::ORB_ptr orb, const Campaign& campaign, const HuntOptions& options,
                        const std::function<void(const HuntProgress&)>& show, tools::Reporter& reporter);

// What kind of problem it is: without numbers, so that the same one at another time is not a new one.
std::string signature(const Outcome& outcome);

}  // namespace campaign
