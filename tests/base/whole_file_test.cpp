#include "base/whole_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>

namespace base {
namespace {

namespace fs = std::filesystem;

class WholeFile : public testing::Test {
 protected:
  WholeFile() : folder_(fs::path(testing::TempDir()) / ("whole_file_" + std::to_string(getpid()))) { fs::create_directories(folder_); }
  ~WholeFile() override { fs::remove_all(folder_); }
  static unsigned mode_of(const fs::path& file) {
    struct stat status {};
    return ::stat(file.c_str(), &status) == 0 ? status.st_mode & 07777U : 0;
  }
  static std::string content(const fs::path& file) {
    std::ifstream in(file);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  const fs::path folder_;
};

TEST_F(WholeFile, a_file_that_is_replaced_keeps_its_mode) {
  const auto file = folder_ / "secret.xml";
  for (const unsigned mode : {0600U, 0640U, 0664U}) {
    std::ofstream(file) << "old";
    ASSERT_EQ(::chmod(file.c_str(), mode), 0);
    ASSERT_TRUE(write_whole_file(file, "new"));
    EXPECT_EQ(content(file), "new");
    EXPECT_EQ(mode_of(file), mode);
  }
}

TEST_F(WholeFile, the_file_behind_a_link_keeps_its_mode_and_the_link_stays) {
  const auto file = folder_ / "behind.xml", link = folder_ / "link.xml";
  std::ofstream(file) << "old";
  ASSERT_EQ(::chmod(file.c_str(), 0600), 0);
  fs::create_symlink("behind.xml", link);
  ASSERT_TRUE(write_whole_file(link, "new"));
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_EQ(content(file), "new");
  EXPECT_EQ(mode_of(file), 0600U);
}

TEST_F(WholeFile, a_new_file_has_the_mode_of_new_files) {
  const auto file = folder_ / "new.xml", usual = folder_ / "usual";
  std::ofstream(usual) << "x";
  ASSERT_TRUE(write_whole_file(file, "new"));
  EXPECT_EQ(mode_of(file), mode_of(usual));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 2);  // nothing is left behind
}

TEST_F(WholeFile, pipes_and_folders_are_not_replaced) {
  const auto pipe = folder_ / "pipe", link = folder_ / "link";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  fs::create_symlink("pipe", link);
  for (const auto& file : {pipe, link, folder_}) {
    EXPECT_FALSE(write_whole_file(file, "new")) << file;
    EXPECT_FALSE(replaceable_file(file)) << file;
  }
  EXPECT_TRUE(fs::is_fifo(pipe));
  const auto missing = folder_ / "missing", to_missing = folder_ / "to_missing";
  fs::create_symlink("missing", to_missing);
  EXPECT_EQ(*replaceable_file(to_missing), missing);
}

}  // namespace
}  // namespace base
