// The reader of meshes and pictures: a process of its own (rtm-asset-reader, beside this program), because the libraries that parse such
// files crash, hang and grow on files that are damaged or hostile. One per process, started with the first file; it stays until this
// process ends, or until it dies, hangs or exceeds a limit. Then the file gets an error, and the next file a new reader.
//
// Limits: time of the processor and of the clock (ReadLimits), memory, size of the result (reader/protocol.h).
// Any thread; files are read one after the other. No data may be held.
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <new>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/guarded.h"
#include "base/result.h"
#include "reader/protocol.h"

namespace sim {

struct ReadLimits {
  std::chrono::seconds cpu{8};
  std::chrono::seconds wall{16};
};

// While it exists, what the calling thread reads ends at this time: for callers whose client waits.
class ReadDeadline {
 public:
  explicit ReadDeadline(std::chrono::steady_clock::time_point when);
  ~ReadDeadline();
  ReadDeadline(const ReadDeadline&) = delete;
  ReadDeadline& operator=(const ReadDeadline&) = delete;

 private:
  std::optional<std::chrono::steady_clock::time_point> before_;
};

// Read-only memory that only this process has: the reader can neither change nor shrink it any more.
class SealedMemory {
 public:
  // Takes the descriptor. Null when it is no sealed memory, or larger than `most`; errno is ENOMEM when the memory is not enough.
  static std::shared_ptr<const SealedMemory> map(int file, std::uint64_t most);
  ~SealedMemory();
  SealedMemory(const SealedMemory&) = delete;
  SealedMemory& operator=(const SealedMemory&) = delete;
  std::span<const std::byte> bytes() const { return {data_, size_}; }

 private:
  SealedMemory(const std::byte* data, std::size_t size) : data_(data), size_(size) {}
  const std::byte* data_;
  std::size_t size_;
};

class AssetReader {
 public:
  // The one of this process.
  static AssetReader& mine();
  ~AssetReader();
  AssetReader(const AssetReader&) = delete;
  AssetReader& operator=(const AssetReader&) = delete;

  struct Question {
    AssetKind kind{};
    std::string path;                         // of the file
    std::string what;                         // for messages: "mesh", "image", ...
    std::string details;                      // what the kind needs, as ArrayWriter has made it
    std::span<const std::uint8_t> content{};  // instead of the file's: a picture inside a mesh
  };
  struct Answer {
    std::optional<base::Error> error;  // of the file
    std::shared_ptr<const SealedMemory> memory;
    std::span<const std::byte> result;
    FileStamps files;  // that the answer depends on
  };
  Answer ask(const Question& question, const ReadLimits& limits = {});

  // The stamps as they are now, if the files still have the content that they had: those that another state leaves in doubt are read. Empty
  // otherwise.
  std::optional<FileStamps> unchanged(const FileStamps& files);

  // What `take` makes of the answer; false: it makes no sense. One line for that, and when the memory is not enough for it.
  template <class T, class Take>
  static base::Result<T> decoded(const Question& question, const Answer& answer, const Take& take) {
    if (answer.error) return *answer.error;
    const auto fail = [&](const char* why) { return base::Error{question.what + " " + question.path + ": " + why}; };
    try {
      ArrayReader in(answer.result);
      T value;
      if (!take(in, value)) return fail("is damaged: what was read of it makes no sense");
      return value;
    } catch (const std::bad_alloc&) {
      return fail("is too large for the memory");
    }
  }

  // This process ends: what is being read, and all that is asked for from now on, fails at once.
  void stop();

  // For tests: starts a child process of this one, which answers on this end of the socket, instead of rtm-asset-reader. Before the first
  // file.
  using Starter = std::function<base::Result<pid_t>(int socket)>;
  void start_by(Starter starter);

  // Of the reader that runs now; 0: none.
  pid_t process() const;
  // Readers that this process has started.
  std::size_t started() const;

 private:
  AssetReader();
  struct Child;
  struct State;
  std::unique_ptr<State> state_;
};

// Results by question, each with the stamps of its files: what still has the same content is not made again. A file that nobody has touched
// costs a stat. Values that somebody keeps stay for as long; of the others those that were asked for last, up to a limit. Any thread; no
// data may be held.
template <class T>
class AssetShelf {
 public:
  explicit AssetShelf(std::size_t max_bytes) : max_bytes_(max_bytes) {}

  struct Found {
    base::Result<std::shared_ptr<const T>> value;
    FileStamps files;
  };
  struct Made {
    base::Result<T> value;
    FileStamps files;
    std::size_t bytes = 0;
    bool is_lasting = true;  // false: may be another one the next time, such as when the time was over
  };
  Found get(const std::string& key, const std::function<Made()>& make) {
    std::optional<Found> kept;
    {
      auto state = state_.lock();
      if (const auto entry = state->entries.find(key); entry != state->entries.end()) {
        auto value = entry->second.kept ? entry->second.kept : entry->second.known.lock();
        if (value) kept = Found{base::Result<std::shared_ptr<const T>>(value), entry->second.files};
        if (entry->second.error) kept = Found{*entry->second.error, entry->second.files};
        entry->second.used = ++state->uses;
      }
    }
    if (kept && are_untouched(kept->files)) return *kept;
    if (kept) {
      if (auto now = AssetReader::mine().unchanged(kept->files)) {
        auto state = state_.lock();
        const auto entry = state->entries.find(key);
        if (entry != state->entries.end() && version_of(entry->second.files) == version_of(*now)) entry->second.files = *now;
        return {std::move(kept->value), std::move(*now)};
      }
    }
    Made made = make();
    if (!made.value) {
      if (made.is_lasting) put(key, {nullptr, {}, made.value.error(), made.files, 0, 0});
      return {made.value.error(), std::move(made.files)};
    }
    auto value = std::make_shared<const T>(std::move(*made.value));
    put(key, {value, value, std::nullopt, made.files, made.bytes, 0});
    return {base::Result<std::shared_ptr<const T>>(std::move(value)), std::move(made.files)};
  }

 private:
  struct Entry {
    std::shared_ptr<const T> kept;
    std::weak_ptr<const T> known;
    std::optional<base::Error> error;
    FileStamps files;
    std::size_t bytes = 0;
    std::uint64_t used = 0;
  };
  struct State {
    std::map<std::string, Entry> entries;
    std::uint64_t uses = 0;
  };

  void put(const std::string& key, Entry entry) {
    std::vector<std::shared_ptr<const T>> given_up;  // ends after the lock
    auto state = state_.lock();
    entry.used = ++state->uses;
    state->entries.insert_or_assign(key, std::move(entry));
    const auto total = [&] {
      std::size_t sum = 0;
      for (const auto& [name, kept] : state->entries) sum += kept.kept ? kept.bytes : 0;
      return sum;
    };
    while (total() > max_bytes_) {
      Entry* oldest = nullptr;
      for (auto& [name, kept] : state->entries)
        if (kept.kept && (oldest == nullptr || kept.used < oldest->used)) oldest = &kept;
      given_up.push_back(std::exchange(oldest->kept, nullptr));
    }
    // What nobody has any more, and errors, take little; yet not for ever.
    if (state->entries.size() > max_entries)
      std::erase_if(state->entries, [](const auto& e) { return !e.second.kept && e.second.known.expired(); });
  }

  static constexpr std::size_t max_entries = 4096;
  std::size_t max_bytes_;
  base::Guarded<State, base::Rank::objects> state_;
};

}  // namespace sim
