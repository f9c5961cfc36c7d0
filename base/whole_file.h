// Writes a file atomically: its name refers to the complete new file or to the old one. Any thread.
#pragma once

#include <filesystem>
#include <string_view>

#include "base/result.h"

namespace base {

// A file that is replaced keeps its mode. A symbolic link stays one; what is there and no ordinary file (a folder, a device, a pipe) is
// rejected. On failure nothing is left behind.
Result<void> write_whole_file(const std::filesystem::path& file, std::string_view octets);

// Whether a file of that name could be written now. Said before long work, since it would be a pity afterwards. Folders are not made: an
// Error, with the name, tells of one that is missing.
Result<void> check_writable_file(const std::filesystem::path& file);

// Where a file is to be put by rename(), behind symbolic links. An Error, without the name, for what must not be
// replaced: a folder, a device, a pipe.
Result<std::filesystem::path> replaceable_file(const std::filesystem::path& file);

}  // namespace base
