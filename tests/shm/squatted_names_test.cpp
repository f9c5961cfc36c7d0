// Another account makes files in /dev/shm under the names that a server needs, before the server starts.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <barrier>
#include <filesystem>
#include <fstream>
#include <optional>
#include <thread>

#include "shm/shm_support.h"

namespace shm::test {
namespace {

// Accounts of this test process alone: others run at the same time, and look for what is left behind.
const uid_t user = 20'000 + 2 * static_cast<uid_t>(::getpid() % 20'000), squatter = user + 1;

std::string usual_path(uid_t uid, std::uint32_t id, IfaceType type, const std::string& name) {
  return "/dev/shm/" + SegmentName{uid, id, type, name}.text();
}

int as(uid_t account, const std::function<void()>& body) {
  return Child([&] {
           if (::setgid(account) != 0 || ::setuid(account) != 0) return 2;
           body();
           return ::testing::Test::HasFailure() ? 1 : 0;
         })
      .wait();
}

bool has_refuge(uid_t uid) {
  const std::string prefix = "rtmsim-" + std::to_string(uid) + ".";
  for (const auto& entry : std::filesystem::directory_iterator("/dev/shm")) {
    if (entry.is_directory() && entry.path().filename().string().starts_with(prefix)) return true;
  }
  return false;
}

class SquattedNames : public ::testing::TestWithParam<mode_t> {
 protected:
  void SetUp() override {
    if (::geteuid() != 0) GTEST_SKIP() << "only root can be two others";
    // All servers of one account share a refuge: the other tests of this program, each in a process of its own, wait here.
    turn_ = ::open("/proc/self/exe", O_RDONLY | O_CLOEXEC);
    ASSERT_EQ(::flock(turn_, LOCK_EX), 0) << errno;
  }
  void TearDown() override {
    for (const auto& path : taken_) ::unlink(path.c_str());
    if (turn_ >= 0) ::close(turn_);
  }
  void take(std::uint32_t id, IfaceType type, const std::string& name, mode_t mode) {
    taken_.push_back(usual_path(user, id, type, name));
    ASSERT_EQ(as(squatter, [&] { EXPECT_GE(::open(taken_.back().c_str(), O_CREAT | O_EXCL | O_RDWR, mode), 0); }), 0);
    ASSERT_EQ(::chmod(taken_.back().c_str(), mode), 0);
  }

 private:
  std::vector<std::string> taken_;
  int turn_ = -1;
};

TEST_P(SquattedNames, do_not_keep_a_server_from_its_id) {
  const std::uint32_t id = fresh_server_id();
  take(id, IfaceType::simulation, "world", GetParam());
  take(id, IfaceType::laser, "robot::laser", GetParam());
  EXPECT_EQ(as(user,
               [&] {
                 Fixture mine{id};
                 auto world = mine.make(iface_spec(IfaceType::simulation, "world", simulation_info()));
                 auto laser = mine.make(iface_spec(IfaceType::laser, "robot::laser", laser_info()));
                 Iface reader = mine.open(IfaceType::laser, "robot::laser");
                 laser->publish(5ns);
                 EXPECT_TRUE(reader.read());
                 const auto found = find_segments(id);
                 EXPECT_EQ(found.size(), 2U);
                 for (const auto& one : found) EXPECT_TRUE(one.is_alive) << one.problem;
                 // The id is taken now, by us.
                 EXPECT_EQ(Child([&] { return Server::start({.server_id = id, .access = {}}).ok() ? 1 : 0; }).wait(), 0);
                 EXPECT_TRUE(has_refuge(user));
               }),
            0);
  EXPECT_FALSE(has_refuge(user)) << "the folder stays behind";
}

TEST_P(SquattedNames, of_a_server_that_was_killed_are_found_by_the_next_one) {
  const std::uint32_t id = fresh_server_id();
  take(id, IfaceType::simulation, "world", GetParam());
  const auto start = [&](bool is_killed) {
    return as(user, [&] {
      Fixture mine{id};
      auto world = mine.make(iface_spec(IfaceType::simulation, "world", simulation_info()));
      EXPECT_EQ(find_segments(id).size(), 1U);
      if (is_killed) ::kill(::getpid(), SIGKILL);
    });
  };
  EXPECT_EQ(start(true), -1);
  EXPECT_TRUE(has_refuge(user));
  EXPECT_EQ(start(false), 0);
  EXPECT_FALSE(has_refuge(user)) << "the folder stays behind";
}

// Each may find no folder for taken names and make one of its own.
TEST_P(SquattedNames, give_the_id_to_one_of_two_who_start_at_the_same_time) {
  const std::uint32_t id = fresh_server_id();
  take(id, IfaceType::simulation, "world", GetParam());
  constexpr int rounds = 200;
  const auto race = [&] {
    const IfaceSpec spec = iface_spec(IfaceType::simulation, "world", simulation_info());
    for (int round = 0; round < rounds; ++round) {
      std::barrier start(2);
      std::optional<base::Result<Segment>> made[2];
      const auto make = [&](int which) {
        start.arrive_and_wait();
        made[which].emplace(Segment::create({::geteuid(), id, IfaceType::simulation, "world"}, spec.geometry, spec.info, {}));
        start.arrive_and_wait();
      };
      std::thread other(make, 1);
      make(0);
      other.join();
      EXPECT_EQ(made[0]->ok() + made[1]->ok(), 1) << "round " << round;
      for (auto& one : made) {
        if (one->ok()) (*one)->close();
      }
    }
    EXPECT_FALSE(has_refuge(user)) << "a folder stays behind";
  };
  EXPECT_EQ(as(user, race), 0);
}

TEST_P(SquattedNames, lead_no_client_to_what_another_account_wrote) {
  const std::uint32_t id = fresh_server_id();
  take(id, IfaceType::laser, "robot::laser", GetParam());
  EXPECT_EQ(as(user, [&] { EXPECT_FALSE(Iface::open(id, IfaceType::laser, "robot::laser").ok()); }), 0);
}

INSTANTIATE_TEST_SUITE_P(Modes, SquattedNames, ::testing::Values(0600, 0666));

}  // namespace
}  // namespace shm::test
