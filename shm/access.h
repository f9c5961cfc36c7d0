// Access rights of the segments of a simulator. A value; any thread.
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>

#include "base/result.h"

namespace shm {

struct Access {
  mode_t mode = 0600;
  std::optional<gid_t> group;
};

// Parses "0660" and a group's name or number, for --shm-mode and --shm-group.
base::Result<Access> parse_access(const std::string& mode, const std::string& group);

}  // namespace shm
