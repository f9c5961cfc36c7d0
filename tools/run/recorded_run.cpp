#include "run/recorded_run.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <utility>

#include "base/text.h"
#include "recording/ring.h"
#include "run/run_files.h"

namespace recorder {

namespace fs = std::filesystem;

namespace {

std::string text_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

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
  auto folder = base::ScratchFolder::make(tools::scratch_prefix);
  if (!folder) return folder.error();
  run.folder_.emplace(std::move(*folder));
  for (const auto& [name, place] : {std::pair("system.xml", &run.system_), std::pair("world.sdf", &run.world_)}) {
    const auto attachment = reader->attachment(name);
    if (!attachment) {
      if (needs == Needs::world && place == &run.system_) continue;
      return base::Error{base::in_quotes(recording) + ": has no attachment " + base::in_quotes(name) +
                         ", which makes the run again; rtse run --record writes it"};
    }
    *place = (run.folder() / name).string();
    std::ofstream(*place, std::ios::binary) << attachment->data;
  }
  if (const auto script = reader->attachment("script.yaml")) run.script_ = script->data;
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
  return note("script") == "yes" ? "events of the campaign's plan and its faults of devices and processes are not repeated" : "";
}

base::Result<tools::RunOptions> RecordedRun::options() const {
  auto notes = notes_;
  if (note("duration").empty())
    notes["duration"] = base::format_number(std::max(end_s_, tools::run_option("duration").low));  // of `rtse record`
  auto options = tools::recorded_run_options(notes);
  if (!options) return options.error();
  options->system = system_;
  options->world = world_;
  options->resource_paths.insert(options->resource_paths.end(), resource_paths_.begin(), resource_paths_.end());
  return options;
}

}  // namespace recorder
