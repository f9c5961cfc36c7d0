// Requests to a simulation with errors in one line, for programs that control one: simctl and rtse. What needs more than the request itself
// (files, poses from numbers) is here once. One thread at a time for each Requester.
#pragma once

#include <chrono>
#include <span>
#include <string>

#include "base/result.h"
#include "shm/request_board.h"
#include "shm/requests.h"

namespace shm {

inline constexpr std::chrono::seconds usual_timeout{10};
inline constexpr std::chrono::minutes picture_timeout{10};  // large images take minutes; a simulator that exits is noticed at once

// The reply to a request that succeeded. A rejection is an Error: "spawn: no model found in ...".
base::Result<Reply> ask_for(Requester& requester, const Request& request, std::chrono::nanoseconds timeout = usual_timeout);
// The same of a reply that is there.
base::Result<Reply> without_refusal(const Request& request, Reply reply);

// X Y YAW, X Y Z YAW, or X Y Z ROLL PITCH YAW [m, rad]. An Error for another count.
base::Result<Pose> pose_of(std::span<const double> numbers);
// A request that moves a model there. Three numbers keep its height and tilt.
base::Result<SetPoseRequest> set_pose_request(const std::string& model, std::span<const double> numbers);

// `what`: SDF file, model folder, model://NAME, or SDF text. A relative path is one of this process. `is_shared`: the simulator serves
// other users, who get no files of its account; it receives the text of a file. An Error names a file that does not exist or cannot be
// read.
base::Result<SpawnRequest> spawn_request(const std::string& what, bool is_shared);

// What is wrong with the name of a PNG file; empty: nothing.
std::string picture_name_problem(const std::string& file);
// Writes an image of the world; `view.path` does not matter. A simulator that serves other users writes no files, so this process does.
base::Result<void> write_screenshot(Requester& requester, ScreenshotRequest view, const std::string& file,
                                    std::chrono::nanoseconds timeout = picture_timeout);

}  // namespace shm
