// A task of a sweep by Slurm.
#include <fcntl.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <string_view>

#include "base/guarded.h"
#include "base/interrupt.h"
#include "base/scratch_folder.h"
#include "base/text.h"
#include "campaign/results/disk_room.h"
#include "campaign/slurm/slurm_sweep.h"
#include "campaign/slurm/task_folder.h"
#include "run/prefork_server.h"
#include "run/run_files.h"
#include "system/remote.h"

namespace campaign {
namespace fs = std::filesystem;
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

// The file that the caller of the sweep reads. Any thread.
class Part {
 public:
  explicit Part(std::string file) : file_(std::move(file)), handle_(open(file_.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC)) {}
  ~Part() {
    if (handle_ >= 0) close(handle_);
  }
  Part(const Part&) = delete;
  Part& operator=(const Part&) = delete;

  // Others see it after a few seconds, or when the file is closed: a file server is not asked for every row.
  void add(const std::string& line) {
    const auto mine = turn_.take();
    for (std::string_view left = line; !left.empty() && problem_.empty();) {
      const auto count = write(handle_, left.data(), left.size());
      if (count > 0) left.remove_prefix(static_cast<std::size_t>(count));
      if (count <= 0) problem_ = "file " + base::in_quotes(file_) + ": cannot be written";
    }
    constexpr auto sync_period = 5s;
    if (Clock::now() - synced_ < sync_period) return;
    if (fdatasync(handle_) != 0 && problem_.empty()) problem_ = "file " + base::in_quotes(file_) + ": cannot be written";
    synced_ = Clock::now();
  }
  void give_up(const std::string& problem) {
    const auto mine = turn_.take();
    if (problem_.empty()) problem_ = problem;
  }
  std::string problem() {
    const auto mine = turn_.take();
    return problem_;
  }

 private:
  std::string file_;
  int handle_;
  base::Turn<> turn_;
  std::string problem_;
  Clock::time_point synced_ = Clock::now();
};

Result<void> keep(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::remove_all(to, error);  // of a task that was killed
  fs::create_directories(to.parent_path(), error);
  fs::copy(from, to, fs::copy_options::recursive | fs::copy_options::copy_symlinks, error);
  if (error) return Error{"folder " + base::in_quotes(to.string()) + ": " + error.message()};
  return {};
}

}  // namespace

std::optional<TaskPlace> parse_task(const std::string& text) {
  const auto second = text.rfind(':');
  const auto first = second == std::string::npos || second == 0 ? second : text.rfind(':', second - 1);
  if (first == std::string::npos || first == 0 || first == second) return std::nullopt;
  const auto attempt = base::parse_integer(text.substr(first + 1, second - first - 1));
  const auto task = base::parse_integer(text.substr(second + 1));
  if (!attempt || !task || *attempt < 1 || *attempt > 1'000'000 || *task < 0 || *task > 1'000'000) return std::nullopt;
  return TaskPlace{text.substr(0, first), static_cast<int>(*attempt), static_cast<std::size_t>(*task)};
}

Result<void> run_task(CORBA::ORB_ptr orb, const Campaign& campaign, const SweepOptions& options, const TaskPlace& place,
                      tools::Reporter& reporter) {
  const TaskFolder shared(place.folder);
  if (const auto same = shared.check_key(campaign.base_key()); !same) return same;
  const auto rows = shared.rows_of(place.attempt, place.task);
  if (!rows) return rows.error();
  Part part(shared.part(place.attempt, place.task));
  // Rows run on a disk of this machine; only what a row leaves behind goes to the shared one.
  const auto scratch = base::ScratchFolder::make(tools::scratch_prefix);
  if (!scratch) return scratch.error();
  const auto prefork = rows->size() > 1 ? std::make_optional<tools::PreforkServers>(reporter) : std::nullopt;
  const auto work = [&](std::size_t number) {
    if (base::is_interrupted() || !part.problem().empty()) return;
    const auto row = campaign.row(number);
    if (!row) return;  // the caller has made it
    const auto key = campaign.key(*row);
    const auto name = folder_name(number, key);
    const auto folder = fs::path(scratch->path()) / name;
    auto outcome =
        run_row(orb, campaign, *row, row_options(campaign, options, number, folder.string(), prefork ? &*prefork : nullptr), reporter);
    if (base::is_interrupted() && !outcome.run.problem.empty()) return;
    const auto room = outcome.run.problem.empty() ? Result<void>() : check_room({options.kept, temporary_folder()}, room_to_go_on);
    if (!room) return part.give_up(room.error().message);
    if (!outcome.run.has_begun && !outcome.run.problem.empty()) return part.give_up(outcome.run.problem);  // another machine may let it
    std::string kept;
    if (!outcome.run.is_passed()) {
      kept = options.kept + "/" + name;
      if (const auto copied = keep(folder, kept); !copied) outcome.run.logs += "\n" + copied.error().message;
    }
    std::error_code ignored;
    fs::remove_all(folder, ignored);
    part.add(to_line({key, std::move(outcome), kept}));
  };
  tools::in_parallel(
      rows->size(), options.call_limit, [&](std::size_t i) { work((*rows)[i]); }, static_cast<std::size_t>(options.jobs));
  if (const auto problem = part.problem(); !problem.empty()) return Error{problem};
  if (base::is_interrupted()) return Error{"interrupted"};
  return {};
}

}  // namespace campaign
