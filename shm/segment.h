// A segment of shared memory: its name, creation and mapping. Any thread; a Segment is moved, never copied.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "shm/access.h"
#include "shm/iface_types.h"

namespace shm {

class ProcessLife;

// What the name of a segment says.
struct SegmentName {
  uid_t uid = 0;
  std::uint32_t server_id = 0;
  IfaceType type = IfaceType::simulation;
  std::string iface;

  // Without folder: rtmsim-<uid>-<server>.<type>.<iface>
  std::string text() const;
  static std::optional<SegmentName> parse(std::string_view text);
  bool operator==(const SegmentName&) const = default;
};

// Fails, with the reason, for names that are empty, longer than max_name_length or hold '/' or control characters.
base::Result<void> check_name(std::string_view iface);

// What an iface needs; areas of size 0 are left out.
struct Geometry {
  std::size_t info_size = 0;
  std::size_t sample_size = 0;  // whole sample with its stamp
  std::uint32_t cells = 4;
  std::size_t frame_size = 0;  // data of a frame
  std::uint32_t frame_slots = 4;
  std::uint32_t leases = 32;
  std::uint32_t command_values = 0;  // doubles of each command
  std::uint32_t request_slots = 0;   // with them come the control block and the participants
  std::uint32_t participants = 0;
};

struct Found;
struct SegmentPlace;

class Segment {
 public:
  // Makes a segment that is complete before its name appears. A stale one of a dead server is replaced (its readers are told); a living
  // server's is rejected. `info` is copied in. Fails with a clear message when memory, rights or the name do not do.
  static base::Result<Segment> create(const SegmentName& name, const Geometry& geometry, std::span<const std::byte> info,
                                      const Access& access);
  // Maps an existing one and checks that every area lies inside it.
  static base::Result<Segment> open(const SegmentName& name);

  Segment() = default;
  Segment(Segment&&) = default;
  Segment& operator=(Segment&&) = default;

  Header& header() const { return *static_cast<Header*>(base_.get()); }
  const SegmentName& name() const { return name_; }
  // What the header said at the time of opening: private, so that nobody can change it under us.
  const Header& facts() const { return facts_; }
  const Area& area(AreaIndex index) const { return facts_.areas[static_cast<std::size_t>(index)]; }
  // Start of element i, which must be below area(index).count.
  std::byte* at(AreaIndex index, std::size_t element = 0) const;
  template <class T>
  T& as(AreaIndex index, std::size_t element = 0) const {
    return *reinterpret_cast<T*>(at(index, element));
  }
  std::span<const std::byte> info() const;

  // True when others than its owner may use it.
  bool is_shared() const { return is_shared_; }
  // True when another process has cut the file short: what is here are private zeros, and nobody else sees what is written.
  bool was_cut() const;
  // True when the name still leads to this segment.
  bool is_current() const;
  // Says closed to all readers and wakes them; removes the name if it still leads here. For the owner.
  void close();

 private:
  friend Found inspect(const SegmentPlace& place);
  static base::Result<Segment> open_at(const SegmentName& name, const std::string& path);
  base::Result<void> take_name(int file);

  // One mapping per process and file, shared by all segments that show it: threads that talk through it use the same addresses.
  std::shared_ptr<void> base_;
  std::uint64_t inode_ = 0;
  bool is_shared_ = false;
  SegmentName name_;
  Header facts_{};
};

// What a look at all segments finds.
struct Found {
  SegmentName name;
  bool is_readable = false;  // what follows is only known when it is
  bool is_alive = false;
  ProcessMark server{};
  std::uint64_t generation = 0;
  std::uint64_t sequence = 0;
  std::uint64_t dropped = 0;
  std::size_t size = 0;
  std::uint32_t subscribers = 0;
  std::string problem;  // why it is not readable
};
// A name that a look at the folder has found, and the file in a refuge (see segment_place.h); empty: there is none.
struct SegmentPlace {
  SegmentName name;
  std::string in_refuge;
};
Found inspect(const SegmentPlace& place);
// The names of all segments of all users, sorted by server, user, type and iface. Read again only when /dev/shm has changed: those who wait
// for a simulator ask ten times a second, hundreds of them at once.
std::shared_ptr<const std::vector<SegmentPlace>> segment_places();
// All of them, of every user, sorted by server, type and name. The work is near linear, whatever names others have made.
std::vector<Found> find_segments();
std::vector<Found> find_segments(std::uint32_t server_id);

// Server ids from this one on are of `sim-server --check`, whose segments no next server of the same id replaces.
inline constexpr std::uint32_t first_unnamed_server = 100'000'000;

// Removes the segments of dead servers with these ids that belong to this user; returns their names.
std::vector<std::string> remove_stale(std::uint32_t first_server = 0, std::uint32_t last_server = ~std::uint32_t{0});

// Removes all names that this process has made, for one that ends without destructors. Readers are told. No further name is given: other
// threads that want one wait for the end of the process. No data may be held.
void remove_own();

// By process and, when that can't be judged, by heartbeat. `server`: the process of the header, for who asks again and again.
bool is_server_alive(const Header& header);
bool is_server_alive(const Header& header, const ProcessLife& server);

}  // namespace shm
