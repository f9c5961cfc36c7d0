// Writes channels to an MCAP file, or to a series of files. Called on one thread at a time, as every sink. Samples older than a second are
// in the file, even if the process is killed.
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "channels/exchange.h"
#include "recording/mcap/mcap.h"

namespace recorder {

// When a file is ended and the next one begun; 0: never. Each file can be read alone.
struct Split {
  std::uint64_t octets = 0;
  std::chrono::nanoseconds time{0};  // by the samples' own clock
  bool is_ring = false;              // only the latest two stay, with the metadata of segments, see ring.h
  std::string compression = "zstd";  // of a ring, once it is put together
  bool is_one() const { return octets == 0 && time.count() == 0; }
};

// "500M", "2G", "64k" octets; "30s", "10m", "1h".
base::Result<Split> parse_split(const std::string& text);

class McapSink final : public channels::Sink {
 public:
  // A file that holds what is to stand in every one.
  using NewFile = std::function<base::Result<mcap::Writer>(const std::string& path)>;
  // With a split the files are PATH with -001, -002, ... before its ending.
  static base::Result<std::shared_ptr<McapSink>> create(const std::string& path, const Split& split, NewFile make);

  base::Result<void> open(channels::ChannelId id, const channels::Channel& channel) override;
  base::Result<void> take(const channels::Sample& sample) override;
  base::Result<void> rest() override;
  // After the exchange has ended.
  base::Result<void> close();
  std::uint64_t samples() const { return samples_ + writer_->statistics().messages; }
  std::uint32_t channels() const { return writer_->statistics().channels; }  // of the last file
  // Of those that are there, the latest is the last.
  std::size_t files() const { return files_; }

 private:
  McapSink(std::string path, const Split& split, NewFile make) : path_(std::move(path)), split_(split), make_(std::move(make)) {}
  base::Result<void> begin_file(channels::Time begun);
  base::Result<void> write(const channels::Sample& sample);
  base::Result<void> add(channels::ChannelId id, const channels::Channel& channel);
  bool is_full(const channels::Sample& sample) const;
  bool has_reset(const channels::Sample& sample) const;

  const std::string path_;
  const Split split_;
  const NewFile make_;
  std::optional<mcap::Writer> writer_;
  std::size_t files_ = 0;
  std::uint64_t begun_with_ = 0;  // [bytes] of what stands in every file, in this one
  std::uint64_t samples_ = 0;     // in the files before
  std::uint64_t resets_ = 0;      // of time, since the first file was begun
  std::optional<channels::Time> first_;
  channels::Time latest_{0};                                              // of a ring
  channels::Time chunk_begun_{0};                                         // likewise
  std::map<channels::ChannelId, channels::Channel> channels_;             // those that every file gets
  std::map<channels::ChannelId, channels::Sample> latched_;               // the latest of those, of channels that hold
  std::vector<std::uint16_t> ids_;                                        // in the file, by channel
  std::map<std::pair<std::string, std::string>, std::uint16_t> schemas_;  // by name and text
  std::chrono::steady_clock::time_point flushed_ = std::chrono::steady_clock::now();
};

}  // namespace recorder
