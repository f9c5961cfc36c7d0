#include "shm/segment.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <climits>
#include <cstring>
#include <map>
#include <memory>
#include <thread>
#include <utility>

#include "base/cut_guard.h"
#include "base/file_handle.h"
#include "base/guarded.h"
#include "base/log.h"
#include "base/text.h"
#include "shm/futex.h"
#include "shm/process.h"
#include "shm/segment_place.h"
#include "shm/words.h"

namespace shm {
namespace {

constexpr std::int64_t heartbeat_limit_ns = 5'000'000'000;  // a server that can't be judged otherwise is dead after that
constexpr std::size_t max_segment = std::size_t{4} << 30;

std::string reason() { return std::strerror(errno); }

template <class Number>
bool take_number(std::string_view& text, char end, Number& number) {
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || rest == text.data() + text.size() || *rest != end) return false;
  text.remove_prefix(static_cast<std::size_t>(rest - text.data()) + 1);
  return true;
}

std::uint64_t inode_of_path(const std::string& path) {
  struct stat status {};
  return ::stat(path.c_str(), &status) == 0 ? status.st_ino : 0;
}

struct FileKey {
  dev_t device;
  ino_t inode;
  auto operator<=>(const FileKey&) const = default;
};

// The size is the one that the file had when it was mapped: it may have grown since, and what came later is not mapped.
struct Mapping {
  std::shared_ptr<void> base;  // null with errno set when mapping failed
  std::size_t size = 0;
};

// Maps a file, or gives the mapping that this process has of it already.
Mapping map_file(int file, std::size_t size) {
  struct Known {
    std::weak_ptr<void> base;
    std::size_t size;
  };
  struct Table {
    std::map<FileKey, Known> mappings;
    std::size_t swept_at = 64;  // entries at which those of mappings that are gone are taken out
  };
  static base::Guarded<Table, base::Rank::objects> guarded;
  struct stat status {};
  if (::fstat(file, &status) != 0) return {};
  const FileKey key{status.st_dev, status.st_ino};
  auto table = guarded.lock();
  if (auto found = table->mappings.find(key); found != table->mappings.end()) {
    if (auto mapping = found->second.base.lock()) return {std::move(mapping), found->second.size};
  }
  if (table->mappings.size() >= table->swept_at) {
    std::erase_if(table->mappings, [](const auto& entry) { return entry.second.base.expired(); });
    table->swept_at = 64 + 2 * table->mappings.size();
  }
  void* memory = ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  if (memory == MAP_FAILED) return {};
  std::shared_ptr<void> mapping(memory, [size, guard = std::make_shared<base::CutGuard>(memory, size)](void* mapped) mutable {
    guard.reset();
    ::munmap(mapped, size);
  });
  table->mappings[key] = {mapping, size};
  return {std::move(mapping), size};
}

constexpr std::size_t lease_size(std::uint32_t command_values) { return sizeof(Lease) + command_values * sizeof(double); }

// Places all areas; returns the total size.
std::uint64_t lay_out(const Geometry& geometry, Header& header) {
  std::uint64_t end = sizeof(Header);
  const auto add = [&](AreaIndex index, std::uint64_t stride, std::uint32_t count) {
    if (stride == 0 || count == 0) return;
    stride = round_up(stride, 64);
    header.areas[static_cast<std::size_t>(index)] = {end, stride * count, static_cast<std::uint32_t>(stride), count};
    end += stride * count;
  };
  add(AreaIndex::info, geometry.info_size, 1);
  if (geometry.sample_size > 0) add(AreaIndex::cells, 8 + geometry.sample_size, geometry.cells);
  add(AreaIndex::leases, lease_size(geometry.command_values), geometry.leases);
  if (geometry.request_slots > 0) {
    add(AreaIndex::control, sizeof(Control), 1);
    add(AreaIndex::requests, sizeof(RequestSlot) + 2 * text_piece, geometry.request_slots);
    add(AreaIndex::participants, sizeof(ParticipantSlot), geometry.participants);
  }
  if (geometry.frame_size > 0) add(AreaIndex::frames, sizeof(FrameHead) + geometry.frame_size, geometry.frame_slots);
  return round_up(end, 4096);
}

// An unnamed file that gets its name when it is complete. Needs no clean-up when we die in between.
base::Result<int> make_file(const SegmentName& name, std::uint64_t size, const Access& access) {
  base::expect_no_data_held();
  const int file = ::open(segment_folder, O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  const auto fail = [&](const std::string& what) {
    const std::string why = reason();
    if (file >= 0) ::close(file);
    return base::Error{"shared memory " + name.text() + ": " + what + ": " + why};
  };
  if (file < 0) return fail("can't make a file in /dev/shm");
  if (const int code = posix_fallocate(file, 0, static_cast<off_t>(size)); code != 0) {
    errno = code;
    return fail("no room for " + std::to_string(size) + " bytes in /dev/shm");
  }
  if (access.group && ::fchown(file, static_cast<uid_t>(-1), *access.group) != 0) {
    return fail("can't give it to group " + std::to_string(*access.group));
  }
  if (::fchmod(file, access.mode) != 0) return fail("can't set its mode");
  return file;
}

enum class Judgement { gone, removed, retry, of_another };

struct Eviction {
  Judgement judgement = Judgement::retry;
  std::uint64_t generation = 0;  // of the one removed
};

void tell_readers(Header& header) {
  store(header.state, static_cast<std::uint32_t>(RTMSIM_STATE_CLOSED));
  word(header.wake_word).fetch_add(1, std::memory_order_seq_cst);
  futex_wake(header.wake_word, INT_MAX);
}

// Removes the segment with this name unless its server lives. What another user has put there is removed where rights allow. Two who try at
// the same time do it one after the other: the file is locked, and whoever comes second finds that the name leads to another file.
base::Result<Eviction> evict(const SegmentName& name, const std::string& path) {
  struct stat found {};
  if (::lstat(path.c_str(), &found) == 0 && found.st_uid != name.uid) {
    if (::unlink(path.c_str()) == 0) return Eviction{Judgement::removed, 0};
    return Eviction{errno == ENOENT ? Judgement::gone : Judgement::of_another, 0};
  }
  base::FileHandle file(::open(path.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
  if (file.get() < 0) {
    if (errno == ENOENT) return Eviction{Judgement::gone, 0};
    return base::Error{"shared memory " + name.text() + " exists and can't be opened: " + reason()};
  }
  for (int attempt = 0; ::flock(file.get(), LOCK_EX | LOCK_NB) != 0; ++attempt) {
    if (attempt == 100) return base::Error{"shared memory " + name.text() + " is locked by another process"};
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  struct stat status {};
  if (::fstat(file.get(), &status) != 0 || inode_of_path(path) != status.st_ino) return Eviction{};
  Eviction eviction{Judgement::removed, 0};
  if (S_ISREG(status.st_mode) && static_cast<std::size_t>(status.st_size) >= sizeof(Header)) {
    const auto mapping = map_file(file.get(), static_cast<std::size_t>(status.st_size));
    if (!mapping.base) return base::Error{"shared memory " + name.text() + " can't be mapped: " + reason()};
    Header& header = *static_cast<Header*>(mapping.base.get());
    const bool is_ours = std::memcmp(header.magic, RTMSIM_MAGIC, sizeof header.magic) == 0;
    const bool is_closed = load(header.state) == RTMSIM_STATE_CLOSED;
    const ProcessMark server = header.server;
    if (is_ours && !is_closed && is_server_alive(header)) {
      const bool is_self = server.pid == own_mark().pid;
      return base::Error{is_self ? std::string(to_text(name.type)) + " " + base::in_quotes(name.iface) + " exists already in server " +
                                       std::to_string(name.server_id) + " of this process"
                                 : "server " + std::to_string(name.server_id) + " is already running as pid " + std::to_string(server.pid) +
                                       "; choose another server id or end that one"};
    }
    if (is_ours) {
      eviction.generation = header.generation;
      tell_readers(header);
    }
  }
  if (::unlink(path.c_str()) != 0 && errno != ENOENT) {
    return base::Error{"stale shared memory " + name.text() + " can't be removed: " + reason()};
  }
  return eviction;
}

// Of the threads of this process that give names. Who removes them all keeps it: nothing is named behind its back.
base::Turn<>& naming() {
  static base::Turn<> turn;
  return turn;
}

std::string check_header(const Header& header, const SegmentName& name, std::uint64_t file_size) {
  if (std::memcmp(header.magic, RTMSIM_MAGIC, sizeof header.magic) != 0) return "is not an iface";
  if (header.layout_version != layout_version) {
    return "has layout version " + std::to_string(header.layout_version) + ", expected " + std::to_string(layout_version);
  }
  if (header.type != static_cast<std::uint32_t>(name.type)) return "has another type than its name";
  if (header.total_size > file_size || header.total_size > max_segment) return "is shorter than its header requires";
  for (const Area& area : header.areas) {
    const bool is_inside = area.offset <= header.total_size && area.size <= header.total_size - area.offset;
    const bool is_consistent =
        static_cast<std::uint64_t>(area.stride) * area.count <= area.size && area.offset % 64 == 0 && area.stride % 64 == 0;
    if (!is_inside || !is_consistent) return "has an area outside of itself";
  }
  const auto element = [&](AreaIndex index, std::size_t size) {
    const Area& area = header.areas[static_cast<std::size_t>(index)];
    return area.count == 0 || (area.stride >= size && area.offset >= sizeof(Header));
  };
  const bool fits = element(AreaIndex::info, 1) && element(AreaIndex::cells, 8 + sizeof(Stamp)) &&
                    element(AreaIndex::frames, sizeof(FrameHead)) && header.command_values <= max_command_values &&
                    element(AreaIndex::leases, lease_size(header.command_values)) && element(AreaIndex::control, sizeof(Control)) &&
                    element(AreaIndex::requests, sizeof(RequestSlot) + 2 * text_piece) &&
                    element(AreaIndex::participants, sizeof(ParticipantSlot));
  return fits ? "" : "has elements that are too small";
}

}  // namespace

std::string SegmentName::text() const {
  return std::string(segment_prefix) + std::to_string(uid) + "-" + std::to_string(server_id) + "." + std::string(to_text(type)) + "." +
         iface;
}

std::optional<SegmentName> SegmentName::parse(std::string_view text) {
  if (text.substr(0, segment_prefix.size()) != segment_prefix) return std::nullopt;
  text.remove_prefix(segment_prefix.size());
  SegmentName name;
  if (!take_number(text, '-', name.uid) || !take_number(text, '.', name.server_id)) return std::nullopt;
  const auto dot = text.find('.');
  if (dot == std::string_view::npos) return std::nullopt;
  const auto type = parse_type(text.substr(0, dot));
  if (!type) return std::nullopt;
  name.type = *type;
  name.iface = text.substr(dot + 1);
  if (!check_name(name.iface)) return std::nullopt;
  return name;
}

base::Result<void> check_name(std::string_view iface) {
  const auto fail = [&](const std::string& what) { return base::Error{"iface name " + base::in_quotes(iface) + " " + what}; };
  if (iface.empty()) return fail("is empty");
  if (iface.size() > max_name_length) {
    return fail("has " + std::to_string(iface.size()) + " bytes, at most " + std::to_string(max_name_length) + " fit");
  }
  for (char c : iface) {
    if (c == '/') return fail("holds '/', which no iface name can");
    if (static_cast<unsigned char>(c) < 32 || c == 127) return fail("holds a control character");
  }
  return {};
}

namespace {

bool is_of_this_boot(const Header& header) { return std::memcmp(header.boot_id, boot_id().data(), boot_id().size()) == 0; }

// A server of another pid namespace can't be judged by its process.
bool has_good_heartbeat(const Header& header) {
  static const std::uint32_t here = own_mark().pid_namespace;
  return header.server.pid_namespace == here || monotonic_ns() - load(header.heartbeat_ns) < heartbeat_limit_ns;
}

}  // namespace

bool is_server_alive(const Header& header) { return is_of_this_boot(header) && is_alive(header.server) && has_good_heartbeat(header); }

bool is_server_alive(const Header& header, const ProcessLife& server) {
  return is_of_this_boot(header) && server.is_alive() && has_good_heartbeat(header);
}

base::Result<Segment> Segment::create(const SegmentName& name, const Geometry& geometry, std::span<const std::byte> info,
                                      const Access& access) {
  if (auto good = check_name(name.iface); !good) return good.error();
  Header header{};
  const std::uint64_t size = lay_out(geometry, header);
  if (size > max_segment) return base::Error{"shared memory " + name.text() + " would need " + std::to_string(size) + " bytes"};
  auto made = make_file(name, size, access);
  if (!made) return made.error();
  base::FileHandle file(*made);
  std::shared_ptr<void> base = map_file(file.get(), size).base;
  if (!base) return base::Error{"shared memory " + name.text() + " can't be mapped: " + reason()};

  std::memcpy(header.magic, RTMSIM_MAGIC, sizeof header.magic);
  header.layout_version = layout_version;
  header.type = static_cast<std::uint32_t>(name.type);
  header.total_size = size;
  header.command_values = geometry.command_values;
  header.generation = static_cast<std::uint64_t>(wall_ns());
  header.server = own_mark();
  std::memcpy(header.boot_id, boot_id().data(), boot_id().size());
  header.server_id = name.server_id;
  header.uid = name.uid;
  std::memcpy(header.type_name, to_text(name.type).data(), to_text(name.type).size());
  std::memcpy(header.name, name.iface.data(), name.iface.size());
  header.state = RTMSIM_STATE_LIVE;
  header.heartbeat_ns = monotonic_ns();

  Segment segment;
  segment.base_ = std::move(base);
  segment.name_ = name;
  segment.header() = segment.facts_ = header;
  if (!info.empty()) std::memcpy(segment.at(AreaIndex::info), info.data(), info.size());
  struct stat status {};
  ::fstat(file.get(), &status);
  segment.inode_ = status.st_ino;
  segment.is_shared_ = (access.mode & 077U) != 0;

  if (auto named = segment.take_name(file.get()); !named) {
    segment.inode_ = 0;
    return named.error();
  }
  return segment;
}

// Gives the file its name. A stale one of ours goes; when another user has the name, ours is in a folder of our own.
base::Result<void> Segment::take_name(int file) {
  const auto mine = naming().take();
  const std::string from = "/proc/self/fd/" + std::to_string(file);
  std::string path = path_of(name_);
  for (int attempt = 0; attempt < 20; ++attempt) {
    if (::linkat(AT_FDCWD, from.c_str(), AT_FDCWD, path.c_str(), AT_SYMLINK_FOLLOW) == 0) {
      if (!is_elsewhere_too(name_, path)) return {};
      remove_name(name_, path);  // whoever named it last sees the other: both meet in one place then
      path = path_of(name_);
      continue;
    }
    const int error = errno;
    if (error != EEXIST && error != ENOENT) {
      return base::Error{"shared memory " + name_.text() + " can't be named: " + std::strerror(error)};
    }
    auto eviction = evict(name_, path);
    if (!eviction) return eviction.error();
    if (eviction->generation >= facts_.generation) header().generation = facts_.generation = eviction->generation + 1;
    path = path_of(name_);
    if (eviction->judgement != Judgement::of_another) continue;
    auto refuge = make_refuge();
    if (!refuge) return base::Error{"shared memory " + name_.text() + " is taken by another user, and " + refuge.error().message};
    path = *refuge + "/" + name_.text();
    base::log(base::Level::warn, "shm", "shared memory {} is taken by another user; ours is in {}", name_.text(), *refuge);
  }
  return base::Error{"shared memory " + name_.text() + " is taken repeatedly by other processes"};
}

base::Result<Segment> Segment::open(const SegmentName& name) {
  if (auto good = check_name(name.iface); !good) return good.error();
  return open_at(name, path_of(name));
}

base::Result<Segment> Segment::open_at(const SegmentName& name, const std::string& path) {
  base::expect_no_data_held();
  base::FileHandle file(::open(path.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
  if (file.get() < 0) return base::Error{"shared memory " + name.text() + " can't be opened: " + reason()};
  struct stat status {};
  if (::fstat(file.get(), &status) != 0) return base::Error{"shared memory " + name.text() + " can't be read: " + reason()};
  if (!S_ISREG(status.st_mode)) return base::Error{"shared memory " + name.text() + " is no file"};
  if (status.st_uid != name.uid) return base::Error{"shared memory " + name.text() + " does not belong to the user in its name"};
  const auto size = static_cast<std::size_t>(status.st_size);
  if (size < sizeof(Header)) return base::Error{"shared memory " + name.text() + " is shorter than a header"};
  Mapping mapping = map_file(file.get(), size);
  if (!mapping.base) return base::Error{"shared memory " + name.text() + " can't be mapped: " + reason()};
  Segment segment;
  segment.base_ = std::move(mapping.base);
  segment.inode_ = status.st_ino;
  segment.is_shared_ = (status.st_mode & 077U) != 0;
  segment.name_ = name;
  std::memcpy(&segment.facts_, segment.base_.get(), offsetof(Header, state));
  if (const std::string problem = check_header(segment.facts_, name, mapping.size); !problem.empty()) {
    return base::Error{"shared memory " + name.text() + " " + problem};
  }
  return segment;
}

std::byte* Segment::at(AreaIndex index, std::size_t element) const {
  const Area& place = area(index);
  return static_cast<std::byte*>(base_.get()) + place.offset + element * place.stride;
}

std::span<const std::byte> Segment::info() const {
  const Area& place = area(AreaIndex::info);
  return {place.count > 0 ? at(AreaIndex::info) : nullptr, place.count > 0 ? place.size : 0};
}

bool Segment::was_cut() const { return base::was_cut(base_.get()); }

bool Segment::is_current() const { return inode_ != 0 && inode_of_path(path_of(name_)) == inode_; }

void Segment::close() {
  if (!base_) return;
  base::expect_no_data_held();
  tell_readers(header());
  if (!is_current()) return;
  remove_name(name_, path_of(name_));
}

Found inspect(const SegmentPlace& place) {
  Found found;
  found.name = place.name;
  auto segment = Segment::open_at(place.name, path_of(place));
  if (!segment) {
    found.problem = segment.error().message;
    return found;
  }
  const Header& header = segment->header();
  found.is_readable = true;
  found.is_alive = load(header.state) == RTMSIM_STATE_LIVE && is_server_alive(header);
  found.server = segment->facts().server;
  found.generation = segment->facts().generation;
  found.sequence = load(header.sequence);
  found.dropped = load(header.dropped);
  found.size = segment->facts().total_size;
  for (std::size_t i = 0; i < segment->area(AreaIndex::leases).count; ++i) {
    const auto& lease = segment->as<Lease>(AreaIndex::leases, i);
    if (load(lease.owner) != 0 && (load(lease.flags) & RTMSIM_LEASE_SUBSCRIBER) != 0) ++found.subscribers;
  }
  return found;
}

std::vector<Found> find_segments() {
  std::vector<Found> found;
  const auto places = segment_places();
  for (const auto& place : *places) found.push_back(inspect(place));
  return found;
}

std::vector<Found> find_segments(std::uint32_t server_id) {
  std::vector<Found> found;
  const auto places = segment_places();
  for (const auto& place : *places) {
    if (place.name.server_id == server_id) found.push_back(inspect(place));
  }
  return found;
}

std::vector<std::string> remove_stale(std::uint32_t first_server, std::uint32_t last_server) {
  std::vector<std::string> removed;
  const auto places = segment_places();
  for (const auto& place : *places) {
    const auto& name = place.name;
    if (name.uid != ::geteuid() || name.server_id < first_server || name.server_id > last_server) continue;
    auto eviction = evict(name, path_of(place));
    if (eviction && eviction->judgement == Judgement::removed) removed.push_back(name.text());
  }
  return removed;
}

void remove_own() {
  static const auto mine = naming().take();
  const ProcessMark own = own_mark();
  const auto places = segment_places();
  for (const auto& place : *places) {
    if (place.name.uid != ::geteuid()) continue;
    auto segment = Segment::open(place.name);
    if (!segment) continue;
    const ProcessMark& server = segment->facts().server;
    if (server.pid == own.pid && server.pid_namespace == own.pid_namespace && server.start_time == own.start_time) segment->close();
  }
}

}  // namespace shm
