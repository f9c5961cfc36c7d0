#include "reader/protocol.h"

#include <sys/stat.h>

#include <algorithm>

namespace sim {

FileStamp stamp_of(const std::string& path) {
  FileStamp stamp{path};
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

bool are_unchanged(const FileStamps& files) {
  return std::all_of(files.begin(), files.end(), [](const FileStamp& file) { return stamp_of(file.path) == file; });
}

std::uint64_t version_of(const FileStamps& files) {
  std::uint64_t hash = 0xcbf29ce484222325;
  const auto add = [&](std::uint64_t word) {
    hash = (hash ^ word) * 0x100000001b3;
    hash ^= hash >> 29U;
  };
  for (const FileStamp& file : files) {
    for (const char c : file.path) add(static_cast<unsigned char>(c));
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
  }
}

FileStamps take_stamps(ArrayReader& in) {
  FileStamps files(static_cast<std::size_t>(in.count(most_stamps)));
  for (FileStamp& file : files) {
    file.path = in.text(most_path);
    file.exists = in.number<std::uint64_t>() != 0;
    file.device = in.number<std::uint64_t>();
    file.inode = in.number<std::uint64_t>();
    file.size = in.number<std::uint64_t>();
    file.modified_ns = in.number<std::int64_t>();
    file.changed_ns = in.number<std::int64_t>();
  }
  return files;
}

}  // namespace sim
