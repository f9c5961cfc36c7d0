#include "asset-reader/jobs.h"

#include <exception>
#include <new>
#include <utility>

#include "base/content_hash.h"
#include "base/plain_file.h"
#include "base/text.h"

namespace sim {

FileStamp* FileLog::add(FileStamp stamp) {
  for (FileStamp& known : stamps_)
    if (known.path == stamp.path) return &known;
  if (stamps_.size() >= max_stamps || stamp.path.size() > max_path) return nullptr;
  return &stamps_.emplace_back(std::move(stamp));
}

base::Result<std::string> FileLog::read(const std::string& path, std::uint64_t max_bytes) {
  FileStamp* stamp = add(stamp_of(path));  // before: what changes meanwhile is found to be another file
  auto bytes = base::read_plain_file(path, max_bytes);
  if (bytes && stamp != nullptr && stamp->content.empty()) {
    base::ContentHash hash;
    hash.add(*bytes);
    stamp->content = hash.text();
  }
  return bytes;
}

bool FileLog::exists(const std::string& path) {
  const FileStamp* stamp = add(stamp_of(path));
  return (stamp == nullptr || stamp->exists) && base::is_plain_file(path);
}

base::Result<void> read_asset(AssetKind kind, Job& job) {
  try {
    switch (kind) {
      case AssetKind::triangles:
        return read_triangles(job);
      case AssetKind::mesh:
        return read_mesh(job);
      case AssetKind::skin:
        return read_skin(job);
      case AssetKind::animation:
        return read_animation(job);
      case AssetKind::image:
        return read_picture(job);
      case AssetKind::heights:
        return read_levels(job);
      case AssetKind::content: {
        const auto bytes = job.files.read(job.path, max_image_file);
        return bytes ? base::Result<void>() : bytes.error();
      }
    }
    return base::Error{"is of no kind that is read"};
  } catch (const std::bad_alloc&) {
    return base::Error{"is too large for the memory"};
  } catch (const std::exception& e) {
    return base::Error{base::in_quotes(e.what())};
  } catch (...) {  // libraries throw what is no exception
    return base::Error{"cannot be read"};
  }
}

}  // namespace sim
