// Requests to a simulation as types, with encoding and decoding. Values; no thread rule.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>

#include "base/result.h"
#include "shm/layout.h"

namespace shm {

struct PauseRequest {};
struct RunRequest {};
struct StepRequest {
  std::int64_t steps = 1;
  bool is_paced = false;  // at the real-time factor, instead of as fast as possible
  // The steps end with the tick in which the process of a participant dies. The reply has failed then: `count` is the process ID, `text`
  // the names of its participants that had not finished their tick, one a line, `values` the time of the tick and the longest period
  // of these [s].
  bool ends_at_death = false;
};
struct ResetRequest {
  bool poses_only = false;
  std::optional<std::uint64_t> seed{};  // of all sensor noise from then on; nothing: as before. Not with poses_only
};
struct GetPoseRequest {
  std::string name;
};
struct SetPoseRequest {
  std::string model;
  Pose pose = identity_pose;  // the quaternion is normalised by decode
  bool is_planar = false;     // only x, y and the yaw of pose count
};
struct GetVelocityRequest {
  std::string name;
};
struct SetVelocityRequest {
  std::string model;
  double linear[3] = {}, angular[3] = {};
};
struct WrenchRequest {
  std::string name;
  double force[3] = {}, torque[3] = {};
  double duration = 0;  // [s], 0 = one step; until_the_next
  // The wrench stays, in place of all others of the link or joint that stay; one of zeros ends them.
  static constexpr double until_the_next = -1;
  bool is_joint = false;  // name = MODEL::JOINT; force[0] is its effort [N m or N] beside those of its motor, the others are 0
};
struct ListRequest {};
struct TreeRequest {
  std::string model;         // empty = all
  bool with_bounds = false;  // of models, too: a look at each corner of their meshes
};
struct SpawnRequest {
  std::string sdf;       // text, or path when is_path
  bool is_path = false;  // a shared server opens only what is in its model path
  std::string name;      // empty = as in the file
  bool has_pose = false;
  Pose pose = identity_pose;
  bool is_confined = false;  // nothing outside of the model path is opened: on behalf of somebody who may not read all that the server may
  std::string gains{};       // text of a YAML file of ros_control or ros2_control, before those of the model
  std::string joints{};      // JOINT=POSITION, a line each: where these start [rad or m]
};
struct DeleteRequest {
  std::string model;
};
struct ScreenshotRequest {
  // Absolute; written atomically, with the rights of the server, so rejected by one that is shared with others. Empty: the PNG is the text
  // of the reply.
  std::string path;
  std::uint32_t width = 800, height = 600;  // 1..8192
  enum class View { whole, top, follow, from, camera } view = View::whole;
  bool with_scans = false;       // fans of range finders, trails and names over the picture
  bool with_collisions = false;  // the shapes that collide instead of those that are seen
  bool as_pixels = false;        // the text of the reply is rows of red, green and blue bytes instead of a PNG; not with a path
  std::string follow;            // model; iface for `camera`
  Pose pose = identity_pose;     // camera for `from`, centre for `top`
  double span = 0;               // hfov [rad], or metres across for `top`; 0 = a good one
};
struct StatsRequest {};
struct ResetOdometryRequest {
  std::string iface;
  double x = 0, y = 0, a = 0;
  bool is_3d = false;
  Pose pose = identity_pose;  // for 3d
};
struct SetMotorsRequest {
  std::string iface;  // of a drive, or MODEL::GRIPPER, or MODEL::CHILD_MODEL of a detachable joint: on attaches, off detaches
  bool are_enabled = true;
};
struct SetRtfRequest {
  double rtf = 1;  // 0 = as fast as possible
};
struct ContactsRequest {
  std::string model;
};
struct DropParticipantRequest {
  std::string name;
};
struct ExportRequest {
  bool with_collisions = false;  // the shapes that collide instead of those that are seen
};
struct PosesRequest {};
struct FaultRequest {
  std::string iface, kind;       // of shm/fault_kinds.h
  std::optional<double> amount;  // nothing: the usual one
  double duration = 0;           // [s], simulated; 0 = until it is ended
};
struct EndFaultsRequest {
  std::string iface, kind;  // empty = all
};
struct FaultsRequest {
  std::string iface;  // empty = all
};
struct ModelsRequest {};
// Sensors that somebody is subscribed to publish what is there now, as after a reset or after a model was moved. Rejected while time goes
// on.
struct ShowRequest {};
// New data of a tag that a reader has in its reach, until a reset.
struct WriteTagRequest {
  std::string iface;     // of the reader
  std::string id, data;  // without line breaks; fewer than 64 and 128 bytes
};
// See shm/pose_log.h.
struct PoseLogRequest {
  std::int64_t from = 0;  // [bytes]; the simulator deletes what is before it
  std::string joints{};   // MODEL::JOINT, a line each: from now on the log has their positions, too; empty: as before
};

using Request =
    std::variant<PauseRequest, RunRequest, StepRequest, ResetRequest, GetPoseRequest, SetPoseRequest, GetVelocityRequest,
                 SetVelocityRequest, WrenchRequest, ListRequest, TreeRequest, SpawnRequest, DeleteRequest, ScreenshotRequest, StatsRequest,
                 ResetOdometryRequest, SetMotorsRequest, SetRtfRequest, ContactsRequest, DropParticipantRequest, ExportRequest,
                 PosesRequest, FaultRequest, EndFaultsRequest, FaultsRequest, ModelsRequest, PoseLogRequest, ShowRequest, WriteTagRequest>;

enum class RequestStatus : std::uint32_t {
  ok = RTMSIM_STATUS_OK,
  failed = RTMSIM_STATUS_FAILED,
  bad_request = RTMSIM_STATUS_BAD_REQUEST,
  not_found = RTMSIM_STATUS_NOT_FOUND,
  unsupported = RTMSIM_STATUS_UNSUPPORTED,
};

struct RawRequest {
  std::uint32_t kind = 0;
  RequestBody body{};
  std::string text;
};

struct Reply {
  RequestStatus status = RequestStatus::ok;
  std::string message;  // what went wrong; cut after 255 bytes
  std::string text;     // JSON or octets where the request says so
  std::int64_t sim_time_ns = 0;
  std::uint64_t steps = 0;
  std::uint64_t hash = 0;
  std::int64_t count = 0;
  double values[16] = {};
};

RawRequest encode(const Request& request);
base::Result<Request> decode(const RawRequest& raw);
// "set-pose", "spawn", ...: for messages and logs.
std::string_view request_name(const Request& request);

Pose planar_pose(double x, double y, double z, double yaw);
Pose euler_pose(double x, double y, double z, double roll, double pitch, double yaw);
double yaw_of(const Pose& pose);

}  // namespace shm
