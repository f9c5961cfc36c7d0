// The cost of a segment does not grow with those that are there already: a server with thousands of models makes one for each.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>

#include "shm/shm_support.h"

namespace {
std::atomic<int> looks = 0;  // at files of /dev/shm by their path
}

// In place of the C library's, for this program.
extern "C" int lstat(const char* path, struct stat* found) noexcept {
  looks += std::string_view(path).starts_with("/dev/shm/") ? 1 : 0;
  return static_cast<int>(::syscall(SYS_newfstatat, AT_FDCWD, path, found, AT_SYMLINK_NOFOLLOW));
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

}  // namespace
}  // namespace shm::test
