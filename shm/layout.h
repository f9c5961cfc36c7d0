// C++ names and enums of the shared memory layout (rtmsim_layout.h), with fixed offsets; the types of ifaces are in iface_types.h. Plain
// data; no thread rule.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "shm/rtmsim_layout.h"

namespace shm {

using ProcessMark = ::rtmsim_process;
using Area = ::rtmsim_area;
using Header = ::rtmsim_header;
using Lease = ::rtmsim_lease;
using CommandHead = ::rtmsim_command;
using Stamp = ::rtmsim_stamp;
using Pose = ::rtmsim_pose;
using Part = ::rtmsim_part;
using FrameHead = ::rtmsim_frame;
using RequestBody = ::rtmsim_request_body;
using ReplyBody = ::rtmsim_reply_body;
using RequestSlot = ::rtmsim_request_slot;
using Control = ::rtmsim_control;
using ParticipantSlot = ::rtmsim_participant;

inline constexpr std::uint32_t layout_version = RTMSIM_LAYOUT_VERSION;
inline constexpr std::size_t max_name_length = 200;
inline constexpr std::size_t text_piece = RTMSIM_TEXT_PIECE;
inline constexpr unsigned max_holds = RTMSIM_HOLDS;
inline constexpr std::uint32_t max_command_values = 65536;
inline constexpr Pose identity_pose{0, 0, 0, 1, 0, 0, 0};

enum class AreaIndex : std::size_t {
  info = RTMSIM_AREA_INFO,
  cells = RTMSIM_AREA_CELLS,
  frames = RTMSIM_AREA_FRAMES,
  leases = RTMSIM_AREA_LEASES,
  control = RTMSIM_AREA_CONTROL,
  requests = RTMSIM_AREA_REQUESTS,
  participants = RTMSIM_AREA_PARTICIPANTS,
};

enum class CommandKind : std::uint32_t {
  stop = RTMSIM_COMMAND_STOP,
  velocity = RTMSIM_COMMAND_VELOCITY,
  pose = RTMSIM_COMMAND_POSE,
  joints = RTMSIM_COMMAND_JOINTS,
  car = RTMSIM_COMMAND_CAR,
  charge = RTMSIM_COMMAND_CHARGE
};

// A command as a device sees it.
struct Command {
  std::uint64_t sequence = 0;  // counts the commands of one client
  CommandKind kind = CommandKind::stop;
  std::span<const double> values;        // as many as the iface has, finite; valid until the writer polls again
  std::chrono::nanoseconds duration{0};  // simulated; 0: until another command, or until the client leaves
};

// The values of the command of a lease, which lies in shared memory.
inline double* command_values_of(Lease& lease) { return reinterpret_cast<double*>(&lease + 1); }
inline const double* command_values_of(const Lease& lease) { return reinterpret_cast<const double*>(&lease + 1); }

// Copies text into a fixed field, cut at its end and always terminated.
template <std::size_t size>
void set_text(char (&field)[size], std::string_view text) {
  const std::size_t length = text.size() < size ? text.size() : size - 1;
  for (std::size_t i = 0; i < size; ++i) field[i] = i < length ? text[i] : '\0';
}

enum class Format : std::uint32_t {
  rgb8 = RTMSIM_FORMAT_RGB8,
  mono8 = RTMSIM_FORMAT_MONO8,
  depth_float = RTMSIM_FORMAT_DEPTH_FLOAT,
  points_float = RTMSIM_FORMAT_POINTS_FLOAT,
  points_intensity_float = RTMSIM_FORMAT_POINTS_INTENSITY_FLOAT,
  bgr8 = RTMSIM_FORMAT_BGR8,
  rgba8 = RTMSIM_FORMAT_RGBA8,
  bgra8 = RTMSIM_FORMAT_BGRA8,
  mono16 = RTMSIM_FORMAT_MONO16,
  bayer_rggb8 = RTMSIM_FORMAT_BAYER_RGGB8,
  bayer_bggr8 = RTMSIM_FORMAT_BAYER_BGGR8,
  bayer_gbrg8 = RTMSIM_FORMAT_BAYER_GBRG8,
  bayer_grbg8 = RTMSIM_FORMAT_BAYER_GRBG8,
  labels = RTMSIM_FORMAT_LABELS,
  thermal16 = RTMSIM_FORMAT_THERMAL16,
  thermal8 = RTMSIM_FORMAT_THERMAL8,
};
// How to show the bytes of labels and temperatures as an image: those of colours or of grey. Others are as they are.
constexpr Format shown_as(Format format) {
  if (format == Format::labels) return Format::rgb8;
  if (format == Format::thermal16) return Format::mono16;
  return format == Format::thermal8 ? Format::mono8 : format;
}
// Bytes of a pixel or point; 0 for an unknown format.
constexpr std::uint32_t bytes_per_pixel(Format format) {
  switch (format) {
    case Format::rgb8:
    case Format::bgr8:
    case Format::labels:
      return 3;
    case Format::mono8:
    case Format::bayer_rggb8:
    case Format::bayer_bggr8:
    case Format::bayer_gbrg8:
    case Format::bayer_grbg8:
    case Format::thermal8:
      return 1;
    case Format::mono16:
    case Format::thermal16:
      return 2;
    case Format::depth_float:
    case Format::rgba8:
    case Format::bgra8:
      return 4;
    case Format::points_float:
      return 12;
    case Format::points_intensity_float:
      return 16;
  }
  return 0;
}

static_assert(sizeof(Header) == 1024 && offsetof(Header, server) == 32 && offsetof(Header, areas) == 320 &&
              offsetof(Header, state) == 512 && offsetof(Header, sequence) == 576 && offsetof(Header, wake_word) == 592);
static_assert(sizeof(Lease) == 160 && offsetof(Lease, holds) == 64 && offsetof(Lease, command_lock) == 128 && sizeof(CommandHead) == 24);
static_assert(offsetof(Header, command_values) == 316);
static_assert(sizeof(Stamp) == 32 && sizeof(Pose) == 56 && sizeof(Part) == 40);
static_assert(sizeof(FrameHead) == 128);  // those of infos and samples: iface_types.h
static_assert(sizeof(RequestBody) == 408 && sizeof(ReplyBody) == 416 && sizeof(RequestSlot) == 1024 && offsetof(RequestSlot, body) == 64);
static_assert(sizeof(Control) == 192 && offsetof(Control, pending) == 64 && offsetof(Control, tick_words) == 128);
static_assert(sizeof(ParticipantSlot) == 256 && offsetof(ParticipantSlot, go) == 128 && offsetof(ParticipantSlot, done) == 192);

}  // namespace shm
