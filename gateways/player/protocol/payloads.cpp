#include "protocol/payloads.h"

#include "protocol/payload_codec.h"

namespace player {
namespace {

constexpr std::size_t max_driver_name = 63;  // clients write a zero behind it into a field of 64
constexpr std::size_t max_key = 32;          // with or without a zero behind it
constexpr std::size_t max_name = 4096;
constexpr std::size_t max_value = 65536;

}  // namespace

void put(XdrWriter& out, const Pose2d& pose) {
  for (const double value : {pose.x, pose.y, pose.a}) out.f64(value);
}

void put(XdrWriter& out, const Pose3d& pose) {
  for (const double value : {pose.x, pose.y, pose.z, pose.roll, pose.pitch, pose.yaw}) out.f64(value);
}

void put(XdrWriter& out, const Size3d& size) {
  for (const double value : {size.width, size.length, size.height}) out.f64(value);
}

void put(XdrWriter& out, const Address& address) {
  out.u32(0);
  out.u32(0);
  out.u32(static_cast<std::uint16_t>(address.interface));
  out.u32(address.index);
}

Pose2d take_pose2d(XdrReader& in) {
  Pose2d pose;
  for (double* value : {&pose.x, &pose.y, &pose.a}) *value = in.f64();
  return pose;
}

Pose3d take_pose3d(XdrReader& in) {
  Pose3d pose;
  for (double* value : {&pose.x, &pose.y, &pose.z, &pose.roll, &pose.pitch, &pose.yaw}) *value = in.f64();
  return pose;
}

Address take_address(XdrReader& in) {
  in.u32();
  in.u32();
  Address address;
  address.interface = static_cast<Interface>(in.small(0xffff));
  address.index = static_cast<std::uint16_t>(in.small(0xffff));
  return address;
}

// ---- player ----

std::string encode(const DeviceRequest& request) {
  return written([&](XdrWriter& out) {
    put(out, request.address);
    out.u32(request.access);
    out.counted_text(std::string_view(request.driver).substr(0, max_driver_name - 1));
  });
}

std::optional<DeviceRequest> decode_device_request(std::string_view payload) {
  return whole(payload, [](XdrReader& in) {
    DeviceRequest request;
    request.address = take_address(in);
    request.access = in.u32();
    request.driver = in.counted_text(64);
    return request;
  });
}

std::string encode(const DriverInfo& info) {
  return written([&](XdrWriter& out) {
    put(out, info.address);
    out.counted_text(std::string_view(info.driver).substr(0, max_driver_name - 1));
  });
}

std::optional<DriverInfo> decode_driver_info(std::string_view payload) {
  return whole(payload, [](XdrReader& in) {
    DriverInfo info;
    info.address = take_address(in);
    info.driver = in.counted_text(64);
    return info;
  });
}

std::optional<std::string> decode_key(std::string_view payload) {
  return whole(payload, [](XdrReader& in) { return std::string(in.counted_text(max_key + 1)); });
}

std::string encode_key(std::string_view key) {
  return written([&](XdrWriter& out) { out.counted_bytes(key); });
}

std::string encode_device_list(const std::vector<Address>& devices) {
  return written([&](XdrWriter& out) {
    out.count(devices.size());
    for (const Address& device : devices) put(out, device);
  });
}

std::optional<ReplaceRule> decode_replace_rule(std::string_view payload) {
  return whole(payload, [](XdrReader& in) {
    ReplaceRule rule;
    for (std::int32_t* value : {&rule.interface, &rule.index, &rule.type, &rule.subtype, &rule.replace}) *value = in.i32();
    return rule;
  });
}

// ---- what each interface has ----

std::optional<Capability> decode_capability(std::string_view payload) {
  return whole(payload, [](XdrReader& in) {
    const std::uint32_t type = in.u32();
    return Capability{type, in.u32()};
  });
}

std::string encode(const DriverProperty& property) {
  return written([&](XdrWriter& out) {
    out.counted_text(property.key);
    std::visit(
        [&out]<class T>(const T& value) {
          if constexpr (std::is_same_v<T, std::int32_t>) out.i32(value);
          if constexpr (std::is_same_v<T, double>) out.f64(value);
          if constexpr (std::is_same_v<T, std::string>) out.counted_text(value);
          if constexpr (std::is_same_v<T, bool>) out.boolean(value);
        },
        property.value);
  });
}

std::optional<DriverProperty> decode_driver_property(std::uint8_t subtype, std::string_view payload) {
  using namespace universal_request;
  if (subtype < set_bool || subtype > get_int) return std::nullopt;
  return whole(payload, [subtype](XdrReader& in) {
    DriverProperty property;
    property.key = in.counted_text(max_name);
    if (subtype == get_int || subtype == set_int) property.value = in.i32();
    if (subtype == get_double || subtype == set_double) property.value = in.f64();
    if (subtype == get_string || subtype == set_string) property.value = std::string(in.counted_text(max_value));
    if (subtype == get_bool || subtype == set_bool) property.value = in.boolean();
    return property;
  });
}

// ---- position ----

std::string encode(const Position2dState& state) {
  return written([&](XdrWriter& out) {
    put(out, state.pose);
    put(out, state.velocity);
    out.boolean(state.is_stalled);
  });
}

std::optional<Position2dState> decode_position2d_state(std::string_view payload) {
  return whole(payload, [](XdrReader& in) {
    Position2dState state;
    state.pose = take_pose2d(in);
    state.velocity = take_pose2d(in);
    state.is_stalled = in.boolean();
    return state;
  });
}

std::string encode(const Position3dState& state) {
  return written([&](XdrWriter& out) {
    put(out, state.pose);
    put(out, state.velocity);
    out.boolean(state.is_stalled);
  });
}

std::string encode(const Velocity2d& velocity) {
  return written([&](XdrWriter& out) {
    put(out, velocity.velocity);
    out.boolean(velocity.is_enabled);
  });
}

std::optional<Velocity2d> decode_velocity2d(std::string_view payload) {
  return whole(payload, [](XdrReader& in) {
    Velocity2d velocity;
    velocity.velocity = take_pose2d(in);
    velocity.is_enabled = in.boolean();
    return velocity;
  });
}

std::optional<PoseCommand2d> decode_pose_command2d(std::string_view payload) {
  return whole(payload, [](XdrReader& in) {
    PoseCommand2d command;
    command.pose = take_pose2d(in);
    command.velocity = take_pose2d(in);
    command.is_enabled = in.boolean();
    return command;
  });
}

std::optional<PoseCommand3d> decode_pose_command3d(std::string_view payload) {
  return whole(payload, [](XdrReader& in) {
    PoseCommand3d command;
    command.pose = take_pose3d(in);
    command.velocity = take_pose3d(in);
    command.is_enabled = in.boolean();
    return command;
  });
}

std::optional<HeadingCommand> decode_heading_command(std::string_view payload) {
  return whole(payload, [](XdrReader& in) {
    const double speed = in.f64();
    return HeadingCommand{speed, in.f64()};
  });
}

std::optional<Pid> decode_pid(std::string_view payload) {
  return whole(payload, [](XdrReader& in) {
    Pid pid;
    for (float* value : {&pid.p, &pid.i, &pid.d}) *value = in.f32();
    return pid;
  });
}

std::optional<SpeedProfile> decode_speed_profile(std::string_view payload) {
  return whole(payload, [](XdrReader& in) {
    const float speed = in.f32();
    return SpeedProfile{speed, in.f32()};
  });
}

std::optional<Pose3d> decode_velocity3d(std::string_view payload) {
  return whole(payload, [](XdrReader& in) {
    const Pose3d velocity = take_pose3d(in);
    in.boolean();
    return velocity;
  });
}

std::optional<Pose2d> decode_pose2d(std::string_view payload) { return whole(payload, take_pose2d); }
std::optional<Pose3d> decode_pose3d(std::string_view payload) { return whole(payload, take_pose3d); }

std::string encode_geometry(const Pose3d& pose, const Size3d& size) {
  return written([&](XdrWriter& out) {
    put(out, pose);
    put(out, size);
  });
}

std::optional<std::uint8_t> decode_byte(std::string_view payload) {
  return whole(payload, [](XdrReader& in) { return static_cast<std::uint8_t>(in.small(255)); });
}

std::optional<std::uint32_t> decode_u32(std::string_view payload) {
  return whole(payload, [](XdrReader& in) { return in.u32(); });
}

std::string encode_u32(std::uint32_t value) {
  return written([&](XdrWriter& out) { out.u32(value); });
}

// ---- simulation ----

std::string encode(const NamedPose2d& request) {
  return written([&](XdrWriter& out) {
    out.counted_text(request.name);
    put(out, request.pose);
  });
}

std::optional<NamedPose2d> decode_named_pose2d(std::string_view payload) {
  return whole(payload, [](XdrReader& in) {
    NamedPose2d request;
    request.name = in.counted_text(max_name);
    request.pose = take_pose2d(in);
    return request;
  });
}

std::string encode(const NamedPose3d& request) {
  return written([&](XdrWriter& out) {
    out.counted_text(request.name);
    put(out, request.pose);
    out.f64(request.sim_time);
  });
}

std::optional<NamedPose3d> decode_named_pose3d(std::string_view payload) {
  return whole(payload, [](XdrReader& in) {
    NamedPose3d request;
    request.name = in.counted_text(max_name);
    request.pose = take_pose3d(in);
    request.sim_time = in.f64();
    return request;
  });
}

std::string encode(const Property& request) {
  return written([&](XdrWriter& out) {
    out.counted_text(request.name);
    out.counted_text(request.property);
    out.u32(request.index);
    out.counted_bytes(request.value);
  });
}

std::optional<Property> decode_property(std::string_view payload) {
  return whole(payload, [](XdrReader& in) {
    Property request;
    request.name = in.counted_text(max_name);
    request.property = in.counted_text(max_name);
    request.index = in.u32();
    request.value = in.counted_bytes(max_value);
    return request;
  });
}

}  // namespace player
