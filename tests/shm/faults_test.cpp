// Processes killed, stopped and scribbling at random points. Each helper is a process of its own (tests/shm/helper.cpp).
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/stat.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <random>

#include "shm/lockstep.h"
#include "shm/process.h"
#include "shm/process_watch.h"
#include "shm/request_board.h"
#include "shm/shm_support.h"
#include "support/paths.h"

namespace shm::test {
namespace {

// A running helper; killed at the end of its life.
class Helper {
 public:
  Helper(const std::string& part, std::uint32_t id, std::vector<std::string> more = {}) {
    std::vector<std::string> words{std::string(paths::bin_dir) + "/shm_helper", part, std::to_string(id)};
    words.insert(words.end(), more.begin(), more.end());
    std::vector<char*> argv;
    for (auto& one : words) argv.push_back(one.data());
    argv.push_back(nullptr);
    if (posix_spawn(&pid_, argv[0], nullptr, nullptr, argv.data(), environ) != 0) throw std::runtime_error("can't start " + words[0]);
  }
  Helper(Helper&& other) noexcept : pid_(std::exchange(other.pid_, -1)) {}
  Helper& operator=(Helper&& other) noexcept {
    std::swap(pid_, other.pid_);
    return *this;
  }
  ~Helper() { kill_now(); }
  pid_t pid() const { return pid_; }
  void send(int signal) const { ::kill(pid_, signal); }
  // Signal that ended it, or minus its exit code.
  int kill_now() {
    if (pid_ <= 0) return 0;
    send(SIGKILL);
    int status = 0;
    waitpid(pid_, &status, 0);
    pid_ = -1;
    return WIFSIGNALED(status) ? WTERMSIG(status) : -WEXITSTATUS(status);
  }

 private:
  pid_t pid_ = -1;
};

int rounds(int wanted) {
  const char* text = std::getenv("RTMSIM_KILLS");
  return text != nullptr ? std::atoi(text) : wanted;
}

void pass_time(std::mt19937& random, unsigned max_us) { std::this_thread::sleep_for(std::chrono::microseconds(random() % max_us)); }

TEST(ProcessWatch, the_death_of_a_process_is_told_at_once) {
  auto watch = ProcessWatch::start().value();
  std::atomic<int> calls{0};
  watch->on_death([&] { ++calls; });
  const auto self = watch->watch(own_mark());
  Helper helper("participate", fresh_server_id(), {"x", "1", "1000"});
  const auto other = watch->watch({helper.pid(), 0, 0});
  EXPECT_EQ(other, watch->watch({helper.pid(), 0, 0}));
  EXPECT_FALSE(other->is_dead());
  helper.kill_now();
  while (calls == 0) std::this_thread::yield();
  EXPECT_TRUE(other->is_dead());
  EXPECT_FALSE(self->is_dead());
  EXPECT_EQ(watch->deaths(), 1U);
  EXPECT_TRUE(watch->watch(other->mark())->is_dead());
}

TEST(Faults, clients_killed_at_random_points_leave_nothing_behind) {
  Fixture f;
  auto simulation = f.make(simulation_spec(simulation_info()));
  auto laser = f.make(iface_spec(IfaceType::laser, "laser", laser_info()));
  auto camera = f.make(camera_spec(IfaceType::camera, "eye", camera_info()));
  auto base = f.make(iface_spec(IfaceType::position2d, "base", Position2dInfo{}));
  RequestBoard board(*simulation, *f.server);
  std::atomic<bool> is_over{false};
  std::atomic<int> commands{0}, lost{0}, requests{0};
  std::thread loop([&] {
    Barrier barrier(*simulation, *f.server, {});
    for (std::uint64_t n = 1; !is_over; ++n) {
      f.server->tend();
      for (const auto& asked : board.poll()) {
        board.reply(asked.ticket, {});
        ++requests;
      }
      std::fill(laser->ranges().begin(), laser->ranges().end(), static_cast<float>(n % 1024));
      laser->publish(std::chrono::milliseconds(n));
      if (auto data = camera->begin_frame()) {
        std::fill(data->begin(), data->end(), std::byte{static_cast<unsigned char>(n)});
        camera->publish_frame(std::chrono::milliseconds(n), identity_pose);
      }
      Command command{};
      const auto change = base->poll_command(command);
      if (change == CommandChange::fresh) {
        ++commands;
        if (command.values[0] != command.values[1] || command.values[0] != command.values[2]) ADD_FAILURE() << "torn command";
      }
      if (change == CommandChange::lost) ++lost;
      barrier.tick(std::chrono::milliseconds(n), n);
    }
  });
  std::mt19937 random(7);
  const std::vector<std::vector<std::string>> parts{{"read"}, {"hold"}, {"command"}, {"ask"}, {"participate", "p", "1", "1000"}};
  for (int round = 0; round < rounds(200); ++round) {
    const auto& part = parts[static_cast<std::size_t>(round) % parts.size()];
    Helper helper(part[0], f.id, {part.begin() + 1, part.end()});
    pass_time(random, 12000);
    EXPECT_EQ(helper.kill_now(), SIGKILL) << part[0];
  }
  // On a machine so busy that all of them died before they had done anything: once more, with time.
  const auto enough = std::chrono::steady_clock::now() + 60s;
  for (const auto& [part, done] : {std::pair("command", &commands), std::pair("ask", &requests)}) {
    Helper helper(part, f.id);
    while (*done == 0 && std::chrono::steady_clock::now() < enough) std::this_thread::yield();
  }
  // All leases, places and slots come back, and the robot has been stopped.
  const auto is_clean = [&] {
    for (const auto* writer : {simulation.get(), laser.get(), camera.get(), base.get()}) {
      for (std::size_t i = 0; i < writer->segment().area(AreaIndex::leases).count; ++i) {
        if (load(writer->segment().as<Lease>(AreaIndex::leases, i).owner) != 0) return false;
      }
    }
    for (std::size_t i = 0; i < simulation->segment().area(AreaIndex::requests).count; ++i) {
      if (load(simulation->segment().as<RequestSlot>(AreaIndex::requests, i).owner) != 0) return false;
    }
    for (std::size_t i = 0; i < simulation->segment().area(AreaIndex::participants).count; ++i) {
      if (load(simulation->segment().as<ParticipantSlot>(AreaIndex::participants, i).owner) != 0) return false;
    }
    return true;
  };
  const auto deadline = std::chrono::steady_clock::now() + 60s;
  while (!is_clean() && std::chrono::steady_clock::now() < deadline) std::this_thread::yield();
  EXPECT_TRUE(is_clean());
  is_over = true;
  board.wake();
  loop.join();
  EXPECT_FALSE(laser->is_subscribed());
  EXPECT_EQ(base->commanding_pid(), 0);
  RecordProperty("commands", commands.load());
  EXPECT_GT(commands, 0);
  EXPECT_GT(lost, 0);
  EXPECT_GT(requests, 0);
}

TEST(Faults, a_server_killed_at_random_points_is_replaced_at_once_and_its_readers_go_on) {
  const std::uint32_t id = fresh_server_id();
  Helper reader("read", id), asker("ask", id), participant("participate", id, {"p", "1", "1000"});
  std::mt19937 random(11);
  std::optional<Iface> laser;
  std::uint64_t generation = 0;
  for (int round = 0; round < rounds(200); ++round) {
    Helper server("serve", id);
    if (round % 10 == 0) {  // wait until it is really there
      const auto deadline = std::chrono::steady_clock::now() + 60s;
      while (std::chrono::steady_clock::now() < deadline) {
        if (laser ? static_cast<bool>(laser->reopen()) : false) break;
        if (auto opened = Iface::open(id, IfaceType::laser, "laser"); !laser && opened) {
          laser.emplace(std::move(*opened));
          break;
        }
        std::this_thread::yield();
      }
      ASSERT_TRUE(laser);
      ASSERT_EQ(laser->wait(0, 60s), Wait::fresh);
      EXPECT_GT(laser->segment().facts().generation, generation);
      generation = laser->segment().facts().generation;
    }
    pass_time(random, 10000);
    EXPECT_EQ(server.kill_now(), SIGKILL);
    if (round % 10 == 0) {
      std::uint64_t last = laser->sequence();
      Wait outcome = Wait::fresh;
      while (outcome == Wait::fresh) outcome = laser->wait(last, 60s), last = laser->sequence();
      EXPECT_EQ(outcome, Wait::closed);
      EXPECT_EQ(laser->status(), Status::dead);
    }
  }
  EXPECT_EQ(reader.kill_now(), SIGKILL) << "a torn sample, or worse";
  EXPECT_EQ(asker.kill_now(), SIGKILL);
  EXPECT_EQ(participant.kill_now(), SIGKILL);
  EXPECT_FALSE(Iface::open(id, IfaceType::laser, "laser"));
  remove_stale(id, id);
  EXPECT_TRUE(find_segments(id).empty());
}

// What is cleaned up for one server, or for those that only check a world, is theirs: readers of another dead server see it as it died.
TEST(Faults, cleaning_up_leaves_other_servers_alone) {
  const std::uint32_t id = fresh_server_id(), other = fresh_server_id();
  for (const std::uint32_t server : {id, other}) {
    Helper process("serve", server);
    while (!Iface::open(server, IfaceType::laser, "laser")) std::this_thread::yield();
    EXPECT_EQ(process.kill_now(), SIGKILL);
  }
  const auto left = find_segments(other).size();
  ASSERT_GT(left, 0U);
  remove_stale(first_unnamed_server);
  remove_stale(id, id);
  EXPECT_TRUE(find_segments(id).empty());
  EXPECT_EQ(find_segments(other).size(), left);
  remove_stale(other, other);
  EXPECT_TRUE(find_segments(other).empty());
}

TEST(Faults, a_living_server_is_refused_and_a_dead_one_replaced) {
  const std::uint32_t id = fresh_server_id();
  Helper first("serve", id);
  std::optional<Iface> laser;
  while (!laser) {
    if (auto opened = Iface::open(id, IfaceType::laser, "laser")) laser.emplace(std::move(*opened));
  }
  const auto refused = Server::start({.server_id = id, .access = {}});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message, "server " + std::to_string(id) + " is already running as pid " + std::to_string(first.pid()) +
                                         "; choose another server id or end that one");
  first.kill_now();
  auto server = Server::start({.server_id = id, .access = {}});
  ASSERT_TRUE(server) << server.error().message;
  EXPECT_EQ(laser->status(), Status::closed) << "the old segment says so to its readers";
  EXPECT_TRUE((*server)->create(iface_spec(IfaceType::laser, "laser", laser_info())));
}

TEST(Faults, of_several_servers_that_start_at_once_exactly_one_gets_a_stale_name) {
  for (int round = 0; round < 20; ++round) {
    const std::uint32_t id = fresh_server_id();
    {
      Helper dead("serve", id);
      while (!Iface::open(id, IfaceType::simulation, "world")) std::this_thread::yield();
    }
    std::vector<Helper> servers;
    for (int n = 0; n < 3; ++n) servers.emplace_back("serve", id);
    int survivors = 0;
    std::vector<bool> is_gone(servers.size());
    const auto deadline = std::chrono::steady_clock::now() + 60s;
    do {
      survivors = 0;
      for (std::size_t n = 0; n < servers.size(); ++n) survivors += is_alive({servers[n].pid(), 0, 0}) ? 1 : 0;
      std::this_thread::yield();
    } while (survivors != 1 && std::chrono::steady_clock::now() < deadline);
    EXPECT_EQ(survivors, 1);
    servers.clear();
    remove_stale(id, id);
  }
}

TEST(Faults, a_file_that_is_no_iface_under_the_name_of_one_is_replaced_and_never_opened) {
  const std::uint32_t id = fresh_server_id();
  const SegmentName name{geteuid(), id, IfaceType::laser, "laser"};
  for (const std::size_t size : {0, 10, 1024, 100'000}) {
    std::ofstream("/dev/shm/" + name.text()) << std::string(size, 'x');
    const auto opened = Iface::open(id, IfaceType::laser, "laser");
    EXPECT_FALSE(opened);
    auto server = Server::start({.server_id = id, .access = {}}).value();
    EXPECT_TRUE(server->create(iface_spec(IfaceType::laser, "laser", laser_info())));
  }
}

TEST(Faults, a_truncated_or_twisted_segment_is_refused_by_readers) {
  Fixture f;
  auto writer = f.make(iface_spec(IfaceType::laser, "laser", laser_info()));
  Header& header = writer->segment().header();
  const Header good = header;
  const auto is_refused = [&] {
    const bool result = !Iface::open(f.id, IfaceType::laser, "laser");
    std::memcpy(&header, &good, offsetof(Header, state));
    return result;
  };
  EXPECT_FALSE(is_refused());
  header.layout_version = 99;
  EXPECT_TRUE(is_refused());
  header.total_size = ~std::uint64_t{0};
  EXPECT_TRUE(is_refused());
  header.type = RTMSIM_SONAR;
  EXPECT_TRUE(is_refused());
  for (std::size_t i : {0, 1, 3}) {
    for (const std::uint64_t offset : {std::uint64_t{1}, ~std::uint64_t{63}, std::uint64_t{1} << 40}) {
      header.areas[i].offset = offset;
      EXPECT_TRUE(is_refused());
    }
    header.areas[i].count = 0xffffffff;
    EXPECT_TRUE(is_refused());
    header.areas[i].stride = 0xffffffc0;
    EXPECT_TRUE(is_refused());
  }
  reinterpret_cast<LaserInfo*>(writer->segment().at(AreaIndex::info))->beams = 0xffffffff;
  EXPECT_TRUE(is_refused());
}

TEST(Faults, a_scribbling_client_stops_neither_server_nor_its_loop) {
  Fixture f;
  auto simulation = f.make(simulation_spec(simulation_info()));
  auto laser = f.make(iface_spec(IfaceType::laser, "laser", laser_info()));
  auto camera = f.make(camera_spec(IfaceType::camera, "eye", camera_info()));
  auto base = f.make(iface_spec(IfaceType::position2d, "base", Position2dInfo{}));
  BarrierOptions options;
  options.participant_timeout = 50ms;  // the scribbler can take the ticks of honest participants away
  RequestBoard board(*simulation, *f.server);
  Barrier barrier(*simulation, *f.server, options);
  Helper honest("participate", f.id, {"honest", "1", "1000"}), reader("read", f.id), asker("ask", f.id);
  std::vector<Helper> scribblers;
  for (int n = 0; n < 2; ++n) scribblers.emplace_back("scribble", f.id);
  const auto end = std::chrono::steady_clock::now() + 3s;
  Reply long_reply;
  long_reply.text.assign(40000, 'y');
  std::uint64_t n = 1;
  for (; std::chrono::steady_clock::now() < end; ++n) {
    f.server->tend();
    for (const auto& asked : board.poll()) board.reply(asked.ticket, long_reply);
    std::fill(laser->ranges().begin(), laser->ranges().end(), 1.0F);
    laser->publish(std::chrono::milliseconds(n));
    if (auto data = camera->begin_frame()) camera->publish_frame(std::chrono::milliseconds(n), identity_pose);
    Command command{};
    if (base->poll_command(command) == CommandChange::fresh) {
      for (double value : command.values) ASSERT_TRUE(std::isfinite(value));
    }
    (void)laser->is_subscribed();
    board.wait(std::chrono::steady_clock::now());
    ASSERT_TRUE(barrier.tick(std::chrono::milliseconds(n), n));
    (void)barrier.records();
  }
  EXPECT_GT(n, 20U);
  scribblers.clear();
  (void)find_segments(f.id);
}

TEST(Faults, a_file_that_is_cut_short_ends_neither_server_nor_readers) {
  for (const std::size_t size : {0, 1024, 4096}) {
    Fixture f;
    auto simulation = f.make(simulation_spec(simulation_info()));
    auto laser = f.make(iface_spec(IfaceType::laser, "laser", laser_info(4000)));
    auto camera = f.make(camera_spec(IfaceType::camera, "eye", camera_info(640, 480)));
    auto base = f.make(iface_spec(IfaceType::position2d, "base", Position2dInfo{}));
    RequestBoard board(*simulation, *f.server);
    Barrier barrier(*simulation, *f.server, {});
    Iface reader = f.open(IfaceType::laser, "laser"), eye = f.open(IfaceType::camera, "eye"),
          driver = f.open(IfaceType::position2d, "base");
    ASSERT_TRUE(reader.subscribe() && eye.subscribe() && driver.command_velocity(1, 0, 0));
    Command command{};
    ASSERT_EQ(base->poll_command(command), CommandChange::fresh);
    EXPECT_TRUE(f.server->take_cuts().empty());

    for (const IfaceWriter* writer : {simulation.get(), laser.get(), camera.get(), base.get()}) {
      ASSERT_EQ(::truncate(("/dev/shm/" + writer->segment().name().text()).c_str(), static_cast<off_t>(size)), 0);
    }
    CommandChange change = CommandChange::none;
    for (std::uint64_t n = 1; n < 5; ++n) {
      const std::chrono::milliseconds time(n);
      f.server->tend();
      EXPECT_TRUE(board.poll().empty());
      laser->publish(time);
      if (camera->begin_frame()) camera->publish_frame(time, identity_pose);
      if (const auto now = base->poll_command(command); now != CommandChange::none) change = now;
      base->publish(time);
      simulation->publish(time);
      EXPECT_TRUE(barrier.tick(time, n));
      (void)reader.wait(n, 1ms);
      (void)reader.laser_scan();
      (void)eye.hold();
      (void)driver.command_velocity(1, 0, 0);
    }
    EXPECT_EQ(f.server->take_cuts().size(), 4U) << size;
    EXPECT_TRUE(f.server->take_cuts().empty());
    EXPECT_EQ(change, CommandChange::lost) << "the robot goes on without anybody who could stop it";
    EXPECT_NE(reader.status(), Status::live);
    EXPECT_FALSE(Iface::open(f.id, IfaceType::laser, "laser"));
  }
}

TEST(Faults, a_file_that_is_made_longer_ends_no_client_that_opens_it_again) {
  Fixture f;
  auto laser = f.make(iface_spec(IfaceType::laser, "laser", laser_info()));
  Iface reader = f.open(IfaceType::laser, "laser");
  const std::string path = "/dev/shm/" + laser->segment().name().text();
  const std::uint64_t longer = laser->segment().facts().total_size + (std::uint64_t{64} << 20);
  ASSERT_EQ(::truncate(path.c_str(), static_cast<off_t>(longer)), 0);
  Header& header = laser->segment().header();
  header.total_size = longer;
  header.areas[static_cast<std::size_t>(AreaIndex::leases)].offset = longer - 64 * 1024;
  EXPECT_FALSE(Iface::open(f.id, IfaceType::laser, "laser")) << "this process has mapped less than the header says";
  (void)find_segments(f.id);
  EXPECT_TRUE(reader.subscribe()) << "who had it before goes on";
}

TEST(Faults, a_participant_killed_in_the_middle_of_a_tick_is_dropped_at_once) {
  Fixture f;
  auto simulation = f.make(simulation_spec(simulation_info()));
  std::vector<BarrierEvent> events;
  BarrierOptions options;
  options.on_event = [&](const BarrierEvent& event) { events.push_back(event); };
  options.hang_warning = 60s;
  Barrier barrier(*simulation, *f.server, options);
  Helper helper("participate", f.id, {"victim", "1", "1000"});
  ASSERT_TRUE(f.tend_until([&] { return barrier.refresh() == 1; }));
  helper.send(SIGSTOP);
  std::thread killer([&] {
    while (load(simulation->segment().as<Control>(AreaIndex::control).server_waiting) == 0) std::this_thread::yield();
    helper.kill_now();
  });
  for (int ms = 1; barrier.refresh() > 0; ++ms) ASSERT_TRUE(barrier.tick(std::chrono::milliseconds(ms), 0));
  killer.join();
  EXPECT_EQ(events.back().kind, BarrierEvent::Kind::died);
  EXPECT_EQ(events.back().name, "victim");
  EXPECT_TRUE(events.back().was_in_tick);
}

TEST(Faults, a_participant_stopped_and_continued_is_named_and_goes_on) {
  Fixture f;
  auto simulation = f.make(simulation_spec(simulation_info()));
  BarrierOptions options;
  options.hang_warning = 30ms;
  Helper helper("participate", f.id, {"sleeper", "1", "1000"});
  std::vector<BarrierEvent::Kind> events;
  options.on_event = [&](const BarrierEvent& event) {
    events.push_back(event.kind);
    if (event.kind == BarrierEvent::Kind::hangs) helper.send(SIGCONT);
  };
  Barrier barrier(*simulation, *f.server, options);
  ASSERT_TRUE(f.tend_until([&] { return barrier.refresh() == 1; }));
  for (int ms = 1; ms < 10; ++ms) ASSERT_TRUE(barrier.tick(std::chrono::milliseconds(ms), 0));
  helper.send(SIGSTOP);
  int ms = 10;
  while (std::find(events.begin(), events.end(), BarrierEvent::Kind::hangs) == events.end()) {
    ASSERT_TRUE(barrier.tick(std::chrono::milliseconds(ms++), 0));
  }
  for (int n = 0; n < 10; ++n) ASSERT_TRUE(barrier.tick(std::chrono::milliseconds(ms++), 0));
  EXPECT_EQ(barrier.refresh(), 1U);
}

TEST(Faults, participants_killed_at_random_points_never_stop_time) {
  Fixture f;
  auto simulation = f.make(simulation_spec(simulation_info()));
  std::atomic<bool> is_over{false};
  std::atomic<std::uint64_t> ticks{0};
  int died = 0;
  std::thread loop([&] {
    BarrierOptions options;
    options.on_event = [&](const BarrierEvent& event) { died += event.kind == BarrierEvent::Kind::died ? 1 : 0; };
    Barrier barrier(*simulation, *f.server, options);
    for (std::uint64_t n = 1; !is_over; ++n) {
      f.server->tend();
      barrier.tick(std::chrono::milliseconds(n), n);
      ++ticks;
    }
  });
  std::mt19937 random(3);
  std::vector<Helper> helpers;
  for (int round = 0; round < rounds(200); ++round) {
    helpers.emplace_back("participate", f.id, std::vector<std::string>{"p", std::to_string(round % 3), "1000"});
    pass_time(random, 8000);
    if (helpers.size() > 3) helpers.erase(helpers.begin());
    const std::uint64_t before = ticks;
    const auto deadline = std::chrono::steady_clock::now() + 60s;
    while (ticks == before && std::chrono::steady_clock::now() < deadline) std::this_thread::yield();
    ASSERT_NE(ticks, before) << "time stands still";
  }
  helpers.clear();
  is_over = true;
  loop.join();
  EXPECT_GT(died, 0);
}

}  // namespace
}  // namespace shm::test
