// The jobs of rtm-asset-reader: reads one file. One thread at a time. May crash, hang, grow or end the process: it runs where that does no
// harm.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "base/result.h"
#include "reader/arrays.h"
#include "reader/protocol.h"

namespace sim {

// Opens files by the rules of worlds (base/plain_file.h), and keeps the stamps of all that were asked for, with hashes of what was read.
class FileLog {
 public:
  base::Result<std::string> read(const std::string& path, std::uint64_t max_bytes);
  // Whether it can be read; what is missing counts as asked for.
  bool exists(const std::string& path);
  const FileStamps& stamps() const { return stamps_; }

 private:
  // The one of the path; null: there are too many.
  FileStamp* add(FileStamp stamp);
  FileStamps stamps_;
};

struct Job {
  std::string path;
  ArrayReader& in;           // the rest of the request
  bool has_content = false;  // it came with the request: the path is only a name
  std::span<const std::uint8_t> content = {};
  FileLog& files;
  ArrayWriter& out;
};

// Errors are the reason alone. Nothing has been written then, or what was is to be thrown away.
base::Result<void> read_asset(AssetKind kind, Job& job);

base::Result<void> read_triangles(Job& job);
base::Result<void> read_mesh(Job& job);
base::Result<void> read_skin(Job& job);
base::Result<void> read_animation(Job& job);
base::Result<void> read_picture(Job& job);
base::Result<void> read_levels(Job& job);

}  // namespace sim
