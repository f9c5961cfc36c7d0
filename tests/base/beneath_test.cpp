#include "base/beneath.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>

namespace base {
namespace {

namespace fs = std::filesystem;

class Beneath : public testing::Test {
 protected:
  Beneath() {
    std::string name = testing::TempDir() + "beneath_XXXXXX";
    root_ = ::mkdtemp(name.data());
    fs::create_directories(root_ / "results/row-1");
    std::ofstream(root_ / "results/row-1/picture.png") << "picture";
    std::ofstream(root_ / "secret") << "secret";
  }
  ~Beneath() override { fs::remove_all(root_); }

  std::string read(const std::string& relative, std::size_t most = 100) const {
    const auto bytes = read_beneath(root_ / "results", relative, most);
    return bytes ? *bytes : "error: " + bytes.error().message;
  }
  bool fails_with(const std::string& relative, const std::string& why, std::size_t most = 100) const {
    const auto said = read(relative, most);
    return said.starts_with("error: ") && said.find(why) != std::string::npos;
  }

  fs::path root_;
};

TEST_F(Beneath, a_regular_file_below_the_folder_is_read) {
  EXPECT_EQ(read("row-1/picture.png"), "picture");
  std::ofstream(root_ / "results/empty");
  EXPECT_EQ(read("empty"), "");
}

TEST_F(Beneath, nothing_outside_of_the_folder_is_read) {
  for (const char* path : {"../secret", "row-1/../../secret", "", ".."}) EXPECT_TRUE(fails_with(path, "is not below")) << read(path);
  EXPECT_TRUE(fails_with((root_ / "secret").string(), "is not below"));
}

TEST_F(Beneath, no_link_is_followed) {
  fs::create_symlink(root_ / "secret", root_ / "results/row-1/link");
  fs::create_directory_symlink(root_, root_ / "results/up");
  EXPECT_TRUE(fails_with("row-1/link", "is not a regular file")) << read("row-1/link");
  EXPECT_TRUE(fails_with("up/secret", "is no folder")) << read("up/secret");
}

TEST_F(Beneath, a_device_or_a_pipe_is_refused_without_waiting) {
  ASSERT_EQ(::mkfifo((root_ / "results/pipe").c_str(), 0600), 0);
  EXPECT_TRUE(fails_with("pipe", "is not a regular file")) << read("pipe");
  EXPECT_TRUE(fails_with("row-1", "is not a regular file")) << read("row-1");
  EXPECT_FALSE(check_regular_file("/dev/zero"));
  EXPECT_FALSE(check_regular_file(root_ / "results/pipe"));
}

TEST_F(Beneath, a_file_that_is_too_large_is_refused) {
  fs::resize_file(root_ / "results/row-1/picture.png", 1ULL << 40);
  EXPECT_TRUE(fails_with("row-1/picture.png", "expected at most 100")) << read("row-1/picture.png");
}

TEST_F(Beneath, a_link_that_the_user_names_may_be_followed) {
  fs::create_symlink(root_ / "secret", root_ / "link");
  EXPECT_TRUE(check_regular_file(root_ / "link"));
  EXPECT_FALSE(check_regular_file(root_ / "link", {.follows = false}));
  EXPECT_FALSE(check_regular_file(root_ / "nothing"));
  EXPECT_TRUE(check_regular_file(root_ / "nothing", {.may_be_absent = true}));
}

}  // namespace
}  // namespace base
