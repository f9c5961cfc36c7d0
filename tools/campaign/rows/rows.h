// The rows of a plan: each has a seed and the values of the varied parameters. A row is computed from its number, so a million rows need no
// memory. One thread at a time.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "campaign/plan/plan.h"
#include "campaign/rows/world_file.h"

namespace campaign {

struct Row {
  std::size_t number = 0;  // from 1
  std::uint64_t seed = 1;
  std::vector<std::pair<std::string, std::string>> values;  // by path, in the order of the plan; then what was scattered
};

// The models of the world where a row puts them.
std::map<std::string, SurveyedModel> placed_models(const Row& row, std::map<std::string, SurveyedModel> models);

class RowMaker {
 public:
  // `models`: of the world. `plan` must live as long. Fails when there are more than a million rows.
  static Result<RowMaker> make(const Plan& plan, const std::map<std::string, SurveyedModel>& models);

  std::size_t count() const { return count_; }
  // number from 1 to count(). Fails when a scattered model finds no place.
  Result<Row> row(std::size_t number) const;

 private:
  explicit RowMaker(const Plan& plan) : plan_(&plan) {}
  Result<void> scatter(Row& row, std::size_t sample) const;

  const Plan* plan_;
  std::size_t count_ = 0, samples_ = 1;
  std::vector<std::vector<double>> points_;
  std::map<std::string, SurveyedModel> models_;  // when something is scattered
};

}  // namespace campaign
