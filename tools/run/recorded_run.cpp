#include "run/recorded_run.h"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <utility>

#include "base/text.h"
#include "recording/ring.h"

namespace recorder {

namespace fs = std::filesystem;

namespace {

base::Result<fs::path> new_folder() {
  const char* place = std::getenv("TMPDIR");
  std::string name = std::string(place != nullptr && *place != '\0' ? place : "/tmp") + "/rtse-run-XXXXXX";
  if (::mkdtemp(name.data()) == nullptr) return base::Error{"folder " + base::in_quotes(name) + ": cannot be made"};
  return fs::path(name);
}

std::string text_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

RecordedRun::RecordedRun(RecordedRun&& other) noexcept
    : folder_(std::exchange(other.folder_, {})),
      system_(std::move(other.system_)),
      world_(std::move(other.world_)),
      resource_paths_(std::move(other.resource_paths_)),
      notes_(std::move(other.notes_)),
      end_s_(other.end_s_) {}

RecordedRun::~RecordedRun() {
  std::error_code ignored;  // what stays in the temporary folder harms nobody
  if (!folder_.empty()) fs::remove_all(folder_, ignored);
}

base::Result<RecordedRun> RecordedRun::unpack(const std::string& recording, Needs needs) {
  auto reader = open_recording(recording);
  if (!reader) return reader.error();
  RecordedRun run;
  run.end_s_ = std::chrono::duration<double>(reader->statistics().last).count();
  auto metadata = reader->metadata();
  if (!metadata) return metadata.error();
  for (const auto& one : *metadata) {
    if (one.name == "run") run.notes_ = one.texts;
  }
  const auto folder = new_folder();
  if (!folder) return folder.error();
  run.folder_ = *folder;
  for (const auto& [name, place] : {std::pair("system.xml", &run.system_), std::pair("world.sdf", &run.world_)}) {
    const auto attachment = reader->attachment(name);
    if (!attachment) {
      if (needs == Needs::world && place == &run.system_) continue;
      return base::Error{base::in_quotes(recording) + ": has no attachment " + base::in_quotes(name) +
                         ", which makes the run again; rtse run --record writes it"};
    }
    *place = (run.folder_ / name).string();
    std::ofstream(*place, std::ios::binary) << attachment->data;
  }
  // What the world names is found from where its file was.
  const fs::path was = run.note("world_file");
  std::error_code error;
  // The recording says which file that was: one of another length is not read.
  const auto is_as_long = [&] { return fs::is_regular_file(was, error) && fs::file_size(was, error) == fs::file_size(run.world_, error); };
  if (!was.empty() && is_as_long() && text_of(was) == text_of(run.world_)) {
    run.world_ = was.string();
  } else if (!was.empty()) {
    for (const auto& path : {was.parent_path(), was.parent_path() / "models"}) {
      if (fs::is_directory(path, error)) run.resource_paths_.push_back(path.string());
    }
  }
  return run;
}

std::string RecordedRun::note(const std::string& key) const {
  const auto found = notes_.find(key);
  return found == notes_.end() ? "" : found->second;
}

std::string RecordedRun::lost() const {
  return note("script") == "yes" ? "what the plan of a campaign did in the run (faults, events) is not done again" : "";
}

base::Result<editor::RunOptions> RecordedRun::options() const {
  auto notes = notes_;
  if (note("duration").empty())
    notes["duration"] = base::format_number(std::max(end_s_, editor::run_option("duration").low));  // of `rtse record`
  auto options = editor::recorded_run_options(notes);
  if (!options) return options.error();
  options->system = system_;
  options->world = world_;
  options->resource_paths.insert(options->resource_paths.end(), resource_paths_.begin(), resource_paths_.end());
  return options;
}

}  // namespace recorder
