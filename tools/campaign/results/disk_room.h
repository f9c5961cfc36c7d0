// Checks that the disks of a campaign have room. A row that fails on a full disk says nothing about its system. Any thread.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/result.h"

namespace campaign {

inline constexpr std::uintmax_t room_to_begin = 32U << 20U, room_to_go_on = 1U << 20U;  // [bytes]

// The error names the first folder whose disk has less.
base::Result<void> check_room(const std::vector<std::string>& folders, std::uintmax_t least);

// Whether a file can be made in the folder.
base::Result<void> check_writable(const std::string& folder);

// Where the temporary files of runs are.
std::string temporary_folder();

}  // namespace campaign
