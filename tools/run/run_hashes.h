// The hash log of a run: the simulator and every context on simulated time write a part of it, which become one file at the end; nothing of
// it travels over the network, so it changes nothing in the run. One thread at a time.
#pragma once

#include <cstdint>
#include <string>

#include "base/result.h"
#include "run/run_files.h"

namespace tools {

class RunHashes {
 public:
  // `file`: to be written; empty: none. Makes a folder in the workplace, which must live as long.
  RunHashes(const std::string& file, const Workplace& place);

  bool is_wanted() const { return !file_.empty(); }
  const std::string& file() const { return file_; }
  // Where contexts put their parts, and the simulator's part.
  const std::string& folder() const { return folder_; }
  std::string world_part() const { return folder_ + "/world.hashlog"; }
  // Of rtse itself: what components of others send each other.
  std::string links_part() const { return folder_ + "/links.hashlog"; }

  // When everybody who writes has ended. The hash of the whole run.
  base::Result<std::uint64_t> merge() const;

 private:
  const std::string file_;
  std::string folder_;
};

// As it is printed.
std::string hash_text(std::uint64_t hash);

}  // namespace tools
