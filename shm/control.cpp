#include "shm/control.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <utility>

#include "base/plain_file.h"
#include "base/text.h"
#include "base/whole_file.h"

namespace shm {

using base::Error;
using base::Result;

Result<Reply> without_refusal(const Request& request, Reply reply) {
  if (reply.status != RequestStatus::ok) return Error{std::string(request_name(request)) + ": " + reply.message};
  return reply;
}

Result<Reply> ask_for(Requester& requester, const Request& request, std::chrono::nanoseconds timeout) {
  auto reply = requester.ask(request, timeout);
  if (!reply) return reply.error();
  return without_refusal(request, std::move(*reply));
}

Result<Pose> pose_of(std::span<const double> v) {
  switch (v.size()) {
    case 3:
      return planar_pose(v[0], v[1], 0, v[2]);
    case 4:
      return planar_pose(v[0], v[1], v[2], v[3]);
    case 6:
      return euler_pose(v[0], v[1], v[2], v[3], v[4], v[5]);
    default:
      return Error{"pose: expected X Y YAW, X Y Z YAW or X Y Z ROLL PITCH YAW, got " + std::to_string(v.size()) + " numbers"};
  }
}

Result<SetPoseRequest> set_pose_request(const std::string& model, std::span<const double> numbers) {
  const auto pose = pose_of(numbers);
  if (!pose) return pose.error();
  return SetPoseRequest{model, *pose, numbers.size() == 3};
}

Result<SpawnRequest> spawn_request(const std::string& what, bool is_shared) {
  SpawnRequest request;
  request.is_path = what.find('<') == std::string::npos;
  request.sdf = what;
  // Paths are ours, not the simulator's; model:// and the like stay as they are.
  if (!request.is_path || what.find("://") != std::string::npos) return request;
  std::error_code error;
  const bool is_there = std::filesystem::exists(what, error);
  if (!is_there && what.find('/') != std::string::npos) return Error{"file " + base::in_quotes(what) + ": " + base::file_problem(what)};
  request.sdf = is_there ? std::filesystem::absolute(what, error).string() : "model://" + what;
  if (is_shared && std::filesystem::is_regular_file(what, error)) {
    std::ifstream in(what, std::ios::binary);
    request.sdf.assign(std::istreambuf_iterator<char>(in), {});
    if (!in) return Error{"file " + base::in_quotes(what) + ": cannot be read"};
    request.is_path = false;
  }
  return request;
}

std::string picture_name_problem(const std::string& file) {
  const std::string ending = base::to_lower(std::filesystem::path(file).extension().string());
  if (ending.empty() || ending == ".png") return "";
  return "pictures are PNG; expected a name that ends in .png, got " + base::in_quotes(file);
}

Result<void> write_screenshot(Requester& requester, ScreenshotRequest view, const std::string& file, std::chrono::nanoseconds timeout) {
  if (const auto problem = picture_name_problem(file); !problem.empty()) return Error{problem};
  const bool is_shared = requester.simulation().segment().is_shared();
  view.path = is_shared ? "" : std::filesystem::absolute(file).string();
  const auto reply = ask_for(requester, view, timeout);
  if (!reply) return reply.error();
  return is_shared ? base::write_whole_file(file, reply->text) : Result<void>();
}

}  // namespace shm
