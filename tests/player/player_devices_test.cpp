// What devices of Player show of ifaces: parts of scans, depths and points, and the table of what is served, which is also in the docs.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <sstream>

#include "camera_device.h"
#include "device_kinds.h"
#include "map_device.h"
#include "point_cloud_device.h"
#include "scan_settings.h"
#include "support/paths.h"

namespace gateway {
namespace {

constexpr double pi = 3.14159265358979323846;

shm::LaserInfo sick() {
  shm::LaserInfo info{};
  info.beams = 181;
  info.layers = 1;
  info.min_angle = -pi / 2;
  info.max_angle = pi / 2;
  info.angle_step = pi / 180;
  info.min_range = 0.1;
  info.max_range = 8;
  info.range_step = 0.01;
  info.rate = 10;
  return info;
}

std::vector<float> numbered(std::size_t count) {
  std::vector<float> values;
  for (std::size_t i = 0; i < count; ++i) values.push_back(static_cast<float>(i) / 25);
  return values;
}

TEST(ScanFilter, shows_all_until_something_is_chosen) {
  const auto info = sick();
  ScanFilter filter(info);
  const auto all = numbered(181);
  EXPECT_EQ(filter.values(all), all);
  EXPECT_EQ(filter.ranges(all)[0], 0.1F);
  EXPECT_EQ(filter.ranges(all)[100], all[100]);
  EXPECT_EQ(filter.settings().max_angle, info.max_angle);
  // Zeros leave everything as it is.
  const auto same = ScanFilter::choose(info, {});
  ASSERT_TRUE(same);
  EXPECT_EQ(same->values(all), all);
}

TEST(ScanFilter, shows_a_part_of_the_angles_and_every_second_beam) {
  auto filter = ScanFilter::choose(sick(), {.min_angle = -pi / 4, .max_angle = pi / 4, .resolution = static_cast<float>(pi / 90)});
  ASSERT_TRUE(filter);
  const auto all = numbered(181);
  const auto shown = filter->values(all);
  ASSERT_EQ(shown.size(), 46U);
  EXPECT_EQ(shown.front(), all[45]);
  EXPECT_EQ(shown[1], all[47]);
  EXPECT_EQ(shown.back(), all[135]);
  EXPECT_NEAR(filter->settings().min_angle, -pi / 4, 1e-9);
  EXPECT_NEAR(filter->settings().max_angle, pi / 4, 1e-9);
  EXPECT_NEAR(filter->settings().resolution, pi / 90, 1e-9);
}

TEST(ScanFilter, says_what_it_made_of_angles_between_beams) {
  const auto filter = ScanFilter::choose(sick(), {.min_angle = -0.5, .max_angle = 0.51});
  ASSERT_TRUE(filter);
  EXPECT_NEAR(filter->settings().min_angle, -29 * pi / 180, 1e-9);
  EXPECT_NEAR(filter->settings().max_angle, 29 * pi / 180, 1e-9);
}

TEST(ScanFilter, lower_rates_leave_out_whole_scans) {
  auto filter = ScanFilter::choose(sick(), {.rate = 5});
  ASSERT_TRUE(filter);
  int shown = 0;
  for (std::uint64_t sequence = 1; sequence <= 20; ++sequence) shown += filter->is_due(sequence) ? 1 : 0;
  EXPECT_NEAR(shown, 10, 1);
  EXPECT_EQ(filter->settings().rate, 5);
  // One between two that can be had is the faster one.
  EXPECT_EQ(ScanFilter::choose(sick(), {.rate = 4})->settings().rate, 5);
  // Scans that were never seen do not make it slower.
  ASSERT_TRUE(filter->is_due(100));
  EXPECT_TRUE(filter->is_due(103));
}

TEST(ScanFilter, coarser_ranges_are_rounded_and_never_beyond_the_limit) {
  const auto filter = ScanFilter::choose(sick(), {.range_resolution = 0.3});
  ASSERT_TRUE(filter);
  const auto ranges = filter->ranges(std::vector<float>{1.0F, 1.1F, std::numeric_limits<float>::infinity(), NAN});
  EXPECT_NEAR(ranges[0], 0.9, 1e-6);
  EXPECT_NEAR(ranges[1], 1.2, 1e-6);
  EXPECT_EQ(ranges[2], 8.0F);
  EXPECT_EQ(ranges[3], 8.0F);
}

TEST(ScanFilter, what_the_scanner_cannot_do_is_refused) {
  const auto info = sick();
  for (const ScanSettings& wrong :
       {ScanSettings{.min_angle = -2, .max_angle = 1}, ScanSettings{.min_angle = -1, .max_angle = 2},
        ScanSettings{.min_angle = 1, .max_angle = -1}, ScanSettings{.resolution = pi / 360}, ScanSettings{.resolution = pi / 120},
        ScanSettings{.resolution = -pi / 180}, ScanSettings{.rate = 20}, ScanSettings{.rate = -1}, ScanSettings{.range_resolution = 0.001},
        ScanSettings{.range_resolution = -1}, ScanSettings{.max_range = 9}, ScanSettings{.min_range = 0.01}, ScanSettings{.rate = NAN},
        ScanSettings{.min_range = 5, .max_range = 3}, ScanSettings{.max_angle = INFINITY}}) {
    EXPECT_FALSE(ScanFilter::choose(info, wrong))
        << wrong.min_angle << ' ' << wrong.max_angle << ' ' << wrong.resolution << ' ' << wrong.min_range << ' ' << wrong.max_range << ' '
        << wrong.range_resolution << ' ' << wrong.rate;
  }
}

TEST(ScanFilter, scanner_without_beams_has_none_to_show) {
  auto info = sick();
  info.beams = 0;
  const auto filter = ScanFilter::choose(info, {.resolution = pi / 90});
  ASSERT_TRUE(filter);
  EXPECT_TRUE(filter->values({}).empty());
}

// ---- depths and points ----

shm::FrameHead head_of(shm::Format format, std::uint32_t width, std::uint32_t height) {
  shm::FrameHead head{};
  head.width = width;
  head.height = height;
  head.format = static_cast<std::uint32_t>(format);
  head.stride = width * shm::bytes_per_pixel(format);
  return head;
}

TEST(ToImage, depths_are_millimetres_with_the_high_byte_first) {
  const std::vector<float> depths{1.0F, 0.2564F, std::numeric_limits<float>::infinity(), NAN, 65.535F, 65.6F};
  const auto image = to_image(head_of(shm::Format::depth_float, 3, 2), std::as_bytes(std::span(depths)));
  ASSERT_TRUE(image);
  EXPECT_EQ(image->format, player::ImageFormat::mono16);
  EXPECT_EQ(image->bits, 16U);
  EXPECT_EQ(image->pixels, std::string("\x03\xe8\x01\x00\x00\x00\x00\x00\xff\xff\x00\x00", 12));
}

std::string places(const std::vector<player::Point3d>& points) {
  std::ostringstream text;
  for (const auto& p : points) text << p.x << ' ' << p.y << ' ' << p.z << '\n';
  return text.str();
}

TEST(ToPoints, depths_become_places_before_the_camera) {
  shm::CameraInfo info{};
  info.fx = info.fy = 2;
  info.cx = info.cy = 1;
  const std::vector<float> depths{4, 4, std::numeric_limits<float>::infinity(), 8};
  const auto points = to_points(head_of(shm::Format::depth_float, 2, 2), info, std::as_bytes(std::span(depths)), 100);
  // The first pixel is left and above, the last right and below.
  EXPECT_EQ(places(points), "4 1 1\n4 -1 1\n8 -2 -2\n");
  info.fx = 0;
  EXPECT_TRUE(to_points(head_of(shm::Format::depth_float, 2, 2), info, std::as_bytes(std::span(depths)), 100).empty());
}

TEST(ToPoints, places_that_hit_nothing_are_left_out) {
  const std::vector<float> values{1, 2, 3, 9, NAN, NAN, NAN, 0, 4, 5, 6, 9};
  EXPECT_EQ(places(to_points(head_of(shm::Format::points_intensity_float, 3, 1), {}, std::as_bytes(std::span(values)), 100)),
            "1 2 3\n4 5 6\n");
  EXPECT_EQ(places(to_points(head_of(shm::Format::points_float, 4, 1), {}, std::as_bytes(std::span(values)), 100)), "1 2 3\n5 6 9\n");
}

TEST(ToPoints, clouds_that_are_too_large_are_thinned_evenly) {
  const std::vector<float> depths(100 * 60, 1.0F);
  shm::CameraInfo info{};
  info.fx = info.fy = 100;
  const auto points = to_points(head_of(shm::Format::depth_float, 100, 60), info, std::as_bytes(std::span(depths)), 1500);
  EXPECT_EQ(points.size(), 1500U);
  EXPECT_TRUE(to_points(head_of(shm::Format::depth_float, 100, 60), info, std::as_bytes(std::span(depths)), 0).empty());
}

TEST(ToPoints, frames_that_are_none_or_too_short_have_no_places) {
  const std::vector<float> values(12, 1.0F);
  EXPECT_TRUE(to_points(head_of(shm::Format::rgb8, 2, 2), {}, std::as_bytes(std::span(values)), 100).empty());
  EXPECT_TRUE(to_points(head_of(shm::Format::points_float, 5, 1), {}, std::as_bytes(std::span(values)), 100).empty());
  EXPECT_TRUE(to_points(head_of(shm::Format::points_float, 0, 1), {}, std::as_bytes(std::span(values)), 100).empty());
}

// ---- map ----

TEST(Map, tiles_begin_at_the_lowest_row_and_are_wholly_in_the_map) {
  shm::WorldMap map;
  map.area.width = 3;
  map.area.height = 2;
  map.pixels = {0, 205, 254, 254, 254, 0};
  EXPECT_EQ(map_cells(map, {0, 0, 3, 2}), std::string("\xff\xff\1\1\0\xff", 6));
  EXPECT_EQ(map_cells(map, {1, 1, 2, 1}), std::string("\0\xff", 2));
  EXPECT_EQ(map_cells(map, {1, 0, 3, 1}), "");
  EXPECT_EQ(map_cells(map, {0, 0, 3, 0xffffffff}), "");
  EXPECT_EQ(map_cells(map, {0, 0, 0, 0}), "");
}

// ---- what is served ----

TEST(DeviceKinds, capabilities_follow_from_the_table_of_each_device) {
  const auto table = find_kind(player::Interface::position2d)->served;
  EXPECT_TRUE(is_served(table, 2, 2));
  EXPECT_FALSE(is_served(table, 2, 5));
  EXPECT_FALSE(is_served(table, 0x102, 2));
  EXPECT_FALSE(is_served(table, 2, 0x102));
  EXPECT_EQ(find_kind(player::Interface::player), nullptr);
}

TEST(DeviceKinds, each_type_of_iface_but_truth_reaches_a_client) {
  for (const shm::IfaceRow& row : shm::iface_types) {
    EXPECT_EQ(interfaces_for(row.type).empty(), row.type == shm::IfaceType::truth) << row.name;
  }
}

TEST(DeviceKinds, each_has_a_name_and_no_message_twice) {
  for (const DeviceKind& kind : device_kinds()) {
    EXPECT_EQ(player::parse_interface(player::to_text(kind.interface)), kind.interface);
    for (const Served& one : kind.served) {
      const auto same = [&](const Served& other) { return other.type == one.type && other.subtype == one.subtype; };
      EXPECT_EQ(std::count_if(kind.served.begin(), kind.served.end(), same), 1)
          << player::to_text(kind.interface) << ' ' << static_cast<int>(one.subtype);
    }
  }
}

// Regenerated by `player-gateway --interfaces`.
TEST(DeviceKinds, the_page_shows_the_table) {
  std::ifstream file(std::string(paths::source_dir) + "/docs/player.md");
  std::stringstream page;
  page << file.rdbuf();
  EXPECT_NE(page.str().find(interface_table()), std::string::npos) << interface_table();
}

}  // namespace
}  // namespace gateway
