// A plan that was read and checked with everything that it refers to: files exist and paths name parameters. So
// errors of a plan are reported before the first run. Constant after prepare(); any thread.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/content_hash.h"
#include "campaign/plan/plan.h"
#include "campaign/rows/rows.h"
#include "campaign/rows/world_file.h"
#include "system/profile/rts_profile.h"

namespace campaign {

// Whether a program is there: beside ours, else in PATH.
bool can_be_started(const std::string& name);
// Those that every row needs.
Result<void> check_programs();

class Campaign {
 public:
  static Result<Campaign> prepare(Plan plan);
  Campaign(Campaign&&) noexcept = default;

  const Plan& plan() const { return *plan_; }
  const tools::SavedSystem& system() const { return system_; }
  std::size_t rows() const { return rows_->count(); }
  Result<Row> row(std::size_t number) const { return rows_->row(number); }
  // Rows with the same key give the same result: it stands for the programs, modules, world, system and plan as far as they matter, and for
  // the values and the seed.
  std::string key(const Row& row) const;
  // What it is of a row without seed and values.
  const std::string& base_key() const { return base_key_; }
  // A line "NAME<tab>HASH" for each of these: so that who compares two of them can say what has changed.
  const std::string& parts() const { return parts_; }
  // Stands for all rows together, with their values and seeds.
  std::string list_key() const;

  // The world of a row; nothing when it is the plan's own.
  Result<std::optional<WorldFile>> world_of(const Row& row) const;
  // "robot=r0..r9", those of the plan and of the row.
  std::vector<std::string> lists_of(const Row& row) const;
  // Sets the row's values in the system.
  Result<void> alter(tools::SavedSystem& system, const Row& row) const;
  // "INSTANCE:KEY=VALUE", those of the plan and of the row.
  std::vector<std::string> properties_of(const Row& row) const;
  const std::map<std::string, SurveyedModel>& models() const { return survey_.models; }

 private:
  explicit Campaign(Plan plan) : plan_(std::make_unique<const Plan>(std::move(plan))) {}
  Result<void> check_files() const;
  Result<tools::SavedSystem> read_system() const;
  Result<void> survey_world(const std::vector<std::string>& spawned);
  Result<void> check_axes() const;
  Result<void> hash_everything();
  void hash_questions(base::ContentHash& hash) const;

  std::unique_ptr<const Plan> plan_;
  tools::SavedSystem system_;
  WorldSurvey survey_;
  std::unique_ptr<RowMaker> rows_;
  std::string base_key_, parts_;
};

// Names of what is not the same in two texts of parts(), in order.
std::vector<std::string> changed_parts(const std::string& before, const std::string& now);

}  // namespace campaign
