#include <gtest/gtest.h>
#include <sys/stat.h>

#include <array>
#include <cmath>
#include <thread>

#include "shm/futex.h"
#include "shm/shm_support.h"
#include "shm/words.h"

namespace shm::test {
namespace {

TEST(SegmentName, the_text_of_a_name_reads_back_as_the_same_name) {
  const SegmentName name{1000, 7, IfaceType::laser, "pioneer2dx::front.laser"};
  EXPECT_EQ(name.text(), "rtmsim-1000-7.laser.pioneer2dx::front.laser");
  EXPECT_EQ(SegmentName::parse(name.text()), name);
}

TEST(SegmentName, texts_of_other_things_are_no_names) {
  for (const char* text : {"", "rtmsim-", "rtmsim-1-2", "rtmsim-1-2.laser", "rtmsim-1-2.laser.", "rtmsim-1-2.toaster.x",
                           "rtmsim-a-2.laser.x", "rtmsim-1-99999999999.laser.x", "other-1-2.laser.x"}) {
    EXPECT_FALSE(SegmentName::parse(text)) << text;
  }
}

TEST(SegmentName, names_that_no_file_can_have_are_refused_with_the_reason) {
  EXPECT_EQ(check_name("a/b").error().message, "iface name \"a/b\" holds '/', which no iface name can");
  EXPECT_FALSE(check_name(""));
  EXPECT_FALSE(check_name(std::string(201, 'x')));
  EXPECT_FALSE(check_name("a\nb"));
  EXPECT_TRUE(check_name(std::string(200, 'x')));
  EXPECT_TRUE(check_name("pioneer2dx::laser"));
}

TEST(Iface, samples_are_read_one_after_the_other_as_long_as_the_memory_has_them) {
  Fixture f;
  auto writer = f.make(iface_spec(IfaceType::position2d, "robot::base", Position2dInfo{}));
  auto reader = f.open(IfaceType::position2d, "robot::base");
  const auto cells = reader.segment().area(AreaIndex::cells).count;
  ASSERT_GE(cells, 10U);
  EXPECT_FALSE(reader.read_after(0));
  for (int i = 1; i <= 5; ++i) writer->publish(std::chrono::milliseconds(i));
  for (std::uint64_t than = 0; than < 5; ++than) {
    ASSERT_TRUE(reader.read_after(than));
    EXPECT_EQ(reader.sample<Stamp>().sequence, than + 1);
  }
  EXPECT_FALSE(reader.read_after(5));
  for (std::uint64_t i = 6; i <= 2 * cells; ++i) writer->publish(std::chrono::milliseconds(i));
  ASSERT_TRUE(reader.read_after(5));
  EXPECT_EQ(reader.sample<Stamp>().sequence, cells + 1);  // the oldest that is left
}

TEST(Iface, an_older_simulator_gives_a_drive_without_a_wheel_base) {
  Fixture f;
  Position2dInfo info{};
  info.wheel_radius = 0.1;
  info.wheel_base = 9;
  IfaceSpec spec = iface_spec(IfaceType::position2d, "robot::base", info);
  spec.info.resize(row_of(IfaceType::position2d).oldest_info_size);
  spec.geometry.info_size = spec.info.size();
  auto writer = f.make(spec);
  auto reader = f.open(IfaceType::position2d, "robot::base");
  EXPECT_EQ(reader.info<Position2dInfo>().wheel_radius, 0.1);
  EXPECT_EQ(reader.info<Position2dInfo>().wheel_base, 0);
}

TEST(Iface, a_car_command_is_read_as_one_and_a_kind_of_later_clients_is_not_obeyed) {
  Fixture f;
  auto writer = f.make(iface_spec(IfaceType::position2d, "robot::base", Position2dInfo{}));
  auto reader = f.open(IfaceType::position2d, "robot::base");
  Command command;
  ASSERT_TRUE(reader.command(CommandKind::car, std::array{1.0, 0.3}));
  ASSERT_EQ(writer->poll_command(command), CommandChange::fresh);
  EXPECT_EQ(command.kind, CommandKind::car);
  EXPECT_EQ(command.values[1], 0.3);
  ASSERT_TRUE(reader.command(static_cast<CommandKind>(99), std::array{1.0, 0.3}));
  EXPECT_EQ(writer->poll_command(command), CommandChange::none);
}

TEST(Iface, a_command_with_a_duration_tells_it_to_the_simulator) {
  Fixture f;
  auto writer = f.make(iface_spec(IfaceType::position2d, "robot::base", Position2dInfo{}));
  auto reader = f.open(IfaceType::position2d, "robot::base");
  Command command;
  const std::array velocity{0.5, 0.0, 0.1};
  ASSERT_TRUE(reader.command(CommandKind::velocity, velocity, 2s));
  ASSERT_EQ(writer->poll_command(command), CommandChange::fresh);
  EXPECT_EQ(command.duration, 2s);
  ASSERT_TRUE(reader.command(CommandKind::velocity, velocity));
  ASSERT_EQ(writer->poll_command(command), CommandChange::fresh);
  EXPECT_EQ(command.duration, 0s);
}

TEST(Iface, a_published_scan_is_read_as_it_was_written) {
  Fixture f;
  auto writer = f.make(iface_spec(IfaceType::laser, "robot::laser", laser_info()));
  auto reader = f.open(IfaceType::laser, "robot::laser");
  EXPECT_FALSE(reader.read());
  for (std::size_t i = 0; i < 181; ++i) {
    writer->ranges()[i] = static_cast<float>(i) / 10;
    writer->intensities()[i] = static_cast<float>(i);
  }
  writer->ranges()[3] = INFINITY;
  writer->sample<LaserSample>().pose = planar_pose(1, 2, 3, 0.5);
  writer->set_resets(2);
  writer->publish(1500ms);
  ASSERT_TRUE(reader.read());
  const ScanView scan = reader.laser_scan();
  EXPECT_EQ(scan.sample->stamp.sequence, 1U);
  EXPECT_EQ(scan.sample->stamp.sim_time_ns, 1'500'000'000);
  EXPECT_EQ(scan.sample->stamp.valid, 1U);
  EXPECT_EQ(scan.sample->stamp.resets, 2U);
  EXPECT_EQ(scan.sample->count, 181U);
  EXPECT_EQ(scan.sample->pose.y, 2);
  EXPECT_TRUE(std::isinf(scan.ranges[3]));
  EXPECT_EQ(scan.ranges[180], 18.0F);
  EXPECT_EQ(scan.intensities[180], 180.0F);
  EXPECT_EQ(reader.info<LaserInfo>().beams, 181U);
  EXPECT_STREQ(reader.info<LaserInfo>().model, "robot");
}

TEST(Iface, sonar_poses_and_bumper_contacts_have_the_sizes_chosen_at_creation) {
  Fixture f;
  const Pose poses[] = {planar_pose(1, 0, 0, 0), planar_pose(2, 0, 0, 1), planar_pose(3, 0, 0, 2)};
  auto sonar = f.make(sonar_spec("ring", SonarInfo{}, poses));
  BumperInfo bumper_info{};
  bumper_info.capacity = 5;
  auto bumper = f.make(iface_spec(IfaceType::bumper, "bumper", bumper_info));
  auto sonar_reader = f.open(IfaceType::sonar, "ring");
  ASSERT_EQ(sonar_reader.sonar_poses().size(), 3U);
  EXPECT_EQ(sonar_reader.sonar_poses()[2].x, 3);
  ASSERT_EQ(sonar->ranges().size(), 3U);
  sonar->ranges()[2] = 2.5F;
  sonar->publish(0ns);
  ASSERT_TRUE(sonar_reader.read());
  EXPECT_EQ(sonar_reader.sonar_scan().ranges[2], 2.5F);

  ASSERT_EQ(bumper->contacts().size(), 5U);
  bumper->contacts()[1].depth = 0.25;
  bumper->sample<BumperSample>().count = 2;
  bumper->publish(0ns);
  auto bumper_reader = f.open(IfaceType::bumper, "bumper");
  ASSERT_TRUE(bumper_reader.read());
  ASSERT_EQ(bumper_reader.bumper().contacts.size(), 2U);
  EXPECT_EQ(bumper_reader.bumper().contacts[1].depth, 0.25);
}

TEST(Iface, an_iface_that_is_not_there_is_named_with_what_there_is_instead) {
  Fixture f;
  auto writer = f.make(iface_spec(IfaceType::laser, "a", laser_info()));
  const std::string id = std::to_string(f.id);
  EXPECT_EQ(Iface::open(f.id, IfaceType::laser, "b").error().message, "no laser \"b\" on server " + id + "; there is a");
  EXPECT_EQ(Iface::open(f.id, IfaceType::camera, "b").error().message, "no camera \"b\" on server " + id + "; it has only laser");
  const std::string other = Iface::open(fresh_server_id(), IfaceType::laser, "a").error().message;
  EXPECT_NE(other.find("which is not running; running: "), std::string::npos) << other;
}

TEST(Iface, counts_that_make_no_sense_are_refused) {
  Fixture f;
  EXPECT_FALSE(f.server->create(iface_spec(IfaceType::laser, "a", laser_info(0))));
  LaserInfo huge = laser_info();
  huge.beams = huge.layers = 0xffffffff;
  EXPECT_FALSE(f.server->create(iface_spec(IfaceType::laser, "a", huge)));
  EXPECT_FALSE(f.server->create(camera_spec(IfaceType::camera, "c", camera_info(0, 10))));
  EXPECT_FALSE(f.server->create(camera_spec(IfaceType::camera, "c", camera_info(0xffffffff, 0xffffffff))));
  EXPECT_FALSE(f.server->create(iface_spec(IfaceType::laser, "a/b", laser_info())));
  EXPECT_TRUE(find_segments(f.id).empty());
}

TEST(Iface, a_name_of_this_server_can_not_be_made_twice) {
  Fixture f;
  auto writer = f.make(iface_spec(IfaceType::laser, "a", laser_info()));
  auto second = f.server->create(iface_spec(IfaceType::laser, "a", laser_info()));
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().message, "laser \"a\" exists already in server " + std::to_string(f.id) + " of this process");
}

TEST(Iface, the_segment_has_the_mode_asked_for_whatever_the_umask) {
  const mode_t before = umask(077);
  Fixture f;
  auto strict = f.make(iface_spec(IfaceType::laser, "strict", laser_info()));
  const auto id = f.id;
  auto server = Server::start({.server_id = fresh_server_id(), .access = {.mode = 0660, .group = getgid()}});
  auto open = (*server)->create(iface_spec(IfaceType::laser, "open", laser_info()));
  umask(before);
  struct stat status {};
  ASSERT_EQ(stat(("/dev/shm/" + SegmentName{geteuid(), id, IfaceType::laser, "strict"}.text()).c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0600U);
  ASSERT_EQ(stat(("/dev/shm/" + (*open)->segment().name().text()).c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0660U);
}

TEST(Access, modes_and_groups_are_read_strictly) {
  EXPECT_EQ(parse_access("0660", "")->mode, 0660U);
  EXPECT_EQ(parse_access("", "")->mode, 0600U);
  EXPECT_EQ(parse_access("", "root")->group, 0U);
  for (const char* mode : {"0999", "x", "00660", "0060", "7777"}) EXPECT_FALSE(parse_access(mode, "")) << mode;
  EXPECT_FALSE(parse_access("", "no such group here"));
}

TEST(Iface, subscriptions_switch_the_sensor_on_and_off) {
  Fixture f;
  auto writer = f.make(iface_spec(IfaceType::laser, "a", laser_info()));
  EXPECT_FALSE(writer->is_subscribed());
  auto first = f.open(IfaceType::laser, "a");
  EXPECT_FALSE(writer->is_subscribed());
  ASSERT_TRUE(first.subscribe());
  ASSERT_TRUE(first.subscribe());
  EXPECT_TRUE(writer->is_subscribed());
  {
    auto second = f.open(IfaceType::laser, "a");
    ASSERT_TRUE(second.subscribe());
    first.unsubscribe();
    EXPECT_TRUE(writer->is_subscribed());
  }
  EXPECT_FALSE(writer->is_subscribed());
}

TEST(Iface, more_clients_than_leases_are_refused_until_one_goes) {
  Fixture f;
  IfaceSpec spec = iface_spec(IfaceType::laser, "a", laser_info());
  spec.geometry.leases = 2;
  auto writer = f.make(spec);
  auto a = f.open(IfaceType::laser, "a"), b = f.open(IfaceType::laser, "a"), c = f.open(IfaceType::laser, "a");
  ASSERT_TRUE(a.subscribe());
  ASSERT_TRUE(b.subscribe());
  const auto refused = c.subscribe();
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("has no free lease: 2 clients"), std::string::npos) << refused.error().message;
  a.unsubscribe();
  EXPECT_TRUE(c.subscribe());
}

TEST(Iface, the_latest_command_counts_and_its_end_is_told_once) {
  Fixture f;
  auto writer = f.make(iface_spec(IfaceType::position2d, "base", Position2dInfo{}));
  Command command{};
  EXPECT_EQ(writer->poll_command(command), CommandChange::none);
  auto a = f.open(IfaceType::position2d, "base"), b = f.open(IfaceType::position2d, "base");
  ASSERT_TRUE(a.command_velocity(1, 2, 3));
  EXPECT_EQ(writer->poll_command(command), CommandChange::fresh);
  EXPECT_EQ(command.values[2], 3);
  EXPECT_EQ(command.kind, CommandKind::velocity);
  EXPECT_EQ(writer->poll_command(command), CommandChange::none);
  EXPECT_EQ(writer->commanding_pid(), getpid());
  EXPECT_TRUE(a.is_commanding());
  ASSERT_TRUE(b.command_velocity(4, 0, 0));
  EXPECT_FALSE(a.is_commanding());
  EXPECT_EQ(writer->poll_command(command), CommandChange::fresh);
  EXPECT_EQ(command.values[0], 4);
  a = f.open(IfaceType::position2d, "base");  // the former commander goes: nothing happens
  EXPECT_EQ(writer->poll_command(command), CommandChange::none);
  b = f.open(IfaceType::position2d, "base");
  EXPECT_EQ(writer->poll_command(command), CommandChange::lost);
  EXPECT_EQ(writer->poll_command(command), CommandChange::none);
  EXPECT_EQ(writer->commanding_pid(), 0);
}

TEST(Iface, a_command_that_is_dropped_before_it_is_taken_never_comes) {
  Fixture f;
  auto writer = f.make(iface_spec(IfaceType::position2d, "base", Position2dInfo{}));
  auto a = f.open(IfaceType::position2d, "base");
  Command command{};
  ASSERT_TRUE(a.command_velocity(1, 0, 0));
  writer->drop_command();
  EXPECT_EQ(writer->poll_command(command), CommandChange::none);
  ASSERT_TRUE(a.command_velocity(2, 0, 0));
  EXPECT_EQ(writer->poll_command(command), CommandChange::fresh);
  EXPECT_EQ(command.values[0], 2);
}

TEST(Iface, the_size_of_its_commands_is_what_the_iface_chose) {
  Fixture f;
  auto spec = iface_spec(IfaceType::position2d, "arm", Position2dInfo{});
  spec.geometry.command_values = 200;
  auto writer = f.make(spec);
  Iface client = f.open(IfaceType::position2d, "arm");
  std::vector<double> values(200);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<double>(i) + 0.5;
  ASSERT_TRUE(client.command(CommandKind::pose, values));
  Command command;
  ASSERT_EQ(writer->poll_command(command), CommandChange::fresh);
  EXPECT_EQ(command.kind, CommandKind::pose);
  EXPECT_EQ(std::vector<double>(command.values.begin(), command.values.end()), values);
  // What a client leaves out is 0, not what the command before had there.
  ASSERT_TRUE(client.command(CommandKind::pose, std::span(values).first(2)));
  ASSERT_EQ(writer->poll_command(command), CommandChange::fresh);
  std::vector<double> expected(200);
  std::copy_n(values.begin(), 2, expected.begin());
  EXPECT_EQ(std::vector<double>(command.values.begin(), command.values.end()), expected);
  values.push_back(1);
  const auto refused = client.command(CommandKind::pose, values);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("201 values, at most 200"), std::string::npos) << refused.error().message;
}

TEST(Iface, an_iface_without_commands_refuses_them) {
  Fixture f;
  auto writer = f.make(iface_spec(IfaceType::laser, "a", laser_info()));
  Iface client = f.open(IfaceType::laser, "a");
  EXPECT_FALSE(client.command_velocity(1, 0, 0));
}

TEST(Iface, an_iface_whose_commands_are_larger_than_its_leases_is_not_opened) {
  Fixture f;
  auto writer = f.make(iface_spec(IfaceType::position2d, "base", Position2dInfo{}));
  for (const std::uint32_t claimed : {13U, max_command_values, ~0U}) {  // 12 fit into a lease of this iface, which is rounded up
    writer->segment().header().command_values = claimed;
    EXPECT_FALSE(Segment::open(writer->segment().name())) << claimed;
  }
  writer->segment().header().command_values = 3;
  EXPECT_TRUE(Segment::open(writer->segment().name()));
}

TEST(Iface, a_command_that_is_not_finite_is_refused) {
  Fixture f;
  auto writer = f.make(iface_spec(IfaceType::position2d, "base", Position2dInfo{}));
  auto a = f.open(IfaceType::position2d, "base");
  EXPECT_FALSE(a.command_velocity(NAN, 0, 0));
  EXPECT_FALSE(a.command_velocity(0, INFINITY, 0));
  Command command{};
  EXPECT_EQ(writer->poll_command(command), CommandChange::none);
}

TEST(Iface, a_wait_ends_with_the_sample_or_the_time_out) {
  Fixture f;
  auto writer = f.make(iface_spec(IfaceType::laser, "a", laser_info()));
  auto reader = f.open(IfaceType::laser, "a");
  EXPECT_EQ(reader.wait(0, 1ms), Wait::timed_out);
  std::thread publisher([&] {
    for (int i = 0; i < 100; ++i) {
      writer->ranges()[0] = static_cast<float>(i + 1);
      writer->publish(std::chrono::milliseconds(i));
      std::this_thread::yield();
    }
  });
  std::uint64_t last = 0;
  while (last < 100) {
    ASSERT_EQ(reader.wait(last, 60s), Wait::fresh);
    EXPECT_GT(reader.laser_scan().sample->stamp.sequence, last);
    last = reader.laser_scan().sample->stamp.sequence;
    EXPECT_EQ(reader.laser_scan().ranges[0], static_cast<float>(last));
  }
  publisher.join();
}

// Who comes late has nothing to tell; those who will bring the next news must find that somebody waits for them.
TEST(Bell, one_that_comes_late_leaves_the_announcement_of_who_has_seen_its_news) {
  std::uint32_t word = 7, waiting = 0;
  announce(waiting, 7);
  ring(word, waiting);
  EXPECT_NE(waiting, 0u) << "7 is what the sleeper has seen";
  word = 8;
  ring(word, waiting);
  EXPECT_EQ(waiting, 0u) << "woken";
  waiting = 1;  // as readers of other makes may announce themselves
  ring(word, waiting);
  EXPECT_EQ(waiting, 0u);
}

TEST(Iface, the_end_of_the_writer_wakes_a_waiting_reader_at_once) {
  Fixture f;
  auto writer = f.make(iface_spec(IfaceType::laser, "a", laser_info()));
  auto reader = f.open(IfaceType::laser, "a");
  std::thread closer([&] {
    while (load(writer->segment().header().waiting) == 0) std::this_thread::yield();
    writer.reset();
  });
  EXPECT_EQ(reader.wait(0, 60s), Wait::closed);
  closer.join();
  EXPECT_EQ(reader.status(), Status::closed);
  EXPECT_FALSE(reader.reopen());
  auto again = f.make(iface_spec(IfaceType::laser, "a", laser_info()));
  ASSERT_TRUE(reader.reopen());
  EXPECT_EQ(reader.status(), Status::live);
}

// The place of a client that went, perhaps in the middle of a command, is soon another's, who has said nothing yet.
TEST(Iface, commands_of_a_client_that_went_are_not_taken_for_those_of_the_next) {
  Fixture f;
  auto writer = f.make(iface_spec(IfaceType::position2d, "base", Position2dInfo{}));
  Lease& lease = writer->segment().as<Lease>(AreaIndex::leases, 0);
  for (const bool dies_while_writing : {false, true}) {
    std::optional<Iface> first(f.open(IfaceType::position2d, "base"));
    ASSERT_TRUE(first->command_velocity(1, 1, 1));
    ASSERT_NE(load(lease.owner), 0U);
    if (dies_while_writing) {
      store(lease.command_lock, load(lease.command_lock) + 1);
      command_values_of(lease)[0] = 2;
      store(lease.owner, std::uint64_t{0});  // as the server does when it finds the process dead
    }
    first.reset();
    Iface second = f.open(IfaceType::position2d, "base");
    ASSERT_TRUE(second.subscribe());
    ASSERT_NE(load(lease.owner), 0U) << "the same place";
    Command command{};
    EXPECT_NE(writer->poll_command(command), CommandChange::fresh) << dies_while_writing;
    ASSERT_TRUE(second.command_velocity(3, 3, 3));
    EXPECT_EQ(writer->poll_command(command), CommandChange::fresh);
    EXPECT_EQ(command.values[0], 3);
  }
}

TEST(Iface, a_reader_never_sees_a_torn_sample) {
  Fixture f;
  auto writer = f.make(iface_spec(IfaceType::laser, "a", laser_info(361)));
  std::atomic<bool> is_over{false};
  std::atomic<int> reads{0};
  const auto read_all = [&] {
    auto reader = f.open(IfaceType::laser, "a");
    while (!is_over) {
      if (!reader.read()) continue;
      const auto scan = reader.laser_scan();
      const auto first = scan.ranges[0];
      const bool is_whole = std::all_of(scan.ranges.begin(), scan.ranges.end(), [&](float r) { return r == first; }) &&
                            std::all_of(scan.intensities.begin(), scan.intensities.end(), [&](float r) { return r == first; });
      ASSERT_TRUE(is_whole);
      ASSERT_EQ(static_cast<std::uint64_t>(first), scan.sample->stamp.sequence % 1024);
      ++reads;
    }
  };
  std::thread a(read_all), b(read_all);
  for (std::uint64_t n = 1; n < 20000 || reads < 1000; ++n) {
    std::fill(writer->ranges().begin(), writer->ranges().end(), static_cast<float>(n % 1024));
    std::fill(writer->intensities().begin(), writer->intensities().end(), static_cast<float>(n % 1024));
    writer->publish(0ns);
  }
  is_over = true;
  a.join();
  b.join();
}

}  // namespace
}  // namespace shm::test
