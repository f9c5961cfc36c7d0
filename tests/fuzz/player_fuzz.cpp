// Bytes from a client of Player: whatever comes is cut into messages and decoded, or refused, and what is decoded can be encoded and
// decoded again. Mutates good messages; prints its seed.
//   player_fuzz [--runs N] [--seed N]
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include "protocol/message.h"
#include "protocol/payloads.h"
#include "support/usage.h"

namespace {

using player::Interface;

std::string message(Interface interface, player::Type type, std::uint8_t subtype, const std::string& payload) {
  return player::encode({.address = {interface, 0}, .type = type, .subtype = subtype, .timestamp = 1, .size = 0}, 6665, payload);
}

std::vector<std::string> make_seeds() {
  using enum player::Type;
  player::XdrWriter rule;
  for (const std::int32_t value : {-1, -1, 1, -1, 1}) rule.i32(value);
  return {
      message(Interface::player, request, 1, ""),
      message(Interface::player, request, 2, player::encode(player::DriverInfo{{Interface::laser, 0}, "driver"})),
      message(Interface::player, request, 3, player::encode(player::DeviceRequest{{Interface::laser, 0}, 1, "driver"})),
      message(Interface::player, request, 5, player::encode_u32(2)),
      message(Interface::player, request, 10, rule.bytes()),
      message(Interface::position2d, command, 1, player::encode(player::Velocity2d{{0.5, 0, 1}, true})),
      message(Interface::position2d, data, 1, player::encode(player::Position2dState{{1, 2, 3}, {4, 5, 6}, false})),
      message(Interface::laser, data, 1, player::encode(player::LaserScan{-1, 1, 0.5F, 8, {1, 2, 3, 4, 5}, "abcde", 7})),
      message(Interface::player, request, 7, player::encode_key("open sesame")),
      message(Interface::laser, request, 2, player::encode(player::LaserConfig{-1, 1, 0.5F, 8, 0.01F, true, 10})),
      message(Interface::ranger, request, 4, player::encode(player::RangerConfig{-1, 1, 0.5, 0.1, 8, 0.01, 10})),
      message(Interface::simulation, request, 1, player::encode(player::NamedPose2d{"robot", {1, 2, 3}})),
      message(Interface::simulation, request, 3, player::encode(player::NamedPose3d{"robot", {1, 2, 3, 4, 5, 6}, 7})),
      message(Interface::position2d, request, player::universal_request::set_double, player::encode(player::DriverProperty{"speed", 0.5})),
      message(Interface::position2d, request, player::universal_request::get_string,
              player::encode(player::DriverProperty{"iface", std::string("one")})),
      message(Interface::simulation, request, 5, player::encode(player::Property{"world", "sim_time", 0, std::string(8, '\0')})),
  };
}

void mutate(std::string& bytes, std::mt19937& random) {
  const auto below = [&](std::size_t end) { return random() % end; };
  for (std::size_t i = below(4) + 1; i > 0; --i) {
    switch (below(5)) {
      case 0:
        if (!bytes.empty()) bytes[below(bytes.size())] = static_cast<char>(random());
        break;
      case 1:
        bytes.resize(below(bytes.size() + 1));
        break;
      case 2:
        bytes.insert(below(bytes.size() + 1), std::string(below(40), static_cast<char>(random())));
        break;
      case 3:  // a count or size
        if (bytes.size() >= 4) bytes.replace(below(bytes.size() / 4) * 4, 4, std::string("\xff\xff\xff\xff", 4));
        break;
      default:
        if (bytes.size() >= 44) bytes[36 + 3] = static_cast<char>(bytes.size() - 40);  // the size fits again
    }
  }
}

// What was decoded must survive its own encoding.
template <class Value, class Decode>
bool comes_back(const std::optional<Value>& value, Decode decode) {
  return !value || decode(player::encode(*value)).has_value();
}

// True when everything that can be decoded also comes back.
bool decode_all(std::string_view payload) {
  using namespace player;
  static_cast<void>(decode_replace_rule(payload));
  static_cast<void>(decode_byte(payload));
  static_cast<void>(decode_u32(payload));
  static_cast<void>(decode_pose2d(payload));
  static_cast<void>(decode_pose3d(payload));
  static_cast<void>(decode_velocity3d(payload));
  static_cast<void>(decode_pose_command2d(payload));
  static_cast<void>(decode_heading_command(payload));
  static_cast<void>(decode_pid(payload));
  static_cast<void>(decode_speed_profile(payload));
  static_cast<void>(decode_capability(payload));
  if (const auto config = decode_laser_config(payload)) static_cast<void>(encode(*config));
  for (unsigned subtype = 0; subtype < 256; ++subtype) {
    const auto decode = [subtype](std::string_view bytes) { return decode_driver_property(static_cast<std::uint8_t>(subtype), bytes); };
    if (universal_request::is_one(static_cast<std::uint8_t>(subtype)) && !comes_back(decode(payload), decode)) return false;
  }
  if (const auto key = decode_key(payload); key && decode_key(encode_key(*key)) != key) return false;
  return comes_back(decode_device_request(payload), decode_device_request) && comes_back(decode_driver_info(payload), decode_driver_info) &&
         comes_back(decode_velocity2d(payload), decode_velocity2d) && comes_back(decode_ranger_config(payload), decode_ranger_config) &&
         comes_back(decode_position2d_state(payload), decode_position2d_state) &&
         comes_back(decode_laser_scan(payload), decode_laser_scan) && comes_back(decode_named_pose2d(payload), decode_named_pose2d) &&
         comes_back(decode_named_pose3d(payload), decode_named_pose3d) && comes_back(decode_property(payload), decode_property);
}

}  // namespace

int main(int argc, char** argv) {
  ::test::answer_help(argc, argv, "player_fuzz [--runs N] [--seed N]\nReads damaged messages of Player; it must not crash or hang.");
  unsigned long runs = 50000;
  unsigned seed = std::random_device()();
  for (int i = 1; i + 1 < argc; i += 2) {
    if (std::strcmp(argv[i], "--runs") == 0) runs = std::strtoul(argv[i + 1], nullptr, 10);
    if (std::strcmp(argv[i], "--seed") == 0) seed = static_cast<unsigned>(std::strtoul(argv[i + 1], nullptr, 10));
  }
  std::printf("seed %u\n", seed);
  std::mt19937 random(seed);
  const auto seeds = make_seeds();
  unsigned long messages = 0, refused = 0;
  for (unsigned long run = 0; run < runs; ++run) {
    std::string stream;
    for (std::size_t i = random() % 3 + 1; i > 0; --i) stream += seeds[random() % seeds.size()];
    if (run >= seeds.size()) mutate(stream, random);
    player::MessageParser parser(100000);
    for (std::size_t at = 0; at < stream.size();) {
      // A piece of its own size, so that a sanitizer sees every byte too far.
      const std::vector<char> piece(stream.begin() + static_cast<long>(at),
                                    stream.begin() + static_cast<long>(std::min(stream.size(), at + random() % 100 + 1)));
      parser.feed({piece.data(), piece.size()});
      at += piece.size();
      while (true) {
        const auto next = parser.next();
        if (!next) {
          ++refused;
          at = stream.size();
          break;
        }
        if (!*next) break;
        ++messages;
        const std::vector<char> payload((*next)->payload.begin(), (*next)->payload.end());
        if (!decode_all({payload.data(), payload.size()}))
          return std::fprintf(stderr, "run %lu: what was decoded does not come back\n", run), 1;
      }
    }
  }
  std::printf("%lu messages, %lu streams refused\n", messages, refused);
  return messages > runs / 2 && refused > 0 ? 0 : 1;
}
