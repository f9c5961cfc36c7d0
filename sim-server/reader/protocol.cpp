#include "reader/protocol.h"

#include <sys/stat.h>

#include <algorithm>
#include <chrono>
#include <tuple>

namespace sim {
namespace {

constexpr std::size_t max_hash = 64;  // characters

}  // namespace

FileStamp stamp_of(const std::string& path) {
  FileStamp stamp{path};
  stamp.seen_ns = std::chrono::nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count();
  struct stat is {};
  if (::stat(path.c_str(), &is) != 0) return stamp;
  const auto ns = [](const timespec& t) { return static_cast<std::int64_t>(t.tv_sec) * 1'000'000'000 + t.tv_nsec; };
  stamp.exists = true;
  stamp.device = is.st_dev;
  stamp.inode = is.st_ino;
  stamp.size = static_cast<std::uint64_t>(is.st_size);
  stamp.modified_ns = ns(is.st_mtim);
  stamp.changed_ns = ns(is.st_ctim);
  return stamp;
}

bool is_same_state(const FileStamp& a, const FileStamp& b) {
  const auto state = [](const FileStamp& s) { return std::tie(s.exists, s.device, s.inode, s.size, s.modified_ns, s.changed_ns); };
  return state(a) == state(b);
}

// The kernel's clock of files is some milliseconds coarse; some file systems keep seconds, or pairs of them.
bool is_settled(const FileStamp& stamp) {
  const bool has_seconds = stamp.changed_ns % 1'000'000'000 == 0;
  return !stamp.exists || stamp.seen_ns - stamp.changed_ns > (has_seconds ? 2'000'000'000 : 50'000'000);
}

bool are_untouched(const FileStamps& files) {
  return std::ranges::all_of(
      files, [](const FileStamp& file) { return is_same_state(file, stamp_of(file.path)) && (file.content.empty() || is_settled(file)); });
}

std::uint64_t version_of(const FileStamps& files) {
  std::uint64_t hash = 0xcbf29ce484222325;
  const auto add = [&](std::uint64_t word) {
    hash = (hash ^ word) * 0x100000001b3;
    hash ^= hash >> 29U;
  };
  for (const FileStamp& file : files) {
    for (const char c : file.path) add(static_cast<unsigned char>(c));
    for (const char c : file.content) add(static_cast<unsigned char>(c));
    if (!file.content.empty()) continue;
    for (const auto word : {std::uint64_t{file.exists}, file.device, file.inode, file.size}) add(word);
    add(static_cast<std::uint64_t>(file.modified_ns));
    add(static_cast<std::uint64_t>(file.changed_ns));
  }
  return hash == 0 ? 1 : hash;
}

void put(ArrayWriter& out, const FileStamps& files) {
  out.number<std::uint64_t>(files.size());
  for (const FileStamp& file : files) {
    out.text(file.path);
    out.number<std::uint64_t>(file.exists);
    out.number(file.device);
    out.number(file.inode);
    out.number(file.size);
    out.number(file.modified_ns);
    out.number(file.changed_ns);
    out.number(file.seen_ns);
    out.text(file.content);
  }
}

FileStamps take_stamps(ArrayReader& in) {
  FileStamps files(static_cast<std::size_t>(in.count(max_stamps)));
  for (FileStamp& file : files) {
    file.path = in.text(max_path);
    file.exists = in.number<std::uint64_t>() != 0;
    file.device = in.number<std::uint64_t>();
    file.inode = in.number<std::uint64_t>();
    file.size = in.number<std::uint64_t>();
    file.modified_ns = in.number<std::int64_t>();
    file.changed_ns = in.number<std::int64_t>();
    file.seen_ns = in.number<std::int64_t>();
    file.content = in.text(max_hash);
  }
  return files;
}

}  // namespace sim
