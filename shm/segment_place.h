// The place of a segment with a given name: the usual path /dev/shm/<text of its name>, or, when another user has made a file of that name,
// the folder /dev/shm/rtmsim-<uid>.<random letters>/ of the user in the name (a refuge). Any thread and any process; the file system is
// asked each time. One question costs the same however many segments there are, as long as /dev/shm has no folders.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "shm/segment.h"

namespace shm {

inline constexpr char segment_folder[] = "/dev/shm";
inline constexpr std::string_view segment_prefix = "rtmsim-";

// Where the segment of this name is, or would be made.
std::string path_of(const SegmentName& name);
// The same for one of a list: without another look through the folder.
std::string path_of(const SegmentPlace& place);

// Another file of the same owner has the same name in another place: two have made it at the same time, each where the other did not look.
bool is_elsewhere_too(const SegmentName& name, const std::string& path);

// Removes the file, and the refuge it was the last one in.
void remove_name(const SegmentName& name, const std::string& path);

// The refuge of the effective user, made when there is none. Fails when it can't be made.
base::Result<std::string> make_refuge();

}  // namespace shm
