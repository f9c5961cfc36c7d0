// Reading a file of untrusted data whole. Any thread.
//
// Only a regular file is read, and only as many bytes as it says that it has: a pipe, a device or a socket is an error before anything is
// read from it, and a pseudo-file (/proc/kmsg) is empty. Opening never waits for a writer.
#pragma once

#include <sys/stat.h>

#include <cstdint>
#include <filesystem>
#include <string>

#include "base/result.h"

namespace base {

// Errors are "no such file", "is not a regular file", "a file of at most N MiB is expected", "cannot be read: REASON": without the name,
// which the caller puts in front. `status` (may be null) receives what the bytes belong to.
Result<std::string> read_plain_file(const std::filesystem::path& file, std::uintmax_t max_bytes, struct stat* status = nullptr);

// Why a file that a person has named cannot be read, in the words of read_plain_file(), with the name in the same folder that was most
// likely meant; empty when nothing speaks against it.
std::string file_problem(const std::filesystem::path& file);

// Whether read_plain_file() would try.
bool is_plain_file(const std::filesystem::path& file);

}  // namespace base
