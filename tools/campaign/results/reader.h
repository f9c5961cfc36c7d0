// Reads a results file for a report. Values; any thread.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "campaign/results/database.h"
#include "campaign/results/statistics.h"
#include "campaign/results/store.h"

namespace campaign {

struct ResultRow {
  std::size_t number = 0;
  std::string key;
  std::uint64_t seed = 0;
  std::map<std::string, std::string> values;
  std::optional<StoredRun> run;  // nothing: not run yet
  std::map<std::string, double> measures;
};

struct UnmetExpectation {
  std::string expectation;
  std::size_t rows = 0;
};

struct Results {
  std::string file, plan_file, system, world, duration;
  std::vector<ResultRow> rows;          // by number
  std::vector<std::string> parameters;  // "seed" first when it varies
  std::vector<std::string> measures;
  std::vector<UnmetExpectation> unmet;  // the most frequent first
  std::size_t audits = 0, different = 0;

  std::size_t run_count() const;
  std::size_t passed_count() const;
};

// The file may come from others (see Database). Fails when it holds more than a campaign can: 30 million values, 1 GiB of text, 1000
// parameters or measures.
Result<Results> read_results(const std::string& file, const ReadLimits& limits = {});

// Of a row: its seed as text, or the value of a parameter.
std::string value_of(const ResultRow& row, const std::string& parameter);

struct Group {
  std::string name;
  std::vector<const ResultRow*> rows;  // that have run
  PassRate rate;
  std::size_t passed = 0;
};
// By the values of a parameter; of numbers with many values by eight ranges.
std::vector<Group> groups(const Results& results, const std::string& parameter);

}  // namespace campaign
