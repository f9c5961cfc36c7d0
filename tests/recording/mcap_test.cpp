#include "recording/mcap/mcap.h"

#include <gtest/gtest.h>
#include <malloc.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

namespace mcap {
namespace {

namespace fs = std::filesystem;

class Recording : public testing::TestWithParam<Compression> {
 protected:
  Recording() : path_((fs::path(testing::TempDir()) / ("mcap_test_" + std::to_string(getpid()) + ".mcap")).string()) {}
  ~Recording() override {
    fs::remove(path_);
    fs::remove(path_ + ".again");
  }

  std::string octets() const {
    std::ifstream in(path_, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  void put(const std::string& octets) const { std::ofstream(path_, std::ios::binary) << octets; }

  // Two channels; message n of channel 1 at n ms and of channel 2 at n + 0.5 ms.
  void record(int messages, WriterOptions options = {}, bool is_closed = true) {
    auto writer = Writer::create(path_, options);
    ASSERT_TRUE(writer) << writer.error().message;
    const auto schema = writer->add_schema("RTC::TimedLong", "omgidl", "struct TimedLong { long data; };");
    const auto first = writer->add_channel(*schema, "/a/out", "cdr", {{"component", "a"}, {"port", "out"}});
    const auto second = writer->add_channel(0, "/log", "json");
    ASSERT_TRUE(first && second);
    for (int n = 0; n < messages; ++n) {
      const std::string data = "message " + std::to_string(n);
      const auto sequence = static_cast<std::uint32_t>(n);
      ASSERT_TRUE(writer->write({*first, sequence, Time(n * 1'000'000), Time(7), data}));
      ASSERT_TRUE(writer->write({*second, sequence, Time(n * 1'000'000 + 500'000), Time(8), ""}));
    }
    ASSERT_TRUE(writer->attach({Time(1), Time(2), "system.xml", "application/xml", "<rts/>"}));
    ASSERT_TRUE(writer->add_metadata({"run", {{"seed", "7"}}}));
    if (!is_closed) {
      ASSERT_TRUE(writer->write({*first, 77, Time(77), Time(7), "not flushed"}));
      abandoned_ = octets();
    }
    ASSERT_TRUE(writer->close());
  }

  // "topic time data" of every message, and errors.
  std::vector<std::string> read(const Query& query = {}) {
    auto reader = Reader::open(path_);
    if (!reader) return {reader.error().message};
    reader->seek(query);
    std::vector<std::string> lines;
    while (lines.size() < 100'000) {
      auto message = reader->next();
      if (!message) {
        lines.push_back(message.error().message);
        continue;
      }
      if (!message->has_value()) break;
      const Message& one = **message;
      lines.push_back(reader->channels().at(one.channel).topic + " " + std::to_string(one.log_time.count()) + " " + std::string(one.data));
    }
    return lines;
  }

  const std::string path_;
  std::string abandoned_;  // what a killed writer leaves
};

TEST_P(Recording, gives_back_what_was_written) {
  record(3, {.profile = "rtm", .compression = GetParam(), .chunk_size = 64});
  const std::vector<std::string> expected = {"/a/out 0 message 0",       "/log 500000 ", "/a/out 1000000 message 1", "/log 1500000 ",
                                             "/a/out 2000000 message 2", "/log 2500000 "};
  EXPECT_EQ(read(), expected);
  auto reader = Reader::open(path_);
  ASSERT_TRUE(reader) << reader.error().message;
  EXPECT_FALSE(reader->damage().has_value());
  EXPECT_EQ(reader->profile(), "rtm");
  EXPECT_EQ(reader->schemas().at(1).data, "struct TimedLong { long data; };");
  EXPECT_EQ(reader->channels().at(1).metadata, (Texts{{"component", "a"}, {"port", "out"}}));
  EXPECT_EQ(reader->statistics().messages, 6U);
  EXPECT_EQ(reader->statistics().last, Time(2'500'000));
  const auto attachment = reader->attachment("system.xml");
  ASSERT_TRUE(attachment) << attachment.error().message;
  EXPECT_EQ(attachment->data, "<rts/>");
  EXPECT_EQ(reader->attachment("none").error().message, "\"" + path_ + "\": has no attachment \"none\"");
  const auto metadata = reader->metadata();
  ASSERT_TRUE(metadata && metadata->size() == 1);
  EXPECT_EQ(metadata->front().texts, (Texts{{"seed", "7"}}));
}

// Bit by bit, from the definition of CRC-32.
std::uint32_t slow_crc(std::string_view octets) {
  std::uint32_t crc = 0xffffffff;
  for (const char c : octets) {
    crc ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ (crc & 1 ? 0xedb88320 : 0);
  }
  return ~crc;
}

TEST_P(Recording, the_end_of_the_data_has_the_crc_of_all_before_it) {
  record(5, {.compression = GetParam(), .chunk_size = 64});
  const std::string whole = octets();
  std::size_t offset = 8;
  std::uint64_t length = 0;
  for (; whole[offset] != 15; offset += 9 + length) std::memcpy(&length, whole.data() + offset + 1, sizeof length);
  std::uint32_t crc = 0;
  std::memcpy(&crc, whole.data() + offset + 9, sizeof crc);
  EXPECT_EQ(crc, slow_crc(std::string_view(whole).substr(0, offset)));
}

INSTANTIATE_TEST_SUITE_P(, Recording, testing::Values(Compression::none, Compression::lz4, Compression::zstd));

class Single : public Recording {};
INSTANTIATE_TEST_SUITE_P(, Single, testing::Values(Compression::zstd));

TEST_P(Single, a_query_gives_the_times_and_channels_asked_for) {
  record(100, {.chunk_size = 500});
  EXPECT_EQ(read({{1}, Time(10'000'000), Time(11'000'000)}),
            (std::vector<std::string>{"/a/out 10000000 message 10", "/a/out 11000000 message 11"}));
  EXPECT_TRUE(read({{}, Time(100'000'000), Time(UINT64_MAX)}).empty());
  EXPECT_TRUE(read({{9}, Time(0), Time(UINT64_MAX)}).empty());
}

TEST_P(Single, messages_come_in_the_order_of_time_whatever_their_order_in_the_file) {
  auto writer = Writer::create(path_, {.chunk_size = 40});
  const auto channel = writer->add_channel(0, "t", "json");
  for (const int time : {5, 3, 9, 1, 7, 3}) ASSERT_TRUE(writer->write({*channel, 0, Time(time), Time(0), "x"}));
  ASSERT_TRUE(writer->close());
  EXPECT_EQ(read(), (std::vector<std::string>{"t 1 x", "t 3 x", "t 3 x", "t 5 x", "t 7 x", "t 9 x"}));
}

TEST_P(Single, what_a_killed_writer_had_flushed_is_read_and_repaired) {
  record(10, {}, false);
  put(abandoned_);
  EXPECT_EQ(read().size(), 20U);
  auto reader = Reader::open(path_);
  ASSERT_TRUE(reader->damage().has_value());
  EXPECT_NE(reader->damage()->find("its writer did not close it"), std::string::npos) << *reader->damage();

  const auto repaired = repair(path_, path_);
  ASSERT_TRUE(repaired) << repaired.error().message;
  EXPECT_EQ(repaired->messages, 20U);
  EXPECT_EQ(repaired->octets_lost, 0U);
  auto again = Reader::open(path_);
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_FALSE(again->damage().has_value());
  EXPECT_EQ(again->statistics().messages_of.at(1), 10U);
  EXPECT_EQ(again->attachments().size(), 1U);
  EXPECT_EQ(read().size(), 20U);
  const auto whole = repair(path_, path_);
  ASSERT_TRUE(whole) << whole.error().message;
  EXPECT_EQ(whole->octets_lost, 0U) << "the summary is made anew, and nothing is lost";
  EXPECT_FALSE(whole->damage.has_value());
}

TEST_P(Single, a_channel_without_messages_outlives_its_killed_writer) {
  std::string left;
  {
    auto writer = Writer::create(path_);
    const auto channel = writer->add_channel(0, "/loud", "json");
    ASSERT_TRUE(writer->add_channel(0, "/silent", "json"));
    ASSERT_TRUE(writer->write({*channel, 0, Time(1), Time(1), "{}"}) && writer->flush());
    left = octets();
  }
  put(left);
  const auto repaired = repair(path_, path_);
  ASSERT_TRUE(repaired) << repaired.error().message;
  auto reader = Reader::open(path_);
  ASSERT_TRUE(reader) << reader.error().message;
  EXPECT_FALSE(reader->damage().has_value());
  EXPECT_EQ(reader->channels().size(), 2U);
}

TEST_P(Single, a_file_that_is_cut_anywhere_is_read_up_to_there) {
  record(4, {.chunk_size = 60});
  const std::string whole = octets();
  std::size_t before = 0;
  for (std::size_t length = 0; length < whole.size(); ++length) {
    put(whole.substr(0, length));
    auto reader = Reader::open(path_);
    if (!reader) {
      EXPECT_LT(length, 40U) << reader.error().message;  // not even a header
      continue;
    }
    const std::size_t messages = reader->statistics().messages;
    EXPECT_GE(messages, before) << "cut at " << length;
    EXPECT_TRUE(reader->damage().has_value()) << "cut at " << length;
    before = messages;
    const auto repaired = repair(path_, path_ + ".again");
    ASSERT_TRUE(repaired) << repaired.error().message;
    auto again = Reader::open(path_ + ".again");
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_EQ(again->statistics().messages, messages) << "cut at " << length;
    EXPECT_FALSE(again->damage().has_value()) << *again->damage();
  }
  EXPECT_EQ(before, 8U);
}

TEST_P(Single, a_flipped_octet_in_a_chunk_costs_that_chunk_alone_and_is_told) {
  record(50, {.chunk_size = 200});
  std::string broken = octets();
  const auto place = broken.find("zstd") + 4 + 8 + 12;  // behind the length, within the compressed octets
  broken[place] = static_cast<char>(broken[place] ^ 0x55);
  put(broken);
  const auto lines = read();
  const auto errors =
      std::count_if(lines.begin(), lines.end(), [](const std::string& line) { return line.find("the chunk") != std::string::npos; });
  EXPECT_EQ(errors, 1);
  EXPECT_GT(lines.size(), 90U);
}

TEST_P(Single, times_of_messages_are_known_without_their_chunks) {
  record(50, {.chunk_size = 200});
  const auto times = [&] {
    std::map<std::uint16_t, std::vector<std::uint64_t>> all;
    auto reader = Reader::open(path_);
    if (!reader->for_each_time([&](std::uint16_t channel, Time time) { all[channel].push_back(time.count()); })) all.clear();
    return all;
  };
  std::map<std::uint16_t, std::vector<std::uint64_t>> expected;
  for (std::uint64_t n = 0; n < 50; ++n) {
    expected[1].push_back(n * 1'000'000);
    expected[2].push_back(n * 1'000'000 + 500'000);
  }
  EXPECT_EQ(times(), expected);

  std::string broken = octets();
  const auto place = broken.find("zstd") + 24;
  broken[place] = static_cast<char>(broken[place] ^ 0x55);
  put(broken);
  EXPECT_EQ(times(), expected) << "a broken chunk is not looked at";

  // The first message index of the first chunk becomes a record that nobody knows.
  std::uint64_t length = 0;
  const auto chunk = broken.find("zstd") - 4 - 4 - 3 * 8 - 9;
  std::memcpy(&length, broken.data() + chunk + 1, sizeof length);
  const auto index = chunk + 9 + length;
  ASSERT_EQ(broken[index], 7);
  broken[index] = 99;
  put(broken);
  EXPECT_TRUE(times().empty());
}

TEST_P(Single, a_repair_says_what_a_broken_chunk_costs_and_keeps_the_others) {
  record(50, {.chunk_size = 200});
  std::string broken = octets();
  const auto place = broken.find("zstd");  // of the first chunk, which alone describes the channels
  broken[place + 24] = static_cast<char>(broken[place + 24] ^ 0x55);
  put(broken);
  std::uint64_t length = 0;
  const auto start = place - 4 - 4 - 3 * 8 - 9;
  std::memcpy(&length, broken.data() + start + 1, sizeof length);

  const auto repaired = repair(path_, path_);
  ASSERT_TRUE(repaired) << repaired.error().message;
  EXPECT_EQ(repaired->broken_chunks, 1U);
  EXPECT_EQ(repaired->octets_lost, 9 + length);
  ASSERT_TRUE(repaired->messages_lost.has_value());
  EXPECT_GT(*repaired->messages_lost, 0U);
  EXPECT_EQ(repaired->messages + *repaired->messages_lost, 100U);
  EXPECT_NE(repaired->damage->find("the chunk"), std::string::npos) << *repaired->damage;
  const auto lines = read();
  EXPECT_EQ(lines.size(), repaired->messages) << lines.front();
  EXPECT_EQ(lines.back(), "/log 49500000 ");
  EXPECT_TRUE(Reader::open(path_)->damage().has_value()) << "its octets stay, and are told";
}

// Whatever bit of a file is flipped: a repair keeps what a reader gives, and says so when anything is lost.
TEST_P(Single, a_repair_of_a_flipped_bit_never_costs_what_could_be_read) {
  record(6, {.chunk_size = 100});
  const std::string whole = octets();
  const auto all_of = [](const std::string& path) {
    auto reader = Reader::open(path);
    if (!reader) return std::pair(std::uint64_t{0}, std::string());
    std::uint64_t messages = 0;
    std::string all;
    for (;;) {
      const auto message = reader->next();
      if (!message) continue;
      if (!message->has_value()) break;
      ++messages;
      all += std::to_string((*message)->log_time.count()) + std::string((*message)->data) + "\n";
    }
    if (const auto attachment = reader->attachment("system.xml")) all += attachment->data;
    for (std::size_t n = 0; n < reader->metadata_count(); ++n) {
      if (const auto one = reader->metadata(n)) all += one->name + one->texts.begin()->first + one->texts.begin()->second;
    }
    return std::pair(messages, all);
  };
  const auto expected = all_of(path_).second;
  for (std::size_t n = 8; n < whole.size(); ++n) {
    for (const int bit : {0, 3, 7}) {
      std::string broken = whole;
      broken[n] = static_cast<char>(broken[n] ^ (1 << bit));
      put(broken);
      const auto [messages, before] = all_of(path_);
      const auto repaired = repair(path_, path_ + ".again");
      const auto place = "bit " + std::to_string(bit) + " of octet " + std::to_string(n);
      if (!repaired) {
        EXPECT_EQ(messages, 0U) << place << ": " << repaired.error().message;
        continue;
      }
      const auto [kept, after] = all_of(path_ + ".again");
      EXPECT_GE(kept, messages) << place;
      EXPECT_EQ(kept, repaired->messages) << place;
      if (!repaired->has_losses()) {
        EXPECT_EQ(after, expected) << place;
      }
    }
  }
}

TEST_P(Single, a_repair_after_a_flipped_length_keeps_all_samples) {
  record(50, {.chunk_size = 200});
  std::string broken = octets();
  const auto place = broken.find("system.xml") - 4 - 16 - 8;  // the length of the attachment
  broken[place + 2] = static_cast<char>(broken[place + 2] ^ 1);
  put(broken);
  EXPECT_EQ(read().size(), 100U);
  const auto repaired = repair(path_, path_);
  ASSERT_TRUE(repaired) << repaired.error().message;
  EXPECT_EQ(repaired->messages, 100U);
  EXPECT_FALSE(repaired->has_losses());
  EXPECT_EQ(read().size(), 100U);
  EXPECT_FALSE(Reader::open(path_)->damage().has_value());
  EXPECT_EQ(Reader::open(path_)->attachment("system.xml")->data, "<rts/>");
}

TEST_P(Single, a_repair_tells_of_attachments_and_metadata_that_are_lost) {
  record(10);
  std::string broken = octets();
  const auto attachment = broken.find("<rts/>");
  broken[attachment] = static_cast<char>(broken[attachment] ^ 1);
  const auto metadata = broken.find("\x03\0\0\0run", attachment, 7) - 9;
  ASSERT_EQ(broken[metadata], 12);
  broken[metadata] = 44;
  put(broken);
  const auto repaired = repair(path_, path_);
  ASSERT_TRUE(repaired) << repaired.error().message;
  EXPECT_EQ(repaired->attachments_lost, 1U);
  EXPECT_EQ(repaired->metadata_lost, 1U);
  EXPECT_GT(repaired->octets_lost, 0U);
  EXPECT_TRUE(repaired->has_losses());
  auto again = Reader::open(path_);
  EXPECT_FALSE(again->damage().has_value()) << *again->damage();
  EXPECT_EQ(again->attachments().size() + again->metadata_count(), 0U);
  EXPECT_EQ(read().size(), 20U);
}

TEST_P(Single, a_file_that_is_being_written_is_not_begun_again) {
  auto writer = Writer::create(path_);
  ASSERT_TRUE(writer->add_channel(0, "t", "json"));
  const auto size = octets().size();
  const auto other = Writer::create(path_);
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().message, "\"" + path_ + "\": is being written by another process");
  EXPECT_EQ(repair(path_, path_).error().message, other.error().message);
  EXPECT_EQ(octets().size(), size);
}

TEST_P(Single, a_chunk_bomb_is_refused_without_memory) {
  // Zeros compress a thousand times; the length that the chunk announces is a lie.
  auto writer = Writer::create(path_, {.compression = Compression::zstd, .chunk_size = 64 << 20});
  const auto channel = writer->add_channel(0, "zeros", "");
  ASSERT_TRUE(writer->write({*channel, 0, Time(0), Time(0), std::string(32 << 20, '\0')}));
  ASSERT_TRUE(writer->close());
  std::string bomb = octets();
  const std::uint64_t huge = 1ull << 62;
  const auto chunk = bomb.find("\x04\x00\x00\x00zstd", 0, 8) - 4 - 8;
  std::memcpy(bomb.data() + chunk, &huge, sizeof huge);
  put(bomb);
  const auto lines = read();
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_NE(lines[0].find("announces 4611686018427387904 bytes; at most 134217728 are read"), std::string::npos) << lines[0];
  const std::uint64_t small = 1000;
  std::memcpy(bomb.data() + chunk, &small, sizeof small);
  put(bomb);
  EXPECT_NE(read().at(0).find("does not decompress to the 1000 bytes"), std::string::npos) << read().at(0);
}

// Heap [bytes] of a reader of `rounds` chunks of 2000 channels.
std::size_t held_by_reader(const std::string& path, int rounds, bool is_closed) {
  constexpr std::uint16_t channels = 2000;
  const auto heap = [] {
    const auto all = mallinfo2();
    return all.uordblks + all.hblkhd;
  };
  auto writer = Writer::create(path, {.compression = Compression::none});
  for (int n = 0; n < channels; ++n) (void)writer->add_channel(0, "t", "");
  for (int round = 0; round < rounds; ++round) {
    for (std::uint16_t channel = 1; channel <= channels; ++channel) (void)writer->write({channel, 0, Time(round), Time(0), ""});
    (void)writer->flush();
  }
  if (is_closed) (void)writer->close();
  const auto before = heap();
  const auto reader = Reader::open(path);
  EXPECT_TRUE(reader && reader->statistics().chunks == static_cast<std::uint32_t>(rounds));
  EXPECT_EQ(reader->damage().has_value(), !is_closed);
  return heap() - before;
}

TEST_P(Single, a_reader_of_a_long_recording_holds_little_for_each_chunk) {
  constexpr std::size_t most = 500;  // [bytes] of a chunk; an offset for each channel would take 32,000
  if (mallinfo2().uordblks == 0) GTEST_SKIP() << "the allocator of a sanitizer does not count";
  for (const bool is_closed : {true, false}) {
    const auto of_20 = held_by_reader(path_, 20, is_closed);
    const auto of_120 = held_by_reader(path_, 120, is_closed);
    EXPECT_LT(of_120, of_20 + 100 * most) << (is_closed ? "with" : "without") << " a summary; 20 chunks: " << of_20;
  }
}

TEST_P(Single, what_is_no_recording_is_refused_with_one_line) {
  put("hello");
  EXPECT_EQ(read(), (std::vector<std::string>{"\"" + path_ + "\": is not an MCAP file: it does not start with the magic bytes"}));
  EXPECT_NE(Reader::open("/dev/null").error().message.find("is not a regular file"), std::string::npos);
  EXPECT_NE(Reader::open("/no/such/file").error().message.find("no such file"), std::string::npos);
  EXPECT_NE(Writer::create("/no/such/file").error().message.find("cannot be written"), std::string::npos);
  EXPECT_NE(Writer::create("/dev/null").error().message.find("is not a regular file"), std::string::npos);
}

TEST_P(Single, a_full_disk_ends_the_file_at_its_last_whole_record) {
  auto writer = Writer::create(path_, {.compression = Compression::none, .chunk_size = 1000});
  const auto channel = writer->add_channel(0, "t", "");
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  signal(SIGXFSZ, SIG_IGN);
  const rlimit small{5'500, before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);
  base::Result<void> done;
  for (int n = 0; n < 100 && done; ++n) done = writer->write({*channel, 0, Time(n), Time(0), std::string(100, 'x')});
  setrlimit(RLIMIT_FSIZE, &before);
  ASSERT_FALSE(done);
  EXPECT_NE(done.error().message.find("cannot be written: File too large"), std::string::npos) << done.error().message;
  EXPECT_EQ(writer->close().error().message, done.error().message);
  auto reader = Reader::open(path_);
  ASSERT_TRUE(reader) << reader.error().message;
  EXPECT_GE(reader->statistics().messages, 30U);
  EXPECT_NE(reader->damage()->find("its writer did not close it"), std::string::npos) << *reader->damage();
}

}  // namespace
}  // namespace mcap
