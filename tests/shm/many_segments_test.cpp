// The cost of a segment, and of a look for one that is missing, does not grow with those that are there already: a server with thousands of
// models makes one for each, and hundreds of components look for a server that is gone, ten times a second each.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdarg>
#include <fstream>
#include <thread>

#include "shm/shm_support.h"

namespace {
std::atomic<int> looks = 0;  // at files of /dev/shm by their path
std::atomic<int> opened = 0;

bool is_segment(const char* path) { return std::string_view(path).starts_with("/dev/shm/"); }
}  // namespace

// In place of the C library's, for this program.
extern "C" int lstat(const char* path, struct stat* found) noexcept {
  looks += is_segment(path) ? 1 : 0;
  return static_cast<int>(::syscall(SYS_newfstatat, AT_FDCWD, path, found, AT_SYMLINK_NOFOLLOW));
}

extern "C" int open(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const auto mode = va_arg(rest, unsigned);  // of no meaning, and harmless, when nothing is made
  va_end(rest);
  opened += is_segment(path) ? 1 : 0;
  return static_cast<int>(::syscall(SYS_openat, AT_FDCWD, path, flags, mode));
}

namespace shm::test {
namespace {

TEST(Segments, of_a_large_server_are_made_without_a_look_at_each_other_one) {
  const std::uint32_t id = fresh_server_id();
  std::vector<Segment> segments;
  const auto looks_for_ten = [&] {
    looks = 0;
    for (int i = 0; i < 10; ++i) {
      const SegmentName name{::geteuid(), id, IfaceType::truth, "model" + std::to_string(segments.size())};
      auto made = Segment::create(name, Geometry{}, {}, Access{});
      EXPECT_TRUE(made) << made.error().message;
      if (made) segments.push_back(std::move(*made));
    }
    return looks.load();
  };
  const int at_first = looks_for_ten();
  EXPECT_GT(at_first, 0);
  while (segments.size() < 400 && !HasFailure()) looks_for_ten();
  // Folders of other tests, which may come at any time, cost a few looks each.
  EXPECT_LT(looks_for_ten(), at_first + 400);
  for (Segment& segment : segments) segment.close();
}

TEST(Segments, of_others_are_not_opened_by_who_looks_for_one_that_is_missing) {
  Fixture there;
  std::vector<std::unique_ptr<IfaceWriter>> ifaces;
  ifaces.push_back(there.make(simulation_spec(simulation_info())));
  for (int i = 0; i < 200; ++i) ifaces.push_back(there.make(iface_spec(IfaceType::laser, "laser" + std::to_string(i), laser_info())));
  const std::uint32_t gone = fresh_server_id();
  opened = 0;
  const auto missing = Iface::open(gone, IfaceType::simulation, "world");
  ASSERT_FALSE(missing);
  EXPECT_NE(missing.error().message.find("not running; running: "), std::string::npos) << missing.error().message;
  // One of each server of this machine, at which other tests may be at work.
  EXPECT_GT(opened, 0);
  EXPECT_LT(opened, 100);
  opened = 0;
  const auto nameless = Iface::open(there.id, IfaceType::laser, "left");
  ASSERT_FALSE(nameless);
  EXPECT_NE(nameless.error().message.find("laser199"), std::string::npos) << nameless.error().message;
  EXPECT_GT(opened, 0);
  EXPECT_LT(opened, 100);
}

// Files with names of another account, and folders as it makes them for names that are taken.
class Squatted {
 public:
  Squatted(uid_t owner, std::uint32_t id, int count) {
    for (int i = 0; i < count; ++i) {
      files_.push_back("/dev/shm/" + SegmentName{owner, id, IfaceType::truth, "model" + std::to_string(i)}.text());
      std::ofstream(files_.back()) << std::flush;
      folders_.push_back("/dev/shm/rtmsim-" + std::to_string(owner) + "." + std::to_string(100'000 + i));
      EXPECT_EQ(::mkdir(folders_.back().c_str(), 0700), 0);
    }
  }
  ~Squatted() {
    for (const auto& file : files_) ::unlink(file.c_str());
    for (const auto& folder : folders_) ::rmdir(folder.c_str());
  }
  Squatted(const Squatted&) = delete;
  Squatted& operator=(const Squatted&) = delete;

 private:
  std::vector<std::string> files_, folders_;
};

TEST(Segments, are_listed_with_one_look_through_the_folder_whatever_others_have_put_there) {
  const std::uint32_t id = fresh_server_id();
  const uid_t other = 1'000'000 + static_cast<uid_t>(::getpid());  // nobody's
  constexpr int count = 200;
  const Squatted squatted(other, id, count);
  looks = 0;
  const auto found = find_segments(id);
  EXPECT_EQ(found.size(), static_cast<std::size_t>(count));
  for (const auto& one : found) EXPECT_FALSE(one.is_readable);
  EXPECT_LT(looks, 5 * count);  // other tests are at work there, too
}

// What was read of the folder before is used again only when nothing has changed there.
TEST(Segments, that_come_and_go_are_listed_at_once) {
  const std::uint32_t id = fresh_server_id();
  const SegmentName name{::geteuid(), id, IfaceType::truth, "model"};
  for (int round = 0; round < 200; ++round) {
    auto made = Segment::create(name, Geometry{}, {}, Access{});
    ASSERT_TRUE(made) << made.error().message;
    const auto pass_time = [&] {  // so long that a list is kept
      if (round % 20 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(60));
    };
    pass_time();
    ASSERT_EQ(find_segments(id).size(), 1U) << round;
    made->close();
    ASSERT_TRUE(find_segments(id).empty()) << round;
    pass_time();
    ASSERT_TRUE(find_segments(id).empty()) << round;
  }
}

}  // namespace
}  // namespace shm::test
