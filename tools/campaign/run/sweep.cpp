#include "campaign/run/sweep.h"

#include <filesystem>

#include "base/interrupt.h"
#include "base/shell_word.h"
#include "base/text.h"
#include "campaign/results/disk_room.h"
#include "campaign/run/row_locks.h"
#include "campaign/run/tally.h"
#include "run/prefork_server.h"
#include "system/remote.h"

namespace campaign {
namespace fs = std::filesystem;
namespace {

using RunRow = std::function<Outcome(const Row& row, const std::string& folder)>;

void run_todo(const Campaign& campaign, const SweepOptions& options, const RunRow& run, Tally& tally, const Tally::Todo& todo) {
  const auto row = campaign.row(todo.number);
  if (!row) return;  // list_rows() has made it already
  const auto key = campaign.key(*row);
  if (tally.was_stored(todo, key)) return;
  const auto folder = options.kept + "/" + folder_name(todo.number, key) + (todo.is_audit ? "-audit" : "");
  std::error_code ignored;
  fs::remove_all(folder, ignored);  // of a call that was killed
  const auto outcome = run(*row, folder);
  const auto room = outcome.run.problem.empty() ? Result<void>() : check_room({options.kept, temporary_folder()}, room_to_go_on);
  if (!room) tally.give_up(room.error().message);
  if (!room || (base::is_interrupted() && !outcome.run.problem.empty())) {
    fs::remove_all(folder, ignored);
    return;
  }
  tally.take(todo, key, outcome, outcome.run.is_passed() ? "" : folder);
}

void work(const Campaign& campaign, const SweepOptions& options, const RunRow& run, Tally& tally, const RowLocks& locks,
          const Tally::Todo& todo) {
  if (base::is_interrupted() || tally.is_stopped() || !locks.take(todo.number)) return;
  run_todo(campaign, options, run, tally, todo);
  locks.give_back(todo.number);
}

}  // namespace

std::string again(const std::string& plan, std::size_t row) {
  return base::shell_line(base::command_words({"rtse", "sweep"}, {plan}, {"--row", std::to_string(row)}));
}

RowRunOptions row_options(const Campaign& campaign, const SweepOptions& options, std::size_t row, const std::string& folder,
                          const tools::PreforkServers* prefork) {
  return {.folder = folder,
          .records = options.records,
          .page = options.writes_pages ? folder + "/run.html" : "",
          .command = again(campaign.plan().file, row),
          .prefork = prefork};
}

std::string folder_name(std::size_t number, const std::string& key) { return "row-" + std::to_string(number) + "-" + key.substr(0, 8); }

Result<void> make_kept(const SweepOptions& options) {
  std::error_code error;
  fs::create_directories(options.kept, error);
  if (error) return Error{"folder " + base::in_quotes(options.kept) + ": " + error.message()};
  return check_room({options.kept, fs::path(options.results).parent_path().string()}, room_to_begin);
}

Result<SweepResult> sweep(CORBA::ORB_ptr orb, const Campaign& campaign, const SweepOptions& options,
                          const std::function<void(const Progress&)>& show, tools::Reporter& reporter) {
  if (const auto made = make_kept(options); !made) return made.error();
  if (const auto room = check_room({temporary_folder()}, room_to_begin); !room) return room.error();
  if (const auto writable = check_writable(temporary_folder()); !writable) return writable.error();
  // Once a list of rows is there, the call that made it has asked.
  const bool was_asked = Store::has_list(options.results, campaign.list_key());
  if (const auto good = was_asked ? Result<void>() : check_values(orb, campaign, options.kept + "/values", reporter); !good) {
    std::error_code ignored;
    fs::remove(options.kept, ignored);
    return good.error();
  }
  auto store = Store::open(options.results);
  if (!store) return store.error();
  Tally tally(campaign, options, std::move(*store), show);
  if (const auto listed = tally.list_rows(); !listed) return listed.error();
  const auto& todo = tally.todo();
  const auto prefork = todo.size() > 1 ? std::make_optional<tools::PreforkServers>(reporter) : std::nullopt;
  const auto run = [&](const Row& row, const std::string& folder) {
    return run_row(orb, campaign, row, row_options(campaign, options, row.number, folder, prefork ? &*prefork : nullptr), reporter);
  };
  {
    const RowLocks locks(options.kept);
    tools::in_parallel(
        todo.size(), options.call_limit, [&](std::size_t i) { work(campaign, options, run, tally, locks, todo[i]); },
        static_cast<std::size_t>(options.jobs));
  }
  std::error_code ignored;
  fs::remove(options.kept, ignored);  // when it is empty
  return tally.result();
}

}  // namespace campaign
