#include "run/sweep.h"

#include <filesystem>

#include "base/text.h"
#include "remote.h"
#include "run/interrupt.h"
#include "run/tally.h"
#include "run/warm_program.h"

namespace campaign {
namespace fs = std::filesystem;
namespace {

void work(CORBA::ORB_ptr orb, const Campaign& campaign, const SweepOptions& options, const editor::WarmProgram* warm, Tally& tally,
          const Tally::Todo& todo) {
  if (editor::is_interrupted() || tally.is_stopped()) return;
  const auto row = campaign.row(todo.number);
  if (!row) return;  // list_rows() has made it already
  const auto key = campaign.key(*row);
  const auto folder = options.kept + "/" + folder_name(todo.number, key) + (todo.is_audit ? "-audit" : "");
  std::error_code ignored;
  fs::remove_all(folder, ignored);  // of a call that was killed
  const auto outcome =
      run_row(orb, campaign, *row, {.folder = folder, .keeps_files = false, .records = options.records, .warm_simulator = warm});
  if (editor::is_interrupted() && !outcome.problem.empty()) {
    fs::remove_all(folder, ignored);
    return;
  }
  tally.take(todo, key, outcome, outcome.is_passed() ? "" : folder);
}

}  // namespace

std::string folder_name(std::size_t number, const std::string& key) { return "row-" + std::to_string(number) + "-" + key.substr(0, 8); }

Result<void> make_kept(const SweepOptions& options) {
  std::error_code error;
  fs::create_directories(options.kept, error);
  if (error) return Error{"folder " + base::in_quotes(options.kept) + ": " + error.message()};
  constexpr std::uintmax_t least_space = 32U << 20U;
  if (const auto space = fs::space(options.kept, error); !error && space.available < least_space)
    return Error{"folder " + base::in_quotes(options.kept) + ": the disk has less than 32 MiB left"};
  return {};
}

Result<SweepResult> sweep(CORBA::ORB_ptr orb, const Campaign& campaign, const SweepOptions& options,
                          const std::function<void(const Progress&)>& show) {
  if (const auto made = make_kept(options); !made) return made.error();
  auto store = Store::open(options.results);
  if (!store) return store.error();
  Tally tally(campaign, options, std::move(*store), show);
  if (const auto listed = tally.list_rows(); !listed) return listed.error();
  const auto& todo = tally.todo();
  const auto warm = todo.size() > 1 ? editor::WarmProgram::start_simulator() : std::nullopt;
  editor::in_parallel(
      todo.size(), options.call_limit, [&](std::size_t i) { work(orb, campaign, options, warm ? &*warm : nullptr, tally, todo[i]); },
      static_cast<std::size_t>(options.jobs));
  std::error_code ignored;
  fs::remove(options.kept, ignored);  // when it is empty
  return tally.result();
}

}  // namespace campaign
