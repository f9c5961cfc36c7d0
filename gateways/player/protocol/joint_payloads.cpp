#include "protocol/payload_codec.h"
#include "protocol/payloads.h"

namespace player {
namespace {

constexpr std::size_t max_joints = 4096;

void put(XdrWriter& out, const Point3d& point) {
  for (const double value : {point.x, point.y, point.z}) out.f64(value);
}

Point3d take_point(XdrReader& in) {
  Point3d point;
  for (double* value : {&point.x, &point.y, &point.z}) *value = in.f64();
  return point;
}

}  // namespace

// ---- actarray ----

std::string encode(const std::vector<Actuator>& actuators, bool is_powered) {
  return written([&](XdrWriter& out) {
    out.count(actuators.size());
    for (const Actuator& one : actuators) {
      for (const float value : {one.position, one.speed, one.acceleration, one.current}) out.f32(value);
      out.u32(one.state);
    }
    out.boolean(is_powered);
  });
}

std::string encode(const std::vector<ActuatorGeometry>& actuators, const Pose3d& base) {
  return written([&](XdrWriter& out) {
    out.count(actuators.size());
    for (const ActuatorGeometry& one : actuators) {
      out.u32(one.turns ? 2 : 1);
      out.f32(one.length);
      for (const double angle : {one.orientation.roll, one.orientation.pitch, one.orientation.yaw}) out.f64(angle);
      put(out, one.axis);
      for (const float value : {one.min, one.centre, one.max, one.home, one.speed}) out.f32(value);
      out.boolean(true);  // brakes
    }
    put(out, base);  // position and orientation
  });
}

std::optional<JointNumber> decode_joint_number(std::string_view payload) {
  return whole(payload, [](XdrReader& in) {
    const std::int32_t joint = in.i32();
    return JointNumber{joint, in.f32()};
  });
}

std::optional<std::int32_t> decode_joint(std::string_view payload) {
  return whole(payload, [](XdrReader& in) { return in.i32(); });
}

std::optional<std::vector<float>> decode_joint_numbers(std::string_view payload) {
  return whole(payload, [](XdrReader& in) {
    std::vector<float> values(in.count(sizeof(float), max_joints));
    for (float& value : values) value = in.f32();
    return values;
  });
}

// ---- limb ----

std::string encode(const LimbState& state) {
  return written([&](XdrWriter& out) {
    for (const Point3d& point : {state.pose.position, state.pose.approach, state.pose.orientation}) put(out, point);
    out.u32(state.state);
  });
}

std::string encode(const Point3d& point) {
  return written([&](XdrWriter& out) { put(out, point); });
}

std::optional<LimbPose> decode_limb_pose(std::string_view payload) {
  return whole(payload, [](XdrReader& in) {
    LimbPose pose;
    for (Point3d* point : {&pose.position, &pose.approach, &pose.orientation}) *point = take_point(in);
    return pose;
  });
}

std::optional<Point3d> decode_point(std::string_view payload) { return whole(payload, take_point); }

std::optional<VectorMove> decode_vector_move(std::string_view payload) {
  return whole(payload, [](XdrReader& in) {
    const Point3d direction = take_point(in);
    return VectorMove{direction, in.f32()};
  });
}

std::optional<float> decode_float(std::string_view payload) {
  return whole(payload, [](XdrReader& in) { return in.f32(); });
}

// ---- gripper ----

std::string encode(const GripperState& state) {
  return written([&](XdrWriter& out) {
    out.u32(state.state);
    out.u32(0);  // beams
    out.u32(0);  // objects in the store
  });
}

std::string encode_gripper_geometry(const Pose3d& pose, const Size3d& outer, const Size3d& inner) {
  return written([&](XdrWriter& out) {
    put(out, pose);
    put(out, outer);
    put(out, inner);
    out.u32(0);  // beams
    out.u32(0);  // places in the store
  });
}

// ---- ptz ----

std::string encode(const PtzState& state) {
  return written([&](XdrWriter& out) {
    for (const float value : {state.pan, state.tilt, state.zoom, state.pan_speed, state.tilt_speed}) out.f32(value);
    out.u32(0);  // status
  });
}

std::optional<PtzState> decode_ptz_command(std::string_view payload) {
  return whole(payload, [](XdrReader& in) {
    PtzState wanted;
    for (float* value : {&wanted.pan, &wanted.tilt, &wanted.zoom, &wanted.pan_speed, &wanted.tilt_speed}) *value = in.f32();
    return wanted;
  });
}

}  // namespace player
