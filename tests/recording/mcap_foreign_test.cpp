// Recordings that a library of another maker wrote (tests/foreign, from npm).
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "recording/mcap/mcap.h"
#include "support/paths.h"

namespace mcap {
namespace {

class Foreign : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directory(folder_);
    const std::string command = "node " + std::string(paths::source_dir) + "/tests/foreign/write.mjs " + folder_;
    ASSERT_EQ(std::system(command.c_str()), 0) << command;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  // What every one of these files holds.
  void expect_all(const std::string& name) {
    auto reader = Reader::open(folder_ + "/" + name);
    ASSERT_TRUE(reader) << reader.error().message;
    EXPECT_FALSE(reader->damage().has_value()) << *reader->damage();
    EXPECT_EQ(reader->library(), "another");
    EXPECT_EQ(reader->statistics().messages, 100U);
    EXPECT_EQ(reader->schemas().begin()->second.name, "numbers");
    for (int n = 0; n < 100; ++n) {
      const auto message = reader->next();
      ASSERT_TRUE(message && message->has_value()) << n;
      EXPECT_EQ((*message)->log_time, Time(static_cast<std::uint64_t>(n) * 1000));
      EXPECT_EQ((*message)->data, "{\"n\":" + std::to_string(n ^ 3) + "}");
      EXPECT_EQ(reader->channels().at((*message)->channel).topic, (n ^ 3) % 2 == 0 ? "/a" : "/b");
    }
    const auto end = reader->next();
    EXPECT_TRUE(end && !end->has_value());
    const auto note = reader->attachment("note");
    ASSERT_TRUE(note) << note.error().message;
    EXPECT_EQ(note->data, "hello");
    const auto metadata = reader->metadata();
    ASSERT_TRUE(metadata && metadata->size() == 1);
    EXPECT_EQ(metadata->front().texts.at("seed"), "3");
  }

  const std::string folder_ = testing::TempDir() + "mcap_foreign_" + std::to_string(getpid());
};

TEST_F(Foreign, a_file_with_chunks_and_summary_is_read) { expect_all("chunks.mcap"); }
TEST_F(Foreign, a_file_without_chunks_is_read) { expect_all("no_chunks.mcap"); }
TEST_F(Foreign, a_file_without_any_index_is_read) { expect_all("bare.mcap"); }

TEST_F(Foreign, a_repair_keeps_a_channel_that_the_summary_alone_has) {
  const std::string file = folder_ + "/silent.mcap";
  ASSERT_EQ(Reader::open(file)->channels().size(), 3U);
  const auto repaired = repair(file, file);
  ASSERT_TRUE(repaired) << repaired.error().message;
  auto reader = Reader::open(file);
  ASSERT_TRUE(reader) << reader.error().message;
  EXPECT_EQ(reader->channels().size(), 3U);
  EXPECT_EQ(reader->statistics().channels, 3U);
  expect_all("silent.mcap");
}

TEST_F(Foreign, reads_our_file_whose_last_chunk_has_channels_alone) {
  const std::string file = folder_ + "/ours.mcap";
  auto writer = Writer::create(file);
  ASSERT_TRUE(writer) << writer.error().message;
  const auto schema = writer->add_schema("numbers", "jsonschema", "{}");
  const auto channel = writer->add_channel(*schema, "/a", "json");
  ASSERT_TRUE(writer->write({*channel, 0, Time(5), Time(5), "{}"}) && writer->flush());
  ASSERT_TRUE(writer->add_channel(*schema, "/silent", "json") && writer->close());
  const std::string command = "node " + std::string(paths::source_dir) + "/tests/foreign/read.mjs " + file + " > " + folder_ + "/read";
  EXPECT_EQ(std::system(command.c_str()), 0) << command;
}

}  // namespace
}  // namespace mcap
