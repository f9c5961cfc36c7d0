#include "campaign/hunt/hunt.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>

#include "base/interrupt.h"
#include "base/text.h"
#include "campaign/results/disk_room.h"
#include "campaign/run/iface_faults.h"
#include "campaign/run/sweep.h"
#include "run/prefork_server.h"
#include "system/remote.h"

namespace campaign {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr const char* verdict_mark = "; ";  // after each expectation of a signature
constexpr std::size_t generation = 8;       // cases that are tried before what they reached counts

Result<void> room_for(const HuntOptions& options, std::uintmax_t least) { return check_room({options.folder, temporary_folder()}, least); }

class Hunt {
 public:
  Hunt(CORBA::ORB_ptr orb, const Campaign& campaign, const std::vector<HuntTarget>& targets, const HuntOptions& options,
       const std::function<void(const HuntProgress&)>& show, tools::Reporter& reporter)
      : orb_(orb),
        campaign_(campaign),
        options_(options),
        show_(show),
        reporter_(reporter),
        maker_(campaign, targets),
        random_(campaign.plan().hunt.seed, "hunt") {}

  // The error: the system of the plan does not start.
  Result<HuntResult> go() {
    while (goes_on()) {
      std::vector<HuntCase> cases;
      for (std::size_t i = 0; i < generation; ++i) cases.push_back(next_case());
      std::vector<Outcome> outcomes(cases.size());
      tools::in_parallel(
          cases.size(), options_.call_limit,
          [&](std::size_t i) {
            if (!base::is_interrupted()) outcomes[i] = run(cases[i], "case-" + std::to_string(i));
          },
          static_cast<std::size_t>(options_.jobs));
      if (base::is_interrupted()) break;
      for (std::size_t i = 0; i < cases.size() && goes_on(); ++i) take(cases[i], outcomes[i]);
    }
    if (!problem_.empty()) return Error{problem_};
    result_.is_interrupted = base::is_interrupted();
    result_.corpus = corpus_.size();
    result_.features = features_.size();
    result_.wall_s = wall();
    return result_;
  }

 private:
  double wall() const { return std::chrono::duration<double>(Clock::now() - began_).count(); }
  bool goes_on() const {
    if (base::is_interrupted() || !problem_.empty() || Clock::now() - began_ > options_.budget) return false;
    if (options_.max_failures > 0 && result_.failures.size() >= options_.max_failures) return false;
    return options_.max_cases == 0 || result_.cases < options_.max_cases;
  }

  HuntCase next_case() {
    const bool is_fresh = corpus_.empty() || random_.below(2) == 0;
    return is_fresh ? maker_.fresh(random_) : maker_.changed(corpus_[random_.below(corpus_.size())], random_);
  }

  // `failure`: the plan of a failure; the run leaves a page beside it, if it fails and pages are wanted.
  Outcome run(const HuntCase& tried, const std::string& name, const std::string& failure = "") const {
    RowRunOptions options;
    options.folder = options_.folder + "/" + name;
    options.actions = actions_of(campaign_, tried);
    options.duration_s = tried.duration_s;
    options.checks_invariants = true;
    options.draws = false;
    options.prefork = &prefork_;
    if (options_.writes_pages && !failure.empty()) {
      options.page = fs::path(failure).replace_extension(".html").string();
      options.command = again(failure, 1);
    }
    auto outcome = run_row(orb_, campaign_, tried.row, options, reporter_);
    std::error_code ignored;
    fs::remove_all(options.folder, ignored);
    return outcome;
  }

  void take(const HuntCase& tried, const Outcome& outcome) {
    ++result_.cases;
    bool is_new = false;
    for (const auto& feature : outcome.features) is_new |= features_.insert(feature).second;
    if (is_new && outcome.run.is_passed()) corpus_.push_back(tried);
    const auto kind = signature(outcome);
    if (!outcome.run.problem.empty() && is_trouble_of_the_machine(outcome)) return;
    if (!outcome.run.is_passed() && signatures_.insert(kind).second) {
      FoundFailure failure;
      failure.case_number = result_.cases;
      failure.after_s = wall();
      broken_ = {outcome.run.first_problem(), outcome.run.state_hash};
      tries_ = 0;
      show_shrinking(tried);
      failure.tried = shrunk(tried, kind);
      if (!write(failure, kind)) return;
      result_.failures.push_back(std::move(failure));
    }
    const bool found = !result_.failures.empty() && result_.failures.back().case_number == result_.cases;
    show_({result_.cases, result_.failures.size(), features_.size(), wall(), found ? &result_.failures.back() : nullptr});
  }

  // It says nothing about the system. When it is there to stay, problem_ says so.
  bool is_trouble_of_the_machine(const Outcome& outcome) {
    if (const auto room = room_for(options_, room_to_go_on); !room) {
      problem_ = room.error().message;
      return true;
    }
    if (outcome.run.has_begun) {
      not_begun_ = 0;
      return false;
    }
    constexpr std::size_t from_the_start = 3, later = 2 * generation;
    ++not_begun_;
    if (not_begun_ >= (not_begun_ == result_.cases ? from_the_start : later))
      problem_ = "plan " + base::in_quotes(campaign_.plan().file) + ": does not start: " + outcome.run.problem;
    return true;
  }

  struct Broken {
    std::string problem, state_hash;
  };

  void show_shrinking(const HuntCase& simplest) const {
    show_({result_.cases, result_.failures.size(), features_.size(), wall(), nullptr, broken_.problem, result_.cases, simplest.actions(),
           tries_});
  }

  // How, if it does.
  std::optional<Broken> still_breaks(const HuntCase& tried, const std::string& kind) {
    if (base::is_interrupted()) return std::nullopt;
    const auto outcome = run(tried, "shrinking");
    return signature(outcome) == kind ? std::optional(Broken{outcome.run.first_problem(), outcome.run.state_hash}) : std::nullopt;
  }

  // Whether it is not simply too short for what is expected: a path that is long enough, a place that is reached.
  bool means_something(const HuntCase& shorter, const std::string& kind) {
    if (shorter.actions() == 0) {
      const bool is_verdict = kind.ends_with(verdict_mark);
      return !is_verdict || kind.starts_with("never: ") || kind.starts_with("no component ends") || kind.starts_with("no NaN");
    }
    auto quiet = shorter;
    quiet.faults.clear();
    quiet.events.clear();
    return !still_breaks(quiet, kind);
  }

  // Fewer actions, then simpler numbers, then a shorter run.
  HuntCase shrunk(HuntCase best, const std::string& kind) {
    const auto try_it = [&](HuntCase simpler) {
      ++tries_;
      show_shrinking(best);
      auto broken = still_breaks(simpler, kind);
      if (!broken) return false;
      broken_ = std::move(*broken);
      best = std::move(simpler);
      return true;
    };
    for (std::size_t i = best.faults.size(); i-- > 0;) {
      auto simpler = best;
      simpler.faults.erase(simpler.faults.begin() + static_cast<long>(i));
      try_it(std::move(simpler));
    }
    for (std::size_t i = best.events.size(); i-- > 0;) {
      auto simpler = best;
      simpler.events.erase(simpler.events.begin() + static_cast<long>(i));
      try_it(std::move(simpler));
    }
    simplify_numbers(best, try_it);
    for (double part : {0.25, 0.5, 0.75}) {
      auto simpler = best;
      simpler.duration_s = std::max(0.5, std::round(best.duration_s * part * 10) / 10);
      if (simpler.duration_s < best.duration_s && means_something(simpler, kind) && try_it(std::move(simpler))) break;
    }
    return best;
  }

  template <class Try>
  void simplify_numbers(HuntCase& best, Try try_it) {
    if (best.row.seed != 1) {
      auto simpler = best;
      simpler.row.seed = 1;
      try_it(std::move(simpler));
    }
    for (std::size_t i = 0; i < best.faults.size(); ++i) {
      const auto change = [&](auto set) {
        auto simpler = best;
        set(simpler.faults[i]);
        if (simpler.faults[i].text() != best.faults[i].text()) try_it(std::move(simpler));
      };
      change([](Fault& fault) { fault.for_s.reset(); });
      change([](Fault& fault) { fault.at_s = 1; });
      change([](Fault& fault) { fault.at_s = std::floor(fault.at_s); });
      change([](Fault& fault) { fault.amount = usual_amount(fault.kind).value_or(0); });
    }
  }

  // The plan that repeats it, and whether it does. False: problem_ says why there is nothing to repeat, or no plan.
  bool write(FoundFailure& failure, const std::string& kind) {
    failure.file = options_.folder + "/find-" + std::to_string(result_.failures.size() + 1) + ".yaml";
    failure.problem = broken_.problem;
    failure.state_hash = broken_.state_hash;
    const auto first = run(failure.tried, "again"), second = run(failure.tried, "again", failure.file);
    if (failure.tried.actions() == 0 && !first.run.problem.empty() && first.run.simulated_s <= 0 && !base::is_interrupted()) {
      problem_ = "plan " + base::in_quotes(campaign_.plan().file) + ": does not start: " + first.run.problem;
      return false;
    }
    failure.was_repeated = !base::is_interrupted();
    if (failure.was_repeated) {
      failure.state_hash = first.run.state_hash;
      if (!first.run.first_problem().empty()) failure.problem = first.run.first_problem();
      failure.is_repeatable = first.run.state_hash == second.run.state_hash && signature(first) == kind && signature(second) == kind;
    }
    // Another line of it would be one of the plan.
    std::ofstream file(failure.file);
    file << "# " << base::printable(failure.problem) << "\n# state " << (failure.state_hash.empty() ? "-" : failure.state_hash) << "\n"
         << plan_text(campaign_, failure.tried);
    file.close();
    if (!file) problem_ = "find " + base::in_quotes(failure.file) + ": cannot be written: " + failure.problem;
    return problem_.empty();
  }

  CORBA::ORB_ptr orb_;
  const Campaign& campaign_;
  const HuntOptions& options_;
  const std::function<void(const HuntProgress&)>& show_;
  tools::Reporter& reporter_;
  CaseMaker maker_;
  base::Random random_;
  std::vector<HuntCase> corpus_;
  std::set<std::string> features_, signatures_;
  Broken broken_;  // the simplest case so far of what is being shrunk
  std::size_t tries_ = 0;
  HuntResult result_;
  std::size_t not_begun_ = 0;  // cases one after the other
  const tools::PreforkServers prefork_{reporter_};
  std::string problem_;  // why nothing can be found
  Clock::time_point began_ = Clock::now();
};

}  // namespace

std::string signature(const Outcome& outcome) {
  const auto without_numbers = [](const std::string& text) {
    std::string words;
    for (const char c : text) {
      if (std::isdigit(static_cast<unsigned char>(c)) == 0) words += c;
    }
    return words;
  };
  if (!outcome.run.problem.empty()) return without_numbers(outcome.run.problem.substr(0, outcome.run.problem.find(" at ")));
  std::string all;
  for (const auto& verdict : outcome.run.verdicts) {
    if (!verdict.problem.empty()) all += verdict.expectation + verdict_mark;
  }
  return all;
}

Result<HuntResult> hunt(CORBA::ORB_ptr orb, const Campaign& campaign, const HuntOptions& options,
                        const std::function<void(const HuntProgress&)>& show, tools::Reporter& reporter) {
  std::error_code error;
  fs::create_directories(options.folder, error);
  if (error) return Error{"folder " + base::in_quotes(options.folder) + ": " + error.message()};
  if (const auto room = room_for(options, room_to_begin); !room) return room.error();
  if (const auto writable = check_writable(temporary_folder()); !writable) return writable.error();
  if (const auto good = check_values(orb, campaign, options.folder + "/values", reporter); !good) {
    fs::remove(options.folder, error);
    return good.error();
  }
  const auto targets = hunt_targets(campaign);
  if (!targets) return targets.error();
  auto result = Hunt(orb, campaign, *targets, options, show, reporter).go();
  fs::remove(options.folder, error);  // when it is empty
  return result;
}

}  // namespace campaign
