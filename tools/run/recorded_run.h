// The run of a recording as files that `rtse run` accepts: the system's profile and the world. The object owns their folder and deletes it.
// One thread at a time.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "base/scratch_folder.h"
#include "recording/mcap/mcap.h"
#include "run/run_system.h"

namespace recorder {

class RecordedRun {
 public:
  // What of a run somebody cannot do without.
  enum class Needs { system_and_world, world };
  // Fails when the recording has not what is needed: `rtse run --record` writes both, `rtse record` the world that a simulator runs.
  static base::Result<RecordedRun> unpack(const std::string& recording, Needs needs = Needs::system_and_world);

  const std::string& system() const { return system_; }
  const std::string& world() const { return world_; }
  std::filesystem::path folder() const { return folder_->path(); }  // for files of the caller's own
  // A text of the metadata `run`; empty when it is not there.
  std::string note(const std::string& key) const;
  double end() const { return end_s_; }  // the time of the last sample [s]
  // Those of the run. Processes of others are started by their commands and their run file, which must still be there.
  // An Error names an option that this version does not know.
  base::Result<tools::RunOptions> options() const;
  // What the script of the run did, see RunScript::written(); empty: nothing, or an older version has recorded it.
  const std::string& script() const { return script_; }
  // What was done in the run that options() cannot do again; empty: nothing.
  std::string lost() const;

 private:
  RecordedRun() = default;
  std::optional<base::ScratchFolder> folder_;
  std::string system_, world_, script_;
  std::vector<std::string> resource_paths_;
  mcap::Texts notes_;
  double end_s_ = 0;
};

}  // namespace recorder
