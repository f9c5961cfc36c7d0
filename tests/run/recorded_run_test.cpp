#include "run/recorded_run.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

namespace recorder {
namespace {

namespace fs = std::filesystem;

constexpr const char* world_text = "<sdf version='1.9'><world name='w'/></sdf>";

class RecordedRunTest : public testing::Test {
 protected:
  RecordedRunTest() {
    std::string pattern = (fs::temp_directory_path() / "recorded-run-XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
  }
  ~RecordedRunTest() override { fs::remove_all(folder_); }

  // Of a run of the world file `name`.
  std::string record(const fs::path& name) const {
    const auto file = (folder_ / "run.mcap").string();
    auto writer = mcap::Writer::create(file);
    EXPECT_TRUE(writer && writer->attach({mcap::Time(0), mcap::Time(0), "system.xml", "application/xml", "<rts/>"}) &&
                writer->attach({mcap::Time(0), mcap::Time(0), "world.sdf", "application/xml", world_text}) &&
                writer->add_metadata({"run", {{"world_file", name.string()}}}) && writer->close());
    return file;
  }
  // Bytes that this process has read from files so far.
  static std::uint64_t bytes_read() {
    std::ifstream in("/proc/self/io");
    std::string word;
    std::uint64_t count = 0;
    in >> word >> count;
    return count;
  }

  fs::path folder_;
};

TEST_F(RecordedRunTest, a_world_file_that_is_still_the_recorded_one_is_used_where_it_is) {
  const auto world = folder_ / "w.sdf";
  std::ofstream(world) << world_text;
  const auto run = RecordedRun::unpack(record(world));
  ASSERT_TRUE(run) << run.error().message;
  EXPECT_EQ(run->world(), world);
}

TEST_F(RecordedRunTest, a_world_file_with_another_content_is_replaced_by_the_recorded_one) {
  const auto world = folder_ / "w.sdf";
  std::ofstream(world) << std::string(std::string(world_text).size(), ' ');
  const auto run = RecordedRun::unpack(record(world));
  ASSERT_TRUE(run) << run.error().message;
  EXPECT_NE(run->world(), world);
  EXPECT_TRUE(fs::exists(run->world()));
}

// The recording chooses the file's name: whatever it names, no more is read than the recorded world has.
TEST_F(RecordedRunTest, a_file_that_a_recording_names_is_read_only_as_far_as_the_recorded_world_is_long) {
  const auto large = folder_ / "large";
  std::ofstream(large) << "x";
  fs::resize_file(large, std::uintmax_t{64} << 20U);
  for (const fs::path& named : {large, fs::path("/dev/zero"), folder_, fs::path("/proc/kmsg")}) {
    const auto recording = record(named);
    const auto before = bytes_read();
    const auto run = RecordedRun::unpack(recording);
    ASSERT_TRUE(run) << run.error().message;
    EXPECT_NE(run->world(), named);
    EXPECT_LT(bytes_read() - before, std::uint64_t{1} << 20U) << named;
  }
}

}  // namespace
}  // namespace recorder
