// XDR, messages and payloads of Player: bytes written out by hand from the description of the protocol, and what must be refused.
#include <gtest/gtest.h>

#include <cmath>

#include "protocol/message.h"
#include "protocol/payloads.h"
#include "protocol/xdr.h"

namespace player {
namespace {

// "00 01 | 41" -> bytes; everything but hexadecimal digits is for the reader.
std::string bytes(std::string_view hex) {
  std::string out;
  int high = -1;
  for (const char c : hex) {
    if (!std::isxdigit(static_cast<unsigned char>(c))) continue;
    const int digit = c <= '9' ? c - '0' : (c | 32) - 'a' + 10;
    if (high < 0) {
      high = digit;
    } else {
      out += static_cast<char>(high * 16 + digit);
      high = -1;
    }
  }
  return out;
}

TEST(PlayerXdr, scalars_fill_multiples_of_four_big_endian) {
  XdrWriter out;
  out.u32(0x01020304);
  out.i32(-2);
  out.f32(1.5F);
  out.f64(-2.0);
  out.boolean(true);
  EXPECT_EQ(out.bytes(), bytes("01020304 fffffffe 3fc00000 c000000000000000 00000001"));
}

TEST(PlayerXdr, counted_bytes_have_their_count_twice_and_are_padded) {
  XdrWriter out;
  out.counted_text("abcd");
  EXPECT_EQ(out.bytes(), bytes("00000005 00000005 61626364 00 000000"));
  XdrReader in(out.bytes());
  EXPECT_EQ(in.counted_text(5), "abcd");
  EXPECT_TRUE(in.is_complete());
}

TEST(PlayerXdr, a_text_without_zero_is_taken_whole_and_one_with_zeros_up_to_the_first) {
  const std::string none = bytes("00000004 00000004 61626364"), early = bytes("00000004 00000004 61006364");
  EXPECT_EQ(XdrReader(none).counted_text(64), "abcd");
  EXPECT_EQ(XdrReader(early).counted_text(64), "a");
}

TEST(PlayerXdr, counts_that_cannot_be_true_are_refused) {
  for (const char* hex : {"00000004 00000005 6162636465000000",  // they differ
                          "ffffffff ffffffff 61626364",          // more than there is
                          "00000008 00000008 61626364",          // more than there is
                          "00000041 00000041"}) {                // more than is allowed
    const std::string sent = bytes(hex);
    XdrReader in(sent);
    EXPECT_EQ(in.counted_bytes(64), "");
    EXPECT_FALSE(in.good()) << hex;
    EXPECT_EQ(in.u32(), 0U);
  }
}

TEST(PlayerXdr, cells_of_small_numbers_are_not_cut) {
  const std::string sent = bytes("00000103");
  XdrReader in(sent);
  EXPECT_EQ(in.small(255), 0U);
  EXPECT_FALSE(in.good());
}

TEST(PlayerMessage, header_is_forty_bytes_in_this_order) {
  const Header header{{Interface::laser, 3}, Type::data, 1, 1.5, 0};
  EXPECT_EQ(encode(header, 6665, "abcd"),
            bytes("00000000 00001a09 00000006 00000003 00000001 00000001 3ff8000000000000 00000000 00000004 61626364"));
}

TEST(PlayerMessage, banner_is_thirty_two_bytes_of_text_and_zeros) {
  const auto text = banner("0.1.0");
  EXPECT_EQ(text.size(), banner_size);
  EXPECT_TRUE(text.starts_with("Player v.3.1"));
  EXPECT_EQ(text.back(), '\0');
  EXPECT_EQ(banner(std::string(100, 'x')).back(), '\0');
}

const std::string datamode = bytes("00000000 00000000 00000001 00000000 00000003 00000005 0000000000000000 00000000 00000004 00000002");

TEST(PlayerMessage, stream_is_cut_wherever_its_pieces_end) {
  for (std::size_t piece = 1; piece <= 2 * datamode.size(); ++piece) {
    MessageParser parser(1000);
    const std::string stream = datamode + datamode;
    int found = 0;
    for (std::size_t at = 0; at < stream.size(); at += piece) {
      parser.feed(std::string_view(stream).substr(at, piece));
      while (true) {
        const auto message = parser.next();
        ASSERT_TRUE(message) << message.error().message;
        if (!*message) break;
        EXPECT_EQ((*message)->header.address, (Address{Interface::player, 0}));
        EXPECT_EQ((*message)->header.type, Type::request);
        EXPECT_EQ((*message)->header.subtype, player_request::datamode);
        EXPECT_EQ(decode_byte((*message)->payload), 2);
        ++found;
      }
    }
    EXPECT_EQ(found, 2) << "in pieces of " << piece;
    EXPECT_EQ(parser.pending(), 0U);
  }
}

TEST(PlayerMessage, header_that_no_client_sends_is_an_error) {
  const auto is_error = [](std::string stream) {
    MessageParser parser(1000);
    parser.feed(stream);
    return !parser.next().ok();
  };
  EXPECT_FALSE(is_error(datamode));
  EXPECT_TRUE(is_error("GET / HTTP/1.1\r\nHost: 127.0.0.1:6665\r\nUser-Agent: none\r\n\r\n"));
  for (const auto& [offset, value] : {std::pair<std::size_t, const char*>{8, "00010001"},
                                      {12, "80000000"},
                                      {16, "00000103"},
                                      {20, "00000105"},
                                      {36, "000003e9"},
                                      {36, "ffffffff"},
                                      {36, "7fffffff"}}) {
    std::string changed = datamode;
    changed.replace(offset, 4, bytes(value));
    EXPECT_TRUE(is_error(changed)) << offset << " " << value;
  }
}

TEST(PlayerPayload, device_request_is_answered_with_the_same_structure) {
  const auto asked = decode_device_request(bytes("00000000 00000000 00000004 00000001 00000001 00000000 00000000"));
  ASSERT_TRUE(asked);
  EXPECT_EQ(asked->address, (Address{Interface::position2d, 1}));
  EXPECT_EQ(asked->access, static_cast<std::uint32_t>(Access::open));
  EXPECT_EQ(encode(DeviceRequest{asked->address, asked->access, "p2d"}),
            bytes("00000000 00000000 00000004 00000001 00000001 00000004 00000004 70326400"));
}

// Clients put a zero behind the name in a field of 64 bytes.
TEST(PlayerPayload, driver_names_are_shorter_than_64) {
  const auto info = decode_driver_info(encode(DriverInfo{{Interface::laser, 0}, std::string(200, 'x')}));
  ASSERT_TRUE(info);
  EXPECT_EQ(info->driver, std::string(62, 'x'));
}

TEST(PlayerPayload, device_list_counts_twice) {
  EXPECT_EQ(encode_device_list({{Interface::laser, 0}, {Interface::ranger, 2}}),
            bytes("00000002 00000002  00000000 00000000 00000006 00000000  00000000 00000000 0000003e 00000002"));
}

TEST(PlayerPayload, position2d_state_is_52_bytes) {
  const Position2dState state{{1, 2, 0.5}, {0.25, 0, -0.5}, true};
  const auto encoded = encode(state);
  EXPECT_EQ(encoded,
            bytes("3ff0000000000000 4000000000000000 3fe0000000000000 3fd0000000000000 0000000000000000 bfe0000000000000 00000001"));
  const auto decoded = decode_position2d_state(encoded);
  ASSERT_TRUE(decoded);
  EXPECT_EQ(decoded->velocity.a, -0.5);
  EXPECT_TRUE(decoded->is_stalled);
}

TEST(PlayerPayload, velocity_command_is_28_bytes_and_nothing_else) {
  const auto wire = bytes("3fd0000000000000 0000000000000000 bfe0000000000000 00000001");
  const auto command = decode_velocity2d(wire);
  ASSERT_TRUE(command);
  EXPECT_EQ(command->velocity.x, 0.25);
  EXPECT_EQ(command->velocity.a, -0.5);
  EXPECT_EQ(encode(*command), wire);
  EXPECT_FALSE(decode_velocity2d(wire.substr(0, 24)));
  EXPECT_FALSE(decode_velocity2d(wire + bytes("00000000")));
  EXPECT_FALSE(decode_velocity2d(""));
}

TEST(PlayerPayload, pose_command_is_52_bytes_and_heading_command_16) {
  const auto pose = decode_pose_command2d(
      bytes("3ff0000000000000 4000000000000000 3fe0000000000000 3fd0000000000000 0000000000000000 bfe0000000000000 00000000"));
  ASSERT_TRUE(pose);
  EXPECT_EQ(pose->pose.y, 2);
  EXPECT_EQ(pose->velocity.x, 0.25);
  EXPECT_EQ(pose->velocity.a, -0.5);
  EXPECT_FALSE(pose->is_enabled);
  const auto heading = decode_heading_command(bytes("3fd0000000000000 bfe0000000000000"));
  ASSERT_TRUE(heading);
  EXPECT_EQ(heading->speed, 0.25);
  EXPECT_EQ(heading->angle, -0.5);
  EXPECT_FALSE(decode_heading_command(bytes("3fd0000000000000")));
}

TEST(PlayerPayload, property_of_a_driver_has_the_type_of_its_request) {
  using namespace universal_request;
  const auto key = bytes("00000004 00000004 6b657900");  // "key"
  const auto number = decode_driver_property(get_int, key + bytes("fffffffe"));
  ASSERT_TRUE(number);
  EXPECT_EQ(number->key, "key");
  EXPECT_EQ(number->value, PropertyValue(std::int32_t{-2}));
  EXPECT_EQ(encode(*number), key + bytes("fffffffe"));
  EXPECT_EQ(decode_driver_property(set_double, key + bytes("3fd0000000000000"))->value, PropertyValue(0.25));
  EXPECT_EQ(decode_driver_property(set_bool, key + bytes("00000001"))->value, PropertyValue(true));
  const auto text = bytes("00000003 00000003 68690000");  // "hi"
  EXPECT_EQ(decode_driver_property(set_string, key + text)->value, PropertyValue(std::string("hi")));
  EXPECT_EQ(encode(DriverProperty{"key", std::string("hi")}), key + text);
  EXPECT_FALSE(decode_driver_property(get_int, key));
  EXPECT_FALSE(decode_driver_property(get_double, key + bytes("00000001")));
  EXPECT_FALSE(decode_driver_property(capabilities, key + bytes("00000001")));
}

TEST(PlayerPayload, laser_scan_has_ranges_and_bytes_of_intensity) {
  const LaserScan scan{-0.5F, 0.5F, 0.5F, 8.0F, {1.0F, 2.0F, 8.0F}, std::string("\x01\x00\xff", 3), 7};
  const auto encoded = encode(scan);
  EXPECT_EQ(encoded,
            bytes("bf000000 3f000000 3f000000 41000000 00000003 00000003 3f800000 40000000 41000000 00000003 00000003 0100ff00 00000007"));
  const auto decoded = decode_laser_scan(encoded);
  ASSERT_TRUE(decoded);
  EXPECT_EQ(decoded->ranges, scan.ranges);
  EXPECT_EQ(decoded->intensities, scan.intensities);
  EXPECT_EQ(decoded->id, 7U);
}

TEST(PlayerPayload, replace_rule_is_five_signed_numbers) {
  const auto rule = decode_replace_rule(bytes("ffffffff ffffffff 00000001 ffffffff 00000001"));
  ASSERT_TRUE(rule);
  EXPECT_EQ(rule->interface, -1);
  EXPECT_EQ(rule->type, 1);
  EXPECT_EQ(rule->replace, 1);
}

TEST(PlayerPayload, pose_of_a_model_goes_with_its_name) {
  const auto wire = bytes("00000006 00000006 726f626f7400 0000 3ff0000000000000 4000000000000000 0000000000000000");
  const auto request = decode_named_pose2d(wire);
  ASSERT_TRUE(request);
  EXPECT_EQ(request->name, "robot");
  EXPECT_EQ(request->pose.y, 2);
  EXPECT_EQ(encode(*request), wire);
}

TEST(PlayerPayload, image_is_followed_by_its_pixels) {
  const Image image{2, 1, 24, ImageFormat::rgb888, "abcdef"};
  EXPECT_EQ(encode(image), bytes("00000002 00000001 00000018 00000005 00000001 00000000 00000006 00000006 616263646566 0000"));
}

TEST(PlayerPayload, power_has_five_valid_values) {
  EXPECT_EQ(encode(PowerState{12, 50, 1000, -6, -1}), bytes("0000001f 41400000 42480000 447a0000 c0c00000 ffffffff"));
  const auto policy = decode_charging_policy(bytes("00000001 00000000"));
  ASSERT_TRUE(policy);
  EXPECT_TRUE(policy->has_input);
  EXPECT_FALSE(policy->has_output);
  EXPECT_FALSE(decode_charging_policy(bytes("00000001")));
}

TEST(PlayerPayload, tags_and_links_have_counted_names) {
  EXPECT_EQ(encode_tags({"E2"}), bytes("00000001 00000001 00000000 00000002 00000002 45320000"));
  EXPECT_EQ(encode_tags({}), bytes("00000000 00000000"));
  EXPECT_EQ(encode_links({{"a", "lab", 2442, -40}}),
            bytes("00000001 00000001  00000002 00000002 61000000  00000001 00000001 00000000  00000004 00000004 6c616200 "
                  "00000003 0000098a 00000000 000000d8 000000d8 00000000 "
                  "00000000 00000000 00000003 00000001 00000000 00000000 00000000  00000002 00000002 61000000"));
}

TEST(PlayerPayload, hypotheses_have_their_covariances_in_the_order_of_the_wire) {
  Hypothesis one{{1, 2, 0}, {1, 2, 3, 4, 5, 6}, 0.5};
  EXPECT_EQ(
      encode_hypotheses(0, {one}),
      bytes("00000000 0000000000000000 00000001 00000001 3ff0000000000000 4000000000000000 0000000000000000 "
            "3ff0000000000000 4000000000000000 4008000000000000 4010000000000000 4014000000000000 4018000000000000 3fe0000000000000"));
  EXPECT_EQ(encode_particles({one}), bytes("3ff0000000000000 4000000000000000 0000000000000000 3ff0000000000000 00000001 00000001 "
                                           "3ff0000000000000 4000000000000000 0000000000000000 3fe0000000000000"));
}

TEST(PlayerAddress, names_and_codes) {
  EXPECT_EQ(to_text(Address{Interface::ranger, 1}), "ranger:1");
  EXPECT_EQ(to_text(Address{static_cast<Interface>(7), 0}), "blobfinder:0");
  EXPECT_EQ(to_text(Address{static_cast<Interface>(67), 0}), "67:0");
  EXPECT_EQ(any_name(static_cast<Interface>(66)), "coopobject");
  EXPECT_EQ(any_name(Interface::ranger), "ranger");
  EXPECT_EQ(parse_interface("position2d"), Interface::position2d);
  EXPECT_EQ(parse_interface("truth"), std::nullopt);
}

}  // namespace
}  // namespace player
