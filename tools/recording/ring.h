// The segments of a ring recording, which `rtse record --last` writes, so that a kill loses no more than in other recordings. "ring.mcap"
// has the segments ring-001.mcap, ring-002.mcap, ..., of which the latest two exist. Each spans the ring's time, can be read alone, and is
// marked by its metadata `ring`. At the end they are merged. Any thread, but one at a time for a ring.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "recording/mcap/mcap.h"

namespace recorder {

struct RingSegment {
  std::string path;
  std::uint64_t number = 0;
  std::uint64_t resets = 0;          // of simulated time, before it
  std::chrono::nanoseconds span{0};  // time that the whole ring keeps
  std::string compression;           // "zstd", "lz4", "none"
};

// "run.mcap" -> "run-002.mcap"
std::string numbered_path(const std::string& path, std::size_t number);

mcap::Metadata ring_metadata(const RingSegment& segment);
// The segments of the ring of this name, oldest first. Other files with such names are left out.
std::vector<RingSegment> ring_segments(const std::string& path);
// An error if a recorder is writing them.
base::Result<void> check_not_recording(const std::vector<RingSegment>& segments);
// An error if a file that is not a segment has the name of a possible segment of this ring.
base::Result<void> check_names(const std::string& path);
// Removes empty segments that a killed recorder has left.
void remove_empty_segments(const std::string& path);
// An error if a ring of this name is being recorded, or one of which a file of this name would be a segment.
base::Result<void> check_no_live_ring(const std::string& path);
void remove_ring_segments(const std::vector<RingSegment>& segments);
// "a-001.mcap" and "a-002.mcap"
std::string segment_names(const std::vector<RingSegment>& segments);

struct MergedRing {
  std::uint64_t samples = 0;
  std::uint32_t channels = 0;
  std::uint64_t samples_lost = 0;     // as far as the segments know
  std::vector<std::string> losses{};  // lines: unreadable parts of the segments (not a missing end), and files that were left out
};
// Writes the last samples of the segments as one file: those within the span, and for latched channels also the value at its start. Does
// not delete the segments of `ring`. An existing file of this name is replaced when the new file is complete.
base::Result<MergedRing> merge_ring(const std::vector<RingSegment>& segments, const std::string& ring, const std::string& path);

// The reader of a recording. If only segments of a ring exist, the error names them.
base::Result<mcap::Reader> open_recording(const std::string& path);
// For options of the command line: the error text if the recording does not exist; empty if it does.
std::string recording_absence_problem(const std::string& path);
// True if the file begins as a recording does.
bool is_recording(const std::string& path);
// For options of the command line: the error text if the file is not a recording; empty if it begins like one.
std::string recording_format_problem(const std::string& path);

}  // namespace recorder
