// Folders for temporary files: nobody else reads or prepares them, and what killed processes left is removed.
#include "base/scratch_folder.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <utility>

namespace base {
namespace {

namespace fs = std::filesystem;

class Scratch : public testing::Test {
 protected:
  Scratch() {
    std::string name = testing::TempDir() + "scratch_XXXXXX";
    where_ = ::mkdtemp(name.data());
  }
  ~Scratch() override { fs::remove_all(where_); }

  ScratchFolder made() const {
    auto folder = ScratchFolder::make("run-", where_);
    EXPECT_TRUE(folder) << folder.error().message;
    return std::move(*folder);
  }
  // Makes one in a process that is killed then.
  void leave_one() const {
    const pid_t child = ::fork();
    if (child == 0) {
      const auto folder = made();
      std::ofstream(folder.path() + "/file") << "left";
      ::kill(::getpid(), SIGKILL);
    }
    ::waitpid(child, nullptr, 0);
  }
  std::size_t count() const { return static_cast<std::size_t>(std::distance(fs::directory_iterator(where_), fs::directory_iterator())); }

  std::string where_;
};

TEST_F(Scratch, is_for_its_account_alone_whatever_the_umask) {
  const mode_t before = ::umask(0);
  const auto folder = made();
  ::umask(before);
  struct stat status {};
  ASSERT_EQ(::lstat(folder.path().c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 07777, 0700U);
}

TEST_F(Scratch, is_never_a_folder_that_was_there) {
  fs::create_directory(where_ + "/run-" + std::to_string(::getpid()));
  const auto folder = made(), other = made();
  EXPECT_NE(folder.path(), other.path());
  EXPECT_EQ(count(), 3U);
}

TEST_F(Scratch, is_gone_with_its_object_and_stays_when_it_was_given_away) {
  std::string path;
  {
    auto folder = made();
    path = folder.path();
    const auto moved = std::move(folder);
    EXPECT_TRUE(fs::exists(path));
  }
  EXPECT_FALSE(fs::exists(path));
  auto folder = made();
  path = folder.path();
  folder.give_away();
  EXPECT_TRUE(fs::exists(path));
}

TEST_F(Scratch, what_a_killed_process_left_is_removed_and_what_another_uses_stays) {
  const auto used = made();
  leave_one();
  EXPECT_EQ(count(), 2U);
  const auto next = made();
  EXPECT_EQ(count(), 2U);
  EXPECT_TRUE(fs::exists(used.path()));
}

TEST_F(Scratch, folders_of_other_accounts_and_links_are_left_alone) {
  leave_one();
  const fs::path left = fs::directory_iterator(where_)->path();
  if (::chown(left.c_str(), 65534, 65534) != 0) GTEST_SKIP() << "only root can give a folder to another account";
  const std::string target = where_ + "/target";
  fs::create_directory(target);
  std::ofstream(target + "/lock");
  fs::create_directory_symlink(target, where_ + "/run-link");
  const auto next = made();
  EXPECT_TRUE(fs::exists(left / "file"));
  EXPECT_TRUE(fs::exists(target + "/lock"));
}

TEST_F(Scratch, a_place_that_is_missing_is_named) {
  const auto folder = ScratchFolder::make("run-", where_ + "/no");
  ASSERT_FALSE(folder);
  EXPECT_NE(folder.error().message.find(where_ + "/no\""), std::string::npos) << folder.error().message;
}

}  // namespace
}  // namespace base
