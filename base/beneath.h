// Opens files that an untrusted file names, without leaving a folder. Any thread.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include "base/result.h"

namespace base {

// The bytes of a regular file below `folder`. No part of `relative` may be a symbolic link, "..", or absolute, whoever changes the folder
// meanwhile; the file is neither device nor pipe, and has at most `most` bytes. Never blocks on what it opens.
// The errors name the file: not found, not below the folder, not a regular file, or larger than `most`.
Result<std::string> read_beneath(const std::filesystem::path& folder, const std::filesystem::path& relative, std::size_t most);

// Fails, naming `file`, unless it is a regular file. A symbolic link may lead to it when `follows` is true; it need not exist when
// `may_be_absent` is true.
struct RegularFile {
  bool follows = true;
  bool may_be_absent = false;
};
Result<void> check_regular_file(const std::filesystem::path& file, const RegularFile& wanted = {});

}  // namespace base
