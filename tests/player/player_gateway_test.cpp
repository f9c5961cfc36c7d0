// What waits for a client, time as clients want it, and which port shows what.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "camera_device.h"
#include "device.h"
#include "mapping.h"
#include "outbox.h"
#include "sensor_devices.h"
#include "timeline.h"

namespace gateway {
namespace {

using player::Address;
using player::DataMode;
using player::Interface;

const Address laser{Interface::laser, 0}, drive{Interface::position2d, 0};

SharedBytes shared(std::string text) { return std::make_shared<const std::string>(std::move(text)); }

// All that would be sent; a synch message is "S".
std::string sent(Outbox& outbox) {
  std::string all;
  for (const auto& piece : outbox.pieces()) {
    const auto rest = piece.bytes->substr(piece.sent);
    all += rest.size() == player::header_size ? "S" : rest;
  }
  outbox.sent(outbox.size());
  return all;
}

class Pull : public testing::Test {
 protected:
  Pull() { outbox.set_mode(DataMode::pull); }
  std::string flushed() {
    outbox.flush(1.0);
    return sent(outbox);
  }
  Outbox outbox{6665};
};

TEST_F(Pull, data_waits_for_the_request_and_ends_with_one_synch) {
  outbox.deliver(laser, 1, shared("l1"));
  outbox.deliver(drive, 1, shared("d1"));
  EXPECT_EQ(flushed(), "");
  outbox.ask_for_data();
  outbox.ask_for_data();
  EXPECT_EQ(flushed(), "l1d1S");
  outbox.deliver(laser, 1, shared("l2"));
  EXPECT_EQ(flushed(), "");
}

TEST_F(Pull, there_is_no_synch_without_data) {
  outbox.ask_for_data();
  EXPECT_EQ(flushed(), "");
  outbox.deliver(laser, 1, shared("l1"));
  EXPECT_EQ(flushed(), "l1S");
}

TEST_F(Pull, the_newest_replaces_the_one_before_and_comes_last) {
  outbox.deliver(laser, 1, shared("l1"));
  outbox.deliver(laser, 2, shared("pose"));
  outbox.deliver(drive, 1, shared("d1"));
  outbox.deliver(laser, 1, shared("l2"));
  outbox.ask_for_data();
  EXPECT_EQ(flushed(), "posed1l2S");
}

TEST_F(Pull, a_rule_keeps_all_up_to_a_bound) {
  EXPECT_TRUE(outbox.add_rule({.replace = 0}));
  for (std::size_t i = 0; i < Outbox::max_kept + 3; ++i) outbox.deliver(laser, 1, shared(std::to_string(i) + " "));
  outbox.ask_for_data();
  const auto all = flushed();
  EXPECT_TRUE(all.starts_with("3 4 5 ")) << all;
  EXPECT_TRUE(all.ends_with("66 S")) << all;
}

TEST_F(Pull, the_first_rule_that_fits_counts_and_the_same_criteria_overwrite) {
  EXPECT_TRUE(outbox.add_rule({.interface = 6, .replace = 2}));
  EXPECT_TRUE(outbox.add_rule({.replace = 0}));
  for (const char* text : {"1", "2"}) {
    outbox.deliver(laser, 1, shared(std::string("l") + text));
    outbox.deliver(drive, 1, shared(std::string("d") + text));
  }
  outbox.ask_for_data();
  EXPECT_EQ(flushed(), "d1d2S");
  EXPECT_TRUE(outbox.add_rule({.interface = 6, .replace = 1}));
  outbox.deliver(laser, 1, shared("l3"));
  outbox.ask_for_data();
  EXPECT_EQ(flushed(), "l3S");
  EXPECT_FALSE(outbox.add_rule({.replace = 7}));
  EXPECT_FALSE(outbox.add_rule({.replace = -1}));
}

TEST_F(Pull, rules_without_end_are_refused) {
  std::int32_t index = 0;
  while (outbox.add_rule({.index = index, .replace = 1})) ASSERT_LT(++index, 100000);
  EXPECT_EQ(index, static_cast<std::int32_t>(Outbox::max_rules));
}

TEST_F(Pull, nothing_comes_of_a_device_that_was_let_go) {
  outbox.deliver(laser, 1, shared("l1"));
  outbox.forget(laser);
  outbox.ask_for_data();
  EXPECT_EQ(flushed(), "");
}

TEST(Push, data_goes_at_once_and_is_replaced_while_the_socket_is_full) {
  Outbox outbox(6665);
  outbox.deliver(laser, 1, shared("l1"));
  outbox.flush(1.0);
  for (const char* text : {"l2", "l3", "l4"}) {
    outbox.deliver(laser, 1, shared(text));
    outbox.flush(1.0);
  }
  EXPECT_EQ(outbox.size(), 2U);
  outbox.sent(1);
  EXPECT_EQ(sent(outbox), "1");
  outbox.flush(1.0);
  EXPECT_EQ(sent(outbox), "l4");
}

TEST(Timeline, goes_on_after_resets_and_new_servers) {
  Timeline time;
  EXPECT_EQ(time.at(1, 0, 2'000'000'000), 2.0);
  EXPECT_EQ(time.at(1, 0, 5'000'000'000), 5.0);
  EXPECT_EQ(time.at(1, 1, 100'000'000), 5.1);             // reset
  EXPECT_EQ(time.at(1, 0, 5'100'000'000), std::nullopt);  // from before
  EXPECT_EQ(time.at(2, 0, 1'000'000'000), 6.1);           // another simulator
  EXPECT_EQ(time.latest(), 6.1);
}

TEST(SeenRange, is_never_what_ends_a_client) {
  const float inf = std::numeric_limits<float>::infinity();
  EXPECT_EQ(seen_range(std::numeric_limits<float>::quiet_NaN(), 0.1, 8), 8);
  EXPECT_EQ(seen_range(inf, 0.1, 8), 8);
  EXPECT_EQ(seen_range(-inf, 0.1, 8), 0.1);
  EXPECT_EQ(seen_range(-1, 0, 8), 0);
  EXPECT_EQ(seen_range(3, 0.1, 8), 3);
}

std::optional<player::Image> image_of(shm::Format format, std::uint32_t width, std::uint32_t height, std::uint32_t stride,
                                      std::string_view data) {
  shm::FrameHead head{};
  head.width = width;
  head.height = height;
  head.format = static_cast<std::uint32_t>(format);
  head.stride = stride;
  return to_image(head, std::as_bytes(std::span(data)));
}

TEST(ToImage, colours_have_the_order_of_player_and_no_gaps) {
  const auto pixels = [](shm::Format format, std::uint32_t stride, std::string_view data) {
    const auto image = image_of(format, 2, 2, stride, data);
    EXPECT_TRUE(image && image->bits == 24 && image->format == player::ImageFormat::rgb888);
    return image ? image->pixels : std::string();
  };
  EXPECT_EQ(pixels(shm::Format::rgb8, 6, "rgbRGB123456"), "rgbRGB123456");
  EXPECT_EQ(pixels(shm::Format::rgb8, 8, "rgbRGB..123456.."), "rgbRGB123456");
  EXPECT_EQ(pixels(shm::Format::bgr8, 6, "bgrBGR321654"), "rgbRGB123456");
  EXPECT_EQ(pixels(shm::Format::rgba8, 8, "rgb.RGB.123.456."), "rgbRGB123456");
  EXPECT_EQ(pixels(shm::Format::bgra8, 8, "bgr.BGR.321.654."), "rgbRGB123456");
  EXPECT_EQ(pixels(shm::Format::bayer_rggb8, 2, "7777"), "777777777777");
}

TEST(ToImage, grey_of_16_bits_has_the_high_byte_first) {
  const auto wide = image_of(shm::Format::mono16, 2, 1, 4, "lhLH");
  ASSERT_TRUE(wide);
  EXPECT_EQ(wide->pixels, "hlHL");
  EXPECT_EQ(wide->bits, 16U);
  const auto narrow = image_of(shm::Format::mono8, 2, 2, 3, "ab.cd.");
  ASSERT_TRUE(narrow);
  EXPECT_EQ(narrow->pixels, "abcd");
}

TEST(ToImage, frame_that_is_no_picture_or_too_short_is_none) {
  EXPECT_FALSE(image_of(shm::Format::points_float, 1, 1, 12, "abcdefghijkl"));
  EXPECT_FALSE(image_of(shm::Format::rgb8, 2, 2, 6, "rgbRGB"));
  EXPECT_FALSE(image_of(shm::Format::rgb8, 2, 2, 3, "rgbRGB123456"));
  EXPECT_FALSE(image_of(shm::Format::rgb8, 0, 2, 0, ""));
  EXPECT_FALSE(image_of(static_cast<shm::Format>(99), 1, 1, 4, "abcd"));
}

// On the central meridian of a zone the easting is 500 km, and at the equator the northing is 0; the quarter of the meridian is
// 10001965.729 m.
TEST(Utm, known_places) {
  constexpr double degree = 3.14159265358979323846 / 180;
  EXPECT_NEAR(to_utm(0, 9 * degree).east, 500000, 1e-6);
  EXPECT_NEAR(to_utm(0, 9 * degree).north, 0, 1e-6);
  EXPECT_NEAR(to_utm(90 * degree, 9 * degree).north, 0.9996 * 10001965.729, 0.01);
  EXPECT_NEAR(to_utm(0, 12 * degree - 1e-12).east, 833978.557, 0.01);  // the edge of zone 32
  EXPECT_NEAR(to_utm(-1e-9, 9 * degree).north, 10000000, 0.01);
}

const std::vector<ListedIface> world = {{shm::IfaceType::truth, "box", "box"},
                                        {shm::IfaceType::laser, "b::front", "b"},
                                        {shm::IfaceType::laser, "b::rear", "b"},
                                        {shm::IfaceType::sonar, "b::sonar", "b"},
                                        {shm::IfaceType::position2d, "b::drive", "b"},
                                        {shm::IfaceType::position2d, "a::drive", "a"},
                                        {shm::IfaceType::camera, "a::arm::camera", "a::arm"}};

std::string shown(const PortPlan& plan) {
  std::string text = std::to_string(plan.port) + " " + plan.name + ":";
  for (const auto& device : plan.devices) text += " " + player::to_text(device.address) + "=" + device.iface;
  return text;
}

TEST(Mapping, each_robot_has_a_port_in_world_order) {
  const auto plans = plan_by_world(world, 6665);
  ASSERT_EQ(plans.size(), 2U);
  EXPECT_EQ(shown(plans[0]),
            "6665 b: position2d:0=b::drive laser:0=b::front laser:1=b::rear sonar:0=b::sonar ranger:0=b::front ranger:1=b::rear "
            "ranger:2=b::sonar simulation:0=world");
  EXPECT_EQ(shown(plans[1]), "6666 a: position2d:0=a::drive camera:0=a::arm::camera blobfinder:0=a::arm::camera simulation:0=world");
}

std::string with_fields(const PortPlan& plan) {
  std::string text;
  for (const auto& device : plan.devices)
    text += player::to_text(device.address) + "=" + device.iface + (device.companion.empty() ? " " : "+" + device.companion + " ");
  return text;
}

TEST(Mapping, magnetometers_are_part_of_imus_and_depth_cameras_are_shown_once) {
  using enum shm::IfaceType;
  std::vector<ListedIface> ifaces;
  for (const auto& [type, name] : {std::pair(magnetometer, "m1"),
                                   {magnetometer, "m2"},
                                   {magnetometer, "m3"},
                                   {imu, "i1"},
                                   {imu, "i2"},
                                   {depth, "rgbd"},
                                   {points, "rgbd"},
                                   {camera, "rgbd"},
                                   {depth, "d"},
                                   {air_pressure, "p"},
                                   {altimeter, "a"},
                                   {force_torque, "f"}})
    ifaces.push_back({type, name, "r"});
  EXPECT_EQ(with_fields(plan_by_world(ifaces, 0)[0]),
            "camera:0=rgbd camera:1=rgbd camera:2=d imu:0=i1+m1 imu:1=i2+m2 imu:2=m3 aio:0=a aio:1=p aio:2=f pointcloud3d:0=rgbd "
            "pointcloud3d:1=d blobfinder:0=rgbd simulation:0=world ");
}

TEST(Mapping, world_without_robots_has_one_port) {
  const auto plans = plan_by_world({}, 7000);
  ASSERT_EQ(plans.size(), 1U);
  EXPECT_EQ(shown(plans[0]), "7000 no robot: simulation:0=world");
}

TEST(Mapping, robots_keep_their_ports_while_others_come_and_go) {
  const auto names = [](const std::vector<PortPlan>& plans) {
    std::string text;
    for (const auto& plan : plans) text += std::to_string(plan.port) + " " + plan.name + (plan.devices.empty() ? " - " : " ");
    return text;
  };
  const auto with = [&](std::vector<std::string> robots) {
    std::vector<ListedIface> ifaces;
    for (const auto& robot : robots) ifaces.push_back({shm::IfaceType::laser, robot + "::laser", robot});
    return plan_by_world(ifaces, 7000);
  };
  EXPECT_EQ(names(keep_ports(with({"b", "c"}), {"a", "b"}, 7000)), "0 a - 7000 b 7002 c ");  // the numbers of open ports mean nothing
  EXPECT_EQ(names(keep_ports(with({"a", "b"}), {"a", "b"}, 7000)), "7000 a 7001 b ");
  EXPECT_EQ(names(keep_ports(with({}), {"a"}, 7000)), "0 a - ");
  EXPECT_EQ(names(keep_ports(with({"a", "b"}), {std::string(no_robot)}, 7000)), "7000 a 7001 b ");
}

class MappingFile : public testing::Test {
 protected:
  ~MappingFile() override { std::filesystem::remove(path); }
  base::Result<std::vector<ConfiguredPort>> read(const std::string& text) {
    std::ofstream(path) << text;
    return read_config(path);
  }
  const std::string path = testing::TempDir() + "mapping_" + std::to_string(getpid()) + ".yaml";
};

TEST_F(MappingFile, names_robots_and_devices) {
  const auto ports =
      read("ports:\n- port: 7000\n  robots: [b, a]\n- port: 0\n  devices:\n    laser:3: b::rear\n    ranger:0: sonar:b::sonar\n");
  ASSERT_TRUE(ports) << ports.error().message;
  std::vector<std::string> missing;
  const auto plans = plan_by_config(*ports, world, missing);
  ASSERT_EQ(plans.size(), 2U);
  EXPECT_EQ(shown(plans[0]),
            "7000 b a: position2d:0=b::drive laser:0=b::front laser:1=b::rear sonar:0=b::sonar ranger:0=b::front ranger:1=b::rear "
            "ranger:2=b::sonar position2d:1=a::drive camera:0=a::arm::camera blobfinder:0=a::arm::camera simulation:0=world");
  EXPECT_EQ(shown(plans[1]), "0 : laser:3=b::rear ranger:0=b::sonar simulation:0=world");
  EXPECT_TRUE(missing.empty());
}

TEST_F(MappingFile, an_imu_may_have_a_magnetometer) {
  const std::vector<ListedIface> ifaces{{shm::IfaceType::imu, "b::imu", "b"}, {shm::IfaceType::magnetometer, "b::field", "b"}};
  const auto ports = read("ports:\n- port: 7000\n  devices:\n    imu:0: [b::imu, b::field]\n    imu:1: [b::imu, b::none]\n");
  ASSERT_TRUE(ports) << ports.error().message;
  std::vector<std::string> missing;
  EXPECT_EQ(with_fields(plan_by_config(*ports, ifaces, missing)[0]), "imu:0=b::imu+b::field imu:1=b::imu+b::none simulation:0=world ");
  EXPECT_EQ(missing, std::vector<std::string>{"imu:1 of port 7000: no magnetometer \"b::none\""});
}

TEST_F(MappingFile, what_is_not_in_the_world_is_named) {
  const auto ports = read(
      "ports:\n- port: 7000\n  robots: [c]\n  devices: {laser:0: b::drive, camera:0: a::arm::camara, camera:1: 'depth:a::arm::camera', "
      "'stereo:0': [a::arm::camera, b::front]}\n");
  ASSERT_TRUE(ports) << ports.error().message;
  std::vector<std::string> missing;
  EXPECT_EQ(shown(plan_by_config(*ports, world, missing)[0]), "7000 c: stereo:0=a::arm::camera simulation:0=world");
  EXPECT_EQ(missing, (std::vector<std::string>{"laser:0 of port 7000: iface \"b::drive\" is of type position2d; expected laser",
                                               "camera:0 of port 7000: no iface \"a::arm::camara\"; did you mean a::arm::camera?",
                                               "camera:1 of port 7000: iface \"a::arm::camera\" is of type camera; expected depth",
                                               "stereo:0 of port 7000: iface \"b::front\" is of type laser; expected camera",
                                               "port 7000: no robot \"c\""}));
}

TEST_F(MappingFile, errors_say_where) {
  const auto error = [&](const std::string& text) {
    const auto ports = read(text);
    return ports ? std::string("accepted") : ports.error().message.substr(path.size());
  };
  EXPECT_EQ(error("ports:\n- port: 70000\n"), ":2: port must be a number from 0 to 65535, got \"70000\"");
  EXPECT_EQ(error("ports:\n- port: 1\n- port: 1\n"), ":3: port 1 appears twice");
  EXPECT_EQ(error("ports:\n- robots: [a]\n"), ":2: port is missing");
  EXPECT_EQ(error("ports:\n- port: 1\n  devices:\n    lazer:0: x\n"), ":4: \"lazer\" is no interface of Player; did you mean laser?");
  EXPECT_EQ(error("ports:\n- port: 1\n  devices:\n    Position2D:0: x\n"),
            ":4: \"Position2D\" is no interface of Player; did you mean position2d?");
  EXPECT_EQ(error("ports:\n- port: 1\n  devices:\n    stereo:0: x\n"),
            ":4: stereo: expected a left and a right camera, as in [mast::eyes::left, mast::eyes::right]");
  EXPECT_EQ(error("ports:\n- port: 1\n  devices:\n    audio:0: x\n").substr(0, 78),
            ":4: \"audio\" is an interface of Player that is not served here; served are posi");
  EXPECT_EQ(error("ports:\n- port: 1\n  devices:\n    colour:0: x\n").substr(0, 66),
            ":4: \"colour\" is no interface of Player; expected one of position2d");
  EXPECT_EQ(error("ports:\n- port: 1\n  devices:\n    laser:x: x\n"), ":4: expected INTERFACE:INDEX as in laser:0, got \"laser:x\"");
  EXPECT_EQ(error("ports:\n- port: 1\n  devices:\n    laser:0: [a, b]\n"), ":4: expected the name of an iface");
  EXPECT_EQ(error("ports:\n- port: 1\n  devices:\n    laser:0: sonar:x\n"), ":4: laser:0 can't show an iface of type \"sonar\"");
  EXPECT_EQ(error("ports:\n- port: 1\n  colour: red\n"), ":3: expected port, robots or devices, got \"colour\"");
  EXPECT_EQ(error("ports:\n- port: 1\n  robots: [a]\n  robots: [b]\n"), ":4: the key \"robots\" appears twice");
  EXPECT_EQ(error("port: 1\n"), ":1: expected a list called ports and nothing else");
  EXPECT_EQ(error("ports: []\n"), ":1: there is no port");
  EXPECT_NE(error("ports: [\n").find(":"), std::string::npos);
  EXPECT_NE(error("").find("expected a list"), std::string::npos);
  EXPECT_NE(error("# of a robot\ndriver\n(\n  name \"stage\"\n)\n").find("no driver provides a device of a simulator"), std::string::npos);
  EXPECT_EQ(read_config("/nowhere/at/all.yaml").error().message,
            "mapping \"/nowhere/at/all.yaml\": no such file; there is no folder \"/nowhere/at\"");
  EXPECT_EQ(read_config("/").error().message, "mapping \"/\": is a folder; a file is expected");
}

TEST(List, that_cannot_be_read_is_an_error) {
  EXPECT_FALSE(parse_list("no json"));
  EXPECT_FALSE(parse_list("[]"));
  EXPECT_FALSE(parse_list("{}"));
  const auto list =
      parse_list(R"({"ifaces": [{"type": "laser", "name": "a::l", "model": "a"}, {"type": "warp", "name": "x", "model": "a"}]})");
  ASSERT_TRUE(list);
  ASSERT_EQ(list->size(), 1U);
  EXPECT_EQ((*list)[0].name, "a::l");
}

TEST(List, groups_of_joints_are_devices_and_joints_without_a_group_are_none) {
  const auto list = parse_list(R"({"ifaces": [
    {"type": "joints", "name": "arm::joints", "model": "arm", "groups": [{"kind": "array", "joints": ["a", "b"]}, {"kind": "chain", "joints": ["a", "b"]}, {"kind": "gripper", "joints": ["f"]},
      {"kind": "gripper", "joints": ["g"]}, {"kind": "tail", "joints": ["t"]}]},
    {"type": "joints", "name": "eye::joints", "model": "eye", "groups": [{"kind": "pan_tilt", "joints": ["p", "t"], "field_of_view": 1.25}]},
    {"type": "joints", "name": "door::joints", "model": "door", "groups": []}]})");
  ASSERT_TRUE(list);
  const auto plans = plan_by_world(*list, 7000);
  ASSERT_EQ(plans.size(), 2U) << "a door is no robot";
  EXPECT_EQ(shown(plans[0]),
            "7000 arm: actarray:0=arm::joints limb:0=arm::joints gripper:0=arm::joints gripper:1=arm::joints simulation:0=world");
  EXPECT_EQ(plans[0].devices[0].group.joints, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(plans[0].devices[3].group.joints, std::vector<std::string>{"g"});
  EXPECT_EQ(shown(plans[1]), "7001 eye: ptz:0=eye::joints simulation:0=world");
  EXPECT_EQ(plans[1].devices[0].group.field_of_view, 1.25);
}

TEST_F(MappingFile, joints_are_those_that_are_named_or_listed_or_all) {
  std::vector<ListedIface> ifaces{{shm::IfaceType::joints, "arm::joints", "arm"}};
  ifaces[0].groups = {{player::Interface::ptz, {"p", "t"}, 1.5}};
  const auto ports =
      read("ports:\n- port: 7000\n  devices:\n    actarray:0: [arm::joints, a, b]\n    ptz:0: arm::joints\n    actarray:1: arm::joints\n");
  ASSERT_TRUE(ports) << ports.error().message;
  std::vector<std::string> missing;
  const auto devices = plan_by_config(*ports, ifaces, missing)[0].devices;
  ASSERT_EQ(devices.size(), 4U);
  EXPECT_EQ(devices[0].group.joints, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(devices[1].group.joints, (std::vector<std::string>{"p", "t"}));
  EXPECT_EQ(devices[1].group.field_of_view, 1.5);
  EXPECT_TRUE(devices[2].group.joints.empty()) << "all";
}

}  // namespace
}  // namespace gateway
