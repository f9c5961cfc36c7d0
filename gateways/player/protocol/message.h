// Messages of Player 3.1: a header of 40 bytes and a payload, both in XDR; and the parser that cuts a stream into them. No sockets; a
// parser belongs to one thread at a time.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "base/result.h"

namespace player {

inline constexpr std::size_t banner_size = 32;
inline constexpr std::size_t header_size = 40;
inline constexpr std::size_t max_message = 8'388'608;  // [bytes] decoded, of what any Player program takes

// Codes of interfaces. Others exist; these are served.
enum class Interface : std::uint16_t {
  player = 1,
  power = 2,
  gripper = 3,
  position2d = 4,
  sonar = 5,
  laser = 6,
  blobfinder = 7,
  ptz = 8,
  fiducial = 10,
  gps = 13,
  bumper = 14,
  dio = 20,
  aio = 21,
  wifi = 23,
  localize = 25,
  position3d = 30,
  simulation = 31,
  camera = 40,
  map = 42,
  planner = 44,
  opaque = 51,
  actarray = 53,
  limb = 54,
  graphics2d = 55,
  rfid = 56,
  graphics3d = 58,
  imu = 60,
  pointcloud3d = 61,
  ranger = 62,
  vectormap = 63,
  stereo = 65,
};
// "laser"; empty for what is not served.
std::string_view to_text(Interface interface);
std::optional<Interface> parse_interface(std::string_view name);
// Of all that Player has, served or not: "blobfinder"; empty for numbers that Player does not have.
std::string_view any_name(Interface interface);
bool is_interface_name(std::string_view name);

enum class Type : std::uint8_t { data = 1, command = 2, request = 3, ack = 4, synch = 5, nack = 6 };

// Of requests to the player device; synch messages have subtypes of their own.
namespace player_request {
inline constexpr std::uint8_t devlist = 1, driverinfo = 2, dev = 3, data = 4, datamode = 5, auth = 7, add_replace_rule = 10;
}
// Of requests that each interface has. Properties of drivers are read and set by requests of their own for each type of value.
namespace universal_request {
inline constexpr std::uint8_t set_bool = 247, get_bool = 248, set_string = 249, get_string = 250, set_double = 251, get_double = 252,
                              set_int = 253, get_int = 254, capabilities = 255;
inline constexpr bool is_one(std::uint8_t subtype) { return subtype >= set_bool; }
inline constexpr bool is_get(std::uint8_t subtype) { return subtype % 2 == 0; }
}  // namespace universal_request
namespace synch {
inline constexpr std::uint8_t ok = 1;
}
enum class Access : std::uint32_t { open = 1, close = 2, error = 3 };
enum class DataMode : std::uint32_t { push = 1, pull = 2 };

// A device on its port. Host and robot of the wire mean nothing to either end.
struct Address {
  Interface interface = Interface::player;
  std::uint16_t index = 0;
  auto operator<=>(const Address&) const = default;
};
// "laser:0"; "67:0" for what Player does not have.
std::string to_text(const Address& address);

struct Header {
  Address address;
  Type type = Type::request;
  std::uint8_t subtype = 0;
  double timestamp = 0;    // [s]
  std::uint32_t size = 0;  // of the payload [bytes]
};

struct Message {
  Header header;
  std::string payload;
};

// Exactly banner_size bytes.
std::string banner(std::string_view version);
// The whole message. `robot`: the port.
std::string encode(const Header& header, std::uint32_t robot, std::string_view payload = {});

// Takes a stream in pieces of any size.
class MessageParser {
 public:
  // Payloads that are longer are an error: nothing after them can be trusted.
  explicit MessageParser(std::size_t max_payload) : max_payload_(max_payload) {}

  void feed(std::string_view bytes);
  // The next whole message; nothing while it has not come. After an error (a header that no Player program sends) it stays an error.
  // Types that do not exist are left to the caller: `header.type` may be any byte.
  base::Result<std::optional<Message>> next();
  // [bytes] not yet taken out.
  std::size_t pending() const { return buffer_.size() - start_; }

 private:
  std::size_t max_payload_;
  std::string buffer_;
  std::size_t start_ = 0;
};

}  // namespace player
