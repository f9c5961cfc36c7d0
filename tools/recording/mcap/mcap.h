// MCAP files (https://mcap.dev/spec, version 0 of the format): one writer, one reader and the repair of files that were cut off.
// Times are nanoseconds since whatever the file counts from; recordings of rtm-sim count simulated time. An object belongs to one thread
// at a time. Errors are one line that names the file and the byte.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace mcap {

using Time = std::chrono::duration<std::uint64_t, std::nano>;
using Texts = std::map<std::string, std::string>;

struct Schema {
  std::uint16_t id = 0;  // 0 is no schema
  std::string name;
  std::string encoding;  // "omgidl", "ros2msg", "jsonschema", ...
  std::string data;
};

struct Channel {
  std::uint16_t id = 0;
  std::uint16_t schema = 0;
  std::string topic;
  std::string encoding;  // of its messages: "cdr", "json", ...
  Texts metadata;
};

struct Message {
  std::uint16_t channel = 0;
  std::uint32_t sequence = 0;
  Time log_time{0};
  Time publish_time{0};
  std::string_view data;  // of a reader: until its next call
};

struct Attachment {
  Time log_time{0};
  Time create_time{0};
  std::string name;
  std::string media_type;
  std::string data;
};

struct Metadata {
  std::string name;
  Texts texts;
};

struct Statistics {
  std::uint64_t messages = 0;
  std::uint16_t schemas = 0;
  std::uint32_t channels = 0;
  std::uint32_t attachments = 0;
  std::uint32_t metadata = 0;
  std::uint32_t chunks = 0;
  Time first{0};  // log times; 0 without messages
  Time last{0};
  std::map<std::uint16_t, std::uint64_t> messages_of;  // by channel
};

enum class Compression { none, lz4, zstd };

struct WriterOptions {
  std::string profile{};  // "ros2" or nothing: which conventions its topics keep
  Compression compression = Compression::zstd;
  std::size_t chunk_size = std::size_t{1} << 20U;  // [bytes] a chunk is closed when it has grown to this
};

// Writes front to back and never reads. What is in closed chunks survives the end of the process; close() adds the summary by which readers
// find their way. After a failure to write, the file is cut back to its last whole record and every call fails with the same error.
class Writer final {
 public:
  // The file must not exist, or be a regular file, which is replaced.
  static base::Result<Writer> create(const std::string& path, const WriterOptions& options = {});
  Writer(Writer&&) noexcept;
  Writer& operator=(Writer&&) noexcept;
  ~Writer();  // closes

  // At most 65535 of each. The ids are given by the writer.
  base::Result<std::uint16_t> add_schema(std::string name, std::string encoding, std::string data);
  base::Result<std::uint16_t> add_channel(std::uint16_t schema, std::string topic, std::string encoding, Texts metadata = {});
  base::Result<void> write(const Message& message);
  base::Result<void> attach(const Attachment& attachment);
  base::Result<void> add_metadata(const Metadata& metadata);
  // Closes the chunk that is being filled.
  base::Result<void> flush();
  base::Result<void> close();

  // [bytes] in the file and in the open chunk, before its compression.
  std::uint64_t size() const;
  const Statistics& statistics() const;

 private:
  struct State;
  explicit Writer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

struct Query {
  std::vector<std::uint16_t> channels;  // none: all
  Time from{0};
  Time to{UINT64_MAX};  // the last moment that counts
};

// Takes every valid file: with chunks or without, with or without a summary. Memory stays below twice the file or 256 MiB.
class Reader final {
 public:
  static constexpr std::uint64_t largest_chunk = 128ull << 20;  // [bytes] decompressed

  // Reads the summary. Without one the whole file is scanned, up to the first record that is not whole: `damage` says where that is.
  static base::Result<Reader> open(const std::string& path);
  Reader(Reader&&) noexcept;
  Reader& operator=(Reader&&) noexcept;
  ~Reader();

  const std::string& profile() const;
  const std::string& library() const;
  const std::map<std::uint16_t, Schema>& schemas() const;
  const std::map<std::uint16_t, Channel>& channels() const;
  const Statistics& statistics() const;
  // One line on what could not be read; nothing when the file is whole.
  const std::optional<std::string>& damage() const;

  struct AttachmentEntry {
    std::string name;
    std::string media_type;
    std::uint64_t size = 0;  // [bytes]
    Time log_time{0};
  };
  std::vector<AttachmentEntry> attachments() const;
  // The first one of that name.
  base::Result<Attachment> attachment(const std::string& name);
  base::Result<Attachment> attachment(std::size_t number);  // of those of attachments()
  base::Result<std::vector<Metadata>> metadata();
  std::size_t metadata_count() const;
  base::Result<Metadata> metadata(std::size_t number);

  // What a file without a summary has and open() could not read; the indexes of broken chunks say of how many messages.
  struct Unread {
    std::uint64_t octets = 0;
    std::uint64_t messages = 0;
    bool are_counted = true;  // no message is missing in the number
  };
  Unread unread() const;

  // [bytes] of all chunks.
  std::uint64_t uncompressed() const;
  // Channel and time of each message as the indexes of the chunks say, of each chunk in the order of channels and times; no chunk is
  // decompressed. False when they are not whole, or are not of as many messages as the summary says: what was told counts for nothing then.
  bool for_each_time(const std::function<void(std::uint16_t channel, Time time)>& take) const;

  // Starts over: next() gives the messages of the query in the order of their log times, and of the file where these are equal.
  void seek(Query query = {});
  // A chunk that cannot be read is an error, and the call after it goes on behind the chunk.
  base::Result<std::optional<Message>> next();

  struct BrokenChunk {
    Time first{0}, last{0};  // of its messages
    std::string problem;     // names the file and the octet
  };
  // From now on next() leaves out chunks that cannot be read, and notes each of them once.
  void leave_out_broken_chunks();
  const std::vector<BrokenChunk>& broken_chunks() const;

 private:
  struct State;
  explicit Reader(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

struct Repair {
  std::uint64_t messages = 0;     // kept
  std::uint64_t octets_lost = 0;  // behind the last whole record, and in records that cannot be read
  std::uint64_t broken_chunks = 0;
  std::optional<std::uint64_t> messages_lost = 0;  // nothing when the file does not say how many there were
  std::uint64_t attachments_lost = 0;
  std::uint64_t metadata_lost = 0;
  bool is_changed = false;  // the data do not match their CRC, or have records of no known kind
  std::optional<std::string> damage{};
  // More than what a writer that was killed did not end.
  bool has_losses() const { return broken_chunks + attachments_lost + metadata_lost > 0 || messages_lost != 0 || is_changed; }
};

// Writes to `to` all that can be read of `from`, with a new summary. Both may be the same path: the file is replaced when the new one is
// whole, and never by one with fewer messages than a Reader gives of it.
base::Result<Repair> repair(const std::string& from, const std::string& to);

}  // namespace mcap
