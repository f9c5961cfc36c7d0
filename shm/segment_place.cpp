#include "shm/segment_place.h"

#include <dirent.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <memory>
#include <optional>
#include <tuple>
#include <utility>

#include "base/guarded.h"
#include "shm/process.h"

namespace shm {
namespace {

std::string usual_path(const SegmentName& name) { return std::string(segment_folder) + "/" + name.text(); }

bool is_owned_by(const std::string& path, uid_t uid) {
  struct stat status {};
  return ::lstat(path.c_str(), &status) == 0 && status.st_uid == uid;
}

std::vector<std::string> entries_of(const std::string& path) {
  std::vector<std::string> entries;
  std::unique_ptr<DIR, int (*)(DIR*)> dir(::opendir(path.c_str()), &::closedir);
  if (!dir) return entries;
  while (const dirent* entry = ::readdir(dir.get())) entries.emplace_back(entry->d_name);
  return entries;
}

// Folders for names that somebody else has taken in /dev/shm, where everybody may make files: "rtmsim-<uid>.<six random letters>". Nobody
// can guess one before it is there, and in one nobody else can make a name. Those of other owners are not looked at.
std::string refuge_prefix(uid_t uid) { return std::string(segment_prefix) + std::to_string(uid) + "."; }

// The user whose refuge this entry of /dev/shm is. Its name is looked at before the file: a server has thousands of segments there.
std::optional<uid_t> refuge_owner(const std::string& entry) {
  if (!entry.starts_with(segment_prefix)) return std::nullopt;
  uid_t uid = 0;
  const char* end = entry.data() + entry.size();
  const auto [rest, error] = std::from_chars(entry.data() + segment_prefix.size(), end, uid);
  if (error != std::errc() || rest == end || *rest != '.' || !entry.starts_with(refuge_prefix(uid))) return std::nullopt;
  struct stat status {};
  if (::lstat((std::string(segment_folder) + "/" + entry).c_str(), &status) != 0) return std::nullopt;
  return S_ISDIR(status.st_mode) && status.st_uid == uid ? std::optional(uid) : std::nullopt;
}

// A folder of tmpfs has two links, and one more for each folder in it (tmpfs(5) is what /dev/shm is): with two there is no refuge, and the
// list of a thousand files need not be read for each of them. Other file systems say other numbers, and their list is read.
bool has_no_folders(const char* path) {
  struct stat status {};
  return ::stat(path, &status) == 0 && status.st_nlink == 2;
}

std::vector<std::string> refuges_of(uid_t uid) {
  std::vector<std::string> paths;
  if (has_no_folders(segment_folder)) return paths;
  const std::string prefix = refuge_prefix(uid);
  for (const std::string& entry : entries_of(segment_folder)) {
    if (entry.starts_with(prefix) && refuge_owner(entry) == uid) paths.push_back(std::string(segment_folder) + "/" + entry);
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

}  // namespace

// Those of other users may pass through, as they may read names in /dev/shm: the mode of a segment says who may use it.
base::Result<std::string> make_refuge() {
  if (auto known = refuges_of(::geteuid()); !known.empty()) return known.front();
  std::string path = std::string(segment_folder) + "/" + refuge_prefix(::geteuid()) + "XXXXXX";
  if (::mkdtemp(path.data()) == nullptr || ::chmod(path.c_str(), 0755) != 0) {
    return base::Error{"folder " + path + " can't be made: " + std::strerror(errno)};
  }
  // Somebody else of this account may have made one at the same time: one is enough.
  const auto known = refuges_of(::geteuid());
  if (known.empty() || known.front() == path) return path;
  ::rmdir(path.c_str());
  return known.front();
}

std::string path_of(const SegmentName& name) {
  std::string usual = usual_path(name);
  if (is_owned_by(usual, name.uid)) return usual;
  for (const std::string& refuge : refuges_of(name.uid)) {
    if (std::string path = refuge + "/" + name.text(); is_owned_by(path, name.uid)) return path;
  }
  return usual;
}

std::string path_of(const SegmentPlace& place) {
  std::string usual = usual_path(place.name);
  return place.in_refuge.empty() || is_owned_by(usual, place.name.uid) ? usual : place.in_refuge;
}

void remove_name(const SegmentName& name, const std::string& path) {
  ::unlink(path.c_str());
  if (path != usual_path(name)) ::rmdir(path.substr(0, path.rfind('/')).c_str());  // does so when nothing is left in it
}

bool is_elsewhere_too(const SegmentName& name, const std::string& path) {
  const auto is_other = [&](const std::string& place) { return place != path && is_owned_by(place, name.uid); };
  const auto refuges = refuges_of(name.uid);
  return is_other(usual_path(name)) ||
         std::any_of(refuges.begin(), refuges.end(), [&](const std::string& refuge) { return is_other(refuge + "/" + name.text()); });
}

namespace {

std::vector<SegmentPlace> read_places() {
  std::vector<SegmentPlace> places;
  for (const std::string& entry : entries_of(segment_folder)) {
    if (auto name = SegmentName::parse(entry)) {
      places.push_back({std::move(*name), {}});
    } else if (const auto uid = refuge_owner(entry)) {
      const std::string refuge = std::string(segment_folder) + "/" + entry;
      for (const std::string& inside : entries_of(refuge)) {
        auto hidden = SegmentName::parse(inside);
        if (!hidden || hidden->uid != *uid) continue;
        std::string path = refuge + "/" + inside;
        if (!is_owned_by(path, *uid)) path.clear();
        places.push_back({std::move(*hidden), std::move(path)});
      }
    }
  }
  // Of several with one name the first in a refuge stays, if any is.
  const auto key = [](const SegmentPlace& place) {
    const SegmentName& name = place.name;
    return std::tuple(name.server_id, name.uid, name.type, std::string_view(name.iface), place.in_refuge.empty(),
                      std::string_view(place.in_refuge));
  };
  std::ranges::sort(places, {}, key);
  // Not std::ranges::unique: clang 14 does not compile its result.
  const auto have_one_name = [](const SegmentPlace& a, const SegmentPlace& b) { return a.name == b.name; };
  places.erase(std::unique(places.begin(), places.end(), have_one_name), places.end());
  return places;
}

// [ns] Unix time of the last change of the folder; nothing: it can't be told, or there are folders in it, whose changes it does not show.
std::optional<std::int64_t> last_change(const char* path) {
  struct stat status {};
  if (!has_no_folders(path) || ::stat(path, &status) != 0) return std::nullopt;
  return std::int64_t{status.st_mtim.tv_sec} * 1'000'000'000 + status.st_mtim.tv_nsec;
}

struct Listing {
  std::optional<std::int64_t> changed;  // nothing: not to be used again
  std::shared_ptr<const std::vector<SegmentPlace>> places;
};

}  // namespace

std::shared_ptr<const std::vector<SegmentPlace>> segment_places() {
  base::expect_no_data_held();
  static auto& last = *new base::Guarded<Listing, base::Rank::objects>;  // never destroyed: threads may still look at the very end
  // The kernel's clock for files ticks every few milliseconds: a change in the same tick as the last one would not be seen.
  constexpr std::int64_t settled = 50'000'000;  // [ns]
  auto changed = last_change(segment_folder);
  if (changed && wall_ns() - *changed < settled) changed.reset();
  if (auto known = last.lock(); changed && known->changed == changed) return known->places;
  auto places = std::make_shared<const std::vector<SegmentPlace>>(read_places());
  *last.lock() = {changed, places};
  return places;
}

}  // namespace shm
