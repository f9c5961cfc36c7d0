#include "protocol/message.h"

#include <algorithm>
#include <array>
#include <utility>

#include "protocol/xdr.h"

namespace player {
namespace {

constexpr auto names = std::to_array<std::pair<Interface, std::string_view>>({
    {Interface::player, "player"},
    {Interface::power, "power"},
    {Interface::gripper, "gripper"},
    {Interface::position2d, "position2d"},
    {Interface::sonar, "sonar"},
    {Interface::laser, "laser"},
    {Interface::ptz, "ptz"},
    {Interface::gps, "gps"},
    {Interface::bumper, "bumper"},
    {Interface::aio, "aio"},
    {Interface::wifi, "wifi"},
    {Interface::localize, "localize"},
    {Interface::position3d, "position3d"},
    {Interface::simulation, "simulation"},
    {Interface::camera, "camera"},
    {Interface::map, "map"},
    {Interface::actarray, "actarray"},
    {Interface::limb, "limb"},
    {Interface::rfid, "rfid"},
    {Interface::imu, "imu"},
    {Interface::pointcloud3d, "pointcloud3d"},
    {Interface::ranger, "ranger"},
    {Interface::fiducial, "fiducial"},
    {Interface::blobfinder, "blobfinder"},
    {Interface::dio, "dio"},
    {Interface::planner, "planner"},
    {Interface::opaque, "opaque"},
    {Interface::vectormap, "vectormap"},
    {Interface::stereo, "stereo"},
    {Interface::graphics2d, "graphics2d"},
    {Interface::graphics3d, "graphics3d"},
});

constexpr auto other_names = std::to_array<std::pair<std::uint16_t, std::string_view>>({
    {9, "audio"},
    {12, "speech"},
    {22, "ir"},
    {26, "mcom"},
    {33, "blinkenlight"},
    {45, "log"},
    {49, "joystick"},
    {50, "speech_recognition"},
    {52, "position1d"},
    {57, "wsn"},
    {59, "health"},
    {64, "blackboard"},
    {66, "coopobject"},
});

}  // namespace

std::string_view to_text(Interface interface) {
  for (const auto& [code, name] : names) {
    if (code == interface) return name;
  }
  return {};
}

std::optional<Interface> parse_interface(std::string_view wanted) {
  for (const auto& [code, name] : names) {
    if (name == wanted) return code;
  }
  return std::nullopt;
}

bool is_interface_name(std::string_view name) {
  return parse_interface(name).has_value() ||
         std::any_of(other_names.begin(), other_names.end(), [&](const auto& other) { return other.second == name; });
}

std::string_view any_name(Interface interface) {
  if (const auto served = to_text(interface); !served.empty()) return served;
  const auto other = std::find_if(other_names.begin(), other_names.end(),
                                  [&](const auto& one) { return one.first == static_cast<std::uint16_t>(interface); });
  return other == other_names.end() ? std::string_view() : other->second;
}

std::string to_text(const Address& address) {
  const auto name = any_name(address.interface);
  return (name.empty() ? std::to_string(static_cast<unsigned>(address.interface)) : std::string(name)) + ":" +
         std::to_string(address.index);
}

std::string banner(std::string_view version) {
  std::string text = "Player v.3.1.0 (rtm-sim " + std::string(version) + ")";
  text.resize(banner_size - 1);
  text.resize(banner_size);
  return text;
}

std::string encode(const Header& header, std::uint32_t robot, std::string_view payload) {
  XdrWriter out;
  out.bytes().reserve(header_size + payload.size());
  out.u32(0);
  out.u32(robot);
  out.u32(static_cast<std::uint16_t>(header.address.interface));
  out.u32(header.address.index);
  out.u32(static_cast<std::uint8_t>(header.type));
  out.u32(header.subtype);
  out.f64(header.timestamp);
  out.u32(0);
  out.u32(static_cast<std::uint32_t>(payload.size()));
  out.bytes() += payload;
  return std::move(out.bytes());
}

void MessageParser::feed(std::string_view bytes) {
  if (start_ > 0) {
    buffer_.erase(0, start_);
    start_ = 0;
  }
  buffer_ += bytes;
}

base::Result<std::optional<Message>> MessageParser::next() {
  const std::string_view rest = std::string_view(buffer_).substr(start_);
  if (rest.size() < header_size) return std::optional<Message>();
  XdrReader in(rest.substr(0, header_size));
  in.u32();  // host
  in.u32();  // robot
  Message message;
  Header& header = message.header;
  header.address.interface = static_cast<Interface>(in.small(0xffff));
  header.address.index = static_cast<std::uint16_t>(in.small(0xffff));
  header.type = static_cast<Type>(in.small(0xff));
  header.subtype = static_cast<std::uint8_t>(in.small(0xff));
  header.timestamp = in.f64();
  in.u32();  // sequence number
  header.size = in.u32();
  if (!in.good()) return base::Error{"bytes that are no header of Player"};
  if (header.size > max_payload_) {
    return base::Error{"payload of " + std::to_string(header.size) + " bytes, expected at most " + std::to_string(max_payload_)};
  }
  if (rest.size() - header_size < header.size) return std::optional<Message>();
  message.payload = rest.substr(header_size, header.size);
  start_ += header_size + header.size;
  return std::optional<Message>(std::move(message));
}

}  // namespace player
