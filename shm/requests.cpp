#include "shm/requests.h"

#include <array>
#include <cmath>
#include <cstring>
#include <optional>

#include "base/text.h"
#include "shm/fault_kinds.h"
#include "shm/segment.h"
#include "shm/writer.h"

namespace shm {
namespace {

constexpr std::uint32_t flag_1 = 1, flag_2 = 2, flag_3 = 4, flag_4 = 8;
constexpr std::int64_t max_steps = 1'000'000'000;
constexpr std::uint32_t max_pixels = 8192;

constexpr std::array<std::string_view, 30> names = {"",           "pause",          "run",
                                                    "step",       "reset",          "get-pose",
                                                    "set-pose",   "get-velocity",   "set-velocity",
                                                    "wrench",     "list",           "tree",
                                                    "spawn",      "delete",         "screenshot",
                                                    "statistics", "reset-odometry", "set-motors",
                                                    "set-rtf",    "contacts",       "drop-participant",
                                                    "export",     "poses",          "fault",
                                                    "end-faults", "faults",         "models",
                                                    "pose-log",   "show",           "write-tag"};
static_assert(std::variant_size_v<Request> == names.size() - 1);

void put_pose(RequestBody& body, const Pose& pose) {
  const double values[] = {pose.x, pose.y, pose.z, pose.qw, pose.qx, pose.qy, pose.qz};
  std::copy(std::begin(values), std::end(values), body.values);
}

struct Encoder {
  RawRequest& raw;
  void name(const std::string& text) { set_text(raw.body.name, text); }

  void operator()(const PauseRequest&) {}
  void operator()(const RunRequest&) {}
  void operator()(const StepRequest& r) {
    raw.body.count = r.steps;
    raw.body.flags = (r.is_paced ? flag_1 : 0) | (r.ends_at_death ? flag_2 : 0);
  }
  void operator()(const ResetRequest& r) {
    raw.body.flags = (r.poses_only ? flag_1 : 0) | (r.seed ? flag_2 : 0);
    raw.body.count = static_cast<std::int64_t>(r.seed.value_or(0));
  }
  void operator()(const GetPoseRequest& r) { name(r.name); }
  void operator()(const SetPoseRequest& r) {
    name(r.model);
    put_pose(raw.body, r.pose);
    if (!r.is_planar) return;
    raw.body.flags = flag_1;
    raw.body.values[2] = yaw_of(r.pose);
  }
  void operator()(const GetVelocityRequest& r) { name(r.name); }
  void operator()(const SetVelocityRequest& r) {
    name(r.model);
    std::copy(r.linear, r.linear + 3, raw.body.values);
    std::copy(r.angular, r.angular + 3, raw.body.values + 3);
  }
  void operator()(const WrenchRequest& r) {
    name(r.name);
    std::copy(r.force, r.force + 3, raw.body.values);
    std::copy(r.torque, r.torque + 3, raw.body.values + 3);
    raw.body.values[6] = r.duration;
    raw.body.flags = r.is_joint ? flag_1 : 0;
  }
  void operator()(const ListRequest&) {}
  void operator()(const TreeRequest& r) {
    name(r.model);
    raw.body.flags = r.with_bounds ? flag_1 : 0;
  }
  void operator()(const SpawnRequest& r) {
    const bool has_more = !r.gains.empty() || !r.joints.empty();
    raw.text = r.sdf;
    if (has_more) raw.text += std::string(1, '\0') + r.gains + std::string(1, '\0') + r.joints;
    name(r.name);
    raw.body.flags = (r.is_path ? flag_1 : 0) | (r.has_pose ? flag_2 : 0) | (r.is_confined ? flag_3 : 0) | (has_more ? flag_4 : 0);
    put_pose(raw.body, r.pose);
  }
  void operator()(const DeleteRequest& r) { name(r.model); }
  void operator()(const ScreenshotRequest& r) {
    raw.text = r.path;
    name(r.follow);
    raw.body.width = r.width;
    raw.body.height = r.height;
    put_pose(raw.body, r.pose);
    raw.body.values[7] = r.span;
    using View = ScreenshotRequest::View;
    raw.body.flags = (r.view == View::top ? RTMSIM_VIEW_TOP : 0) | (r.view == View::follow ? RTMSIM_VIEW_FOLLOW : 0) |
                     (r.view == View::from ? RTMSIM_VIEW_FROM : 0) | (r.with_scans ? RTMSIM_VIEW_SCANS : 0) |
                     (r.view == View::camera ? RTMSIM_VIEW_CAMERA : 0) | (r.with_collisions ? RTMSIM_VIEW_COLLISIONS : 0) |
                     (r.as_pixels ? RTMSIM_VIEW_PIXELS : 0);
  }
  void operator()(const StatsRequest&) {}
  void operator()(const ResetOdometryRequest& r) {
    name(r.iface);
    if (r.is_3d) {
      put_pose(raw.body, r.pose);
      raw.body.flags = flag_1;
    } else {
      const double values[] = {r.x, r.y, r.a};
      std::copy(std::begin(values), std::end(values), raw.body.values);
    }
  }
  void operator()(const SetMotorsRequest& r) {
    name(r.iface);
    raw.body.count = r.are_enabled ? 1 : 0;
  }
  void operator()(const SetRtfRequest& r) { raw.body.values[0] = r.rtf; }
  void operator()(const ContactsRequest& r) { name(r.model); }
  void operator()(const DropParticipantRequest& r) { name(r.name); }
  void operator()(const ExportRequest& r) { raw.body.flags = r.with_collisions ? flag_1 : 0; }
  void operator()(const PosesRequest&) {}
  void operator()(const FaultRequest& r) {
    name(r.iface);
    raw.text = r.kind;
    raw.body.flags = r.amount ? flag_1 : 0;
    raw.body.values[0] = r.amount.value_or(0);
    raw.body.values[1] = r.duration;
  }
  void operator()(const EndFaultsRequest& r) {
    name(r.iface);
    raw.text = r.kind;
  }
  void operator()(const FaultsRequest& r) { name(r.iface); }
  void operator()(const ModelsRequest&) {}
  void operator()(const ShowRequest&) {}
  void operator()(const WriteTagRequest& r) {
    name(r.iface);
    raw.text = r.id + "\n" + r.data;
  }
  void operator()(const PoseLogRequest& r) {
    raw.body.count = r.from;
    raw.text = r.joints;
  }
};

class Decoder {
 public:
  explicit Decoder(const RawRequest& raw) : raw_(raw), kind_(names[raw.kind]) {}

  base::Result<Request> decode();

 private:
  const RequestBody& body() const { return raw_.body; }
  const double* values() const { return raw_.body.values; }
  base::Error fail(const std::string& what) const { return base::Error{"request " + std::string(kind_) + ": " + what}; }

  base::Result<void> check_common();
  std::optional<Pose> pose() const;
  template <class Named>
  base::Result<Request> named(Named request, std::string Named::*field) const {
    if (name_.empty()) return fail("needs a name");
    request.*field = name_;
    return Request(std::move(request));
  }
  base::Result<Request> step() const;
  base::Result<Request> reset() const;
  base::Result<Request> set_pose() const;
  base::Result<Request> twist() const;
  base::Result<Request> spawn() const;
  base::Result<Request> screenshot() const;
  base::Result<Request> reset_odometry() const;
  base::Result<Request> fault() const;
  base::Result<Request> end_faults() const;
  base::Result<Request> write_tag() const;

  const RawRequest& raw_;
  std::string_view kind_;
  std::string name_;
};

base::Result<void> Decoder::check_common() {
  const auto* end = static_cast<const char*>(std::memchr(body().name, 0, sizeof body().name));
  if (end == nullptr) return fail("its name has no end");
  name_.assign(body().name, end);
  for (char c : name_) {
    if (static_cast<unsigned char>(c) < 32 || c == 127) return fail("name " + base::in_quotes(name_) + " holds a control character");
  }
  for (double value : body().values) {
    if (!std::isfinite(value)) return fail("numbers must be finite, got " + base::format_number(value));
    if (std::abs(value) > 1e12) return fail("numbers must be below 1e12, got " + base::format_number(value));
  }
  return {};
}

std::optional<Pose> Decoder::pose() const {
  const double* v = values();
  const double norm = std::sqrt(v[3] * v[3] + v[4] * v[4] + v[5] * v[5] + v[6] * v[6]);
  if (norm < 1e-6) return std::nullopt;
  return Pose{v[0], v[1], v[2], v[3] / norm, v[4] / norm, v[5] / norm, v[6] / norm};
}

base::Result<Request> Decoder::step() const {
  if (body().count < 1 || body().count > max_steps) return fail("steps must be 1 to 1e9, got " + std::to_string(body().count));
  return Request(StepRequest{body().count, (body().flags & flag_1) != 0, (body().flags & flag_2) != 0});
}

base::Result<Request> Decoder::reset() const {
  ResetRequest request{(body().flags & flag_1) != 0};
  if ((body().flags & flag_2) != 0) request.seed = static_cast<std::uint64_t>(body().count);
  if (request.poses_only && request.seed) return fail("a reset of the poses alone keeps the seed");
  return Request(request);
}

base::Result<Request> Decoder::set_pose() const {
  if (name_.empty()) return fail("needs a name");
  if ((body().flags & flag_1) != 0) return Request(SetPoseRequest{name_, planar_pose(values()[0], values()[1], 0, values()[2]), true});
  const auto wanted = pose();
  if (!wanted) return fail("the quaternion of the pose is zero");
  return Request(SetPoseRequest{name_, *wanted, false});
}

base::Result<Request> Decoder::twist() const {
  if (name_.empty()) return fail("needs a name");
  if (raw_.kind == RTMSIM_REQUEST_SET_VELOCITY) {
    SetVelocityRequest request{name_, {}, {}};
    std::copy(values(), values() + 3, request.linear);
    std::copy(values() + 3, values() + 6, request.angular);
    return Request(request);
  }
  WrenchRequest request{name_, {}, {}, values()[6]};
  if (request.duration < 0 && request.duration != WrenchRequest::until_the_next)
    return fail("duration must not be negative (or -1: until the next), got " + base::format_number(request.duration));
  std::copy(values(), values() + 3, request.force);
  std::copy(values() + 3, values() + 6, request.torque);
  request.is_joint = (body().flags & flag_1) != 0;
  if (request.is_joint && std::any_of(values() + 1, values() + 6, [](double value) { return value != 0; }))
    return fail("of a joint takes one number");
  return Request(request);
}

base::Result<Request> Decoder::spawn() const {
  SpawnRequest request{raw_.text,     (body().flags & flag_1) != 0, name_, (body().flags & flag_2) != 0,
                       identity_pose, (body().flags & flag_3) != 0};
  if ((body().flags & flag_4) != 0) {
    const auto first = raw_.text.find('\0'), second = first == std::string::npos ? first : raw_.text.find('\0', first + 1);
    if (second == std::string::npos) return fail("expected a model, gains and joints, with zero bytes between them");
    request.sdf = raw_.text.substr(0, first);
    request.gains = raw_.text.substr(first + 1, second - first - 1);
    request.joints = raw_.text.substr(second + 1);
  }
  if (request.sdf.empty()) return fail("needs an SDF text or a path");
  if (request.has_pose) {
    const auto wanted = pose();
    if (!wanted) return fail("the quaternion of the pose is zero");
    request.pose = *wanted;
  }
  return Request(std::move(request));
}

base::Result<Request> Decoder::screenshot() const {
  using View = ScreenshotRequest::View;
  ScreenshotRequest request;
  request.path = raw_.text;
  if (!request.path.empty() && (request.path[0] != '/' || request.path.find('\0') != std::string::npos)) {
    return fail("path must be absolute, got " + base::in_quotes(request.path));
  }
  request.width = body().width;
  request.height = body().height;
  const auto is_good = [](std::uint32_t size) { return size >= 1 && size <= max_pixels; };
  if (!is_good(request.width) || !is_good(request.height)) {
    return fail("size must be 1x1 to 8192x8192, got " + std::to_string(request.width) + "x" + std::to_string(request.height));
  }
  request.with_scans = (body().flags & RTMSIM_VIEW_SCANS) != 0;
  request.with_collisions = (body().flags & RTMSIM_VIEW_COLLISIONS) != 0;
  request.as_pixels = (body().flags & RTMSIM_VIEW_PIXELS) != 0;
  if (request.as_pixels && !request.path.empty()) return fail("pixels are no file; expected no path, got " + base::in_quotes(request.path));
  request.span = values()[7];
  if (request.span < 0) return fail("field of view or width must not be negative");
  if ((body().flags & RTMSIM_VIEW_TOP) != 0) {
    request.view = View::top;
  } else if ((body().flags & RTMSIM_VIEW_FOLLOW) != 0) {
    request.view = View::follow;
    if (name_.empty()) return fail("needs the name of the model to follow");
  } else if ((body().flags & RTMSIM_VIEW_FROM) != 0) {
    request.view = View::from;
  } else if ((body().flags & RTMSIM_VIEW_CAMERA) != 0) {
    request.view = View::camera;
    if (name_.empty()) return fail("needs the name of the camera");
  }
  request.follow = name_;
  const auto wanted = pose();
  if (!wanted && request.view == View::from) return fail("the quaternion of the pose is zero");
  request.pose = wanted.value_or(identity_pose);
  return Request(std::move(request));
}

base::Result<Request> Decoder::reset_odometry() const {
  if (name_.empty()) return fail("needs a name");
  ResetOdometryRequest request;
  request.iface = name_;
  request.is_3d = (body().flags & flag_1) != 0;
  if (!request.is_3d) {
    request.x = values()[0];
    request.y = values()[1];
    request.a = values()[2];
    return Request(std::move(request));
  }
  const auto wanted = pose();
  if (!wanted) return fail("the quaternion of the pose is zero");
  request.pose = *wanted;
  return Request(std::move(request));
}

base::Result<Request> Decoder::fault() const {
  if (name_.empty()) return fail("needs a name");
  FaultRequest request{name_, raw_.text, std::nullopt, values()[1]};
  if ((body().flags & flag_1) != 0) request.amount = values()[0];
  if (const auto row = check_fault(request.kind, request.amount); !row) return row.error();
  if (request.duration < 0) return fail("duration must not be negative, got " + base::format_number(request.duration));
  return Request(std::move(request));
}

base::Result<Request> Decoder::end_faults() const {
  if (!raw_.text.empty()) {
    if (const auto row = check_fault(raw_.text, std::nullopt); !row) return row.error();
  }
  return Request(EndFaultsRequest{name_, raw_.text});
}

base::Result<Request> Decoder::write_tag() const {
  constexpr std::size_t room_of_id = sizeof(rtmsim_rfid_tag::id), room_of_data = sizeof(rtmsim_rfid_tag::data);
  if (name_.empty()) return fail("needs a name");
  const std::size_t end = raw_.text.find('\n');
  if (end == std::string::npos || end == 0) return fail("needs the id of a tag and its data");
  WriteTagRequest request{name_, raw_.text.substr(0, end), raw_.text.substr(end + 1)};
  if (request.id.size() >= room_of_id) return fail("the id of a tag must have at most 63 bytes, got " + std::to_string(request.id.size()));
  if (request.data.size() >= room_of_data)
    return fail("the data of a tag must have at most 127 bytes, got " + std::to_string(request.data.size()));
  constexpr std::string_view impossible("\n\0", 2);
  if (request.data.find_first_of(impossible) != std::string::npos) return fail("the data of a tag must have no line breaks and no zeros");
  return Request(std::move(request));
}

base::Result<Request> Decoder::decode() {
  if (auto good = check_common(); !good) return good.error();
  switch (raw_.kind) {
    case RTMSIM_REQUEST_PAUSE:
      return Request(PauseRequest{});
    case RTMSIM_REQUEST_RUN:
      return Request(RunRequest{});
    case RTMSIM_REQUEST_STEP:
      return step();
    case RTMSIM_REQUEST_RESET:
      return reset();
    case RTMSIM_REQUEST_GET_POSE:
      return named(GetPoseRequest{}, &GetPoseRequest::name);
    case RTMSIM_REQUEST_SET_POSE:
      return set_pose();
    case RTMSIM_REQUEST_GET_VELOCITY:
      return named(GetVelocityRequest{}, &GetVelocityRequest::name);
    case RTMSIM_REQUEST_SET_VELOCITY:
    case RTMSIM_REQUEST_WRENCH:
      return twist();
    case RTMSIM_REQUEST_LIST:
      return Request(ListRequest{});
    case RTMSIM_REQUEST_TREE:
      return Request(TreeRequest{name_, (body().flags & flag_1) != 0});
    case RTMSIM_REQUEST_SPAWN:
      return spawn();
    case RTMSIM_REQUEST_DELETE:
      return named(DeleteRequest{}, &DeleteRequest::model);
    case RTMSIM_REQUEST_SCREENSHOT:
      return screenshot();
    case RTMSIM_REQUEST_STATS:
      return Request(StatsRequest{});
    case RTMSIM_REQUEST_RESET_ODOMETRY:
      return reset_odometry();
    case RTMSIM_REQUEST_SET_MOTORS:
      if (body().count != 0 && body().count != 1) return fail("count must be 0 or 1, got " + std::to_string(body().count));
      return named(SetMotorsRequest{{}, body().count == 1}, &SetMotorsRequest::iface);
    case RTMSIM_REQUEST_SET_RTF:
      if (values()[0] < 0) return fail("the real-time factor must not be negative, got " + base::format_number(values()[0]));
      return Request(SetRtfRequest{values()[0]});
    case RTMSIM_REQUEST_CONTACTS:
      return named(ContactsRequest{}, &ContactsRequest::model);
    case RTMSIM_REQUEST_DROP_PARTICIPANT:
      return named(DropParticipantRequest{}, &DropParticipantRequest::name);
    case RTMSIM_REQUEST_EXPORT:
      return Request(ExportRequest{(body().flags & flag_1) != 0});
    case RTMSIM_REQUEST_POSES:
      return Request(PosesRequest{});
    case RTMSIM_REQUEST_FAULT:
      return fault();
    case RTMSIM_REQUEST_END_FAULTS:
      return end_faults();
    case RTMSIM_REQUEST_FAULTS:
      return Request(FaultsRequest{name_});
    case RTMSIM_REQUEST_MODELS:
      return Request(ModelsRequest{});
    case RTMSIM_REQUEST_POSE_LOG:
      if (body().count < 0) return fail("the first byte must not be negative, got " + std::to_string(body().count));
      return Request(PoseLogRequest{body().count, raw_.text});
    case RTMSIM_REQUEST_SHOW:
      return Request(ShowRequest{});
    case RTMSIM_REQUEST_WRITE_TAG:
      return write_tag();
    default:
      return fail("unknown kind");
  }
}

}  // namespace

RawRequest encode(const Request& request) {
  RawRequest raw;
  raw.kind = static_cast<std::uint32_t>(request.index()) + 1;
  std::visit(Encoder{raw}, request);
  return raw;
}

base::Result<Request> decode(const RawRequest& raw) {
  if (raw.kind == 0 || raw.kind >= names.size()) return base::Error{"unknown kind of request: " + std::to_string(raw.kind)};
  return Decoder(raw).decode();
}

std::string_view request_name(const Request& request) { return names[request.index() + 1]; }

Pose planar_pose(double x, double y, double z, double yaw) { return {x, y, z, std::cos(yaw / 2), 0, 0, std::sin(yaw / 2)}; }

Pose euler_pose(double x, double y, double z, double roll, double pitch, double yaw) {
  const double cr = std::cos(roll / 2), sr = std::sin(roll / 2), cp = std::cos(pitch / 2), sp = std::sin(pitch / 2);
  const double cy = std::cos(yaw / 2), sy = std::sin(yaw / 2);
  return {x, y, z, cr * cp * cy + sr * sp * sy, sr * cp * cy - cr * sp * sy, cr * sp * cy + sr * cp * sy, cr * cp * sy - sr * sp * cy};
}

double yaw_of(const Pose& pose) {
  return std::atan2(2 * (pose.qw * pose.qz + pose.qx * pose.qy), 1 - 2 * (pose.qy * pose.qy + pose.qz * pose.qz));
}

}  // namespace shm
