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

struct RingPiece {
  std::string path;
  std::uint64_t number = 0;
  std::uint64_t resets = 0;          // of simulated time, before it
  std::chrono::nanoseconds span{0};  // that is kept of all pieces
  std::string compression;           // "zstd", "lz4", "none"
};

// "run.mcap" -> "run-002.mcap"
std::string numbered_path(const std::string& path, std::size_t number);

mcap::Metadata ring_metadata(const RingPiece& piece);
// The segments of the ring of this name, oldest first. Other files with such names are left out.
std::vector<RingPiece> ring_pieces(const std::string& path);
// An error when a recorder is writing them.
base::Result<void> check_at_rest(const std::vector<RingPiece>& pieces);
// An error when a file that is no piece has a name that a ring of this name may give to one.
base::Result<void> check_names(const std::string& path);
// Removes files with names of pieces in which a killed recorder has not written anything yet.
void remove_unbegun_pieces(const std::string& path);
// An error when a ring of this name, or one of which a file of this name would be a piece, is being recorded.
base::Result<void> check_no_live_ring(const std::string& path);
void remove_pieces(const std::vector<RingPiece>& pieces);
// "a-001.mcap" and "a-002.mcap"
std::string names_of(const std::vector<RingPiece>& pieces);

struct JoinedRing {
  std::uint64_t samples = 0;
  std::uint32_t channels = 0;
  std::uint64_t samples_lost = 0;     // as far as the pieces say
  std::vector<std::string> losses{};  // lines: what could not be read of the pieces, but for an end that is missing, and files left out
};
// The last samples of the pieces as one file: those within the span, and before them what held at its beginning, of channels that are
// latched. The pieces of `ring` stay. Whatever was there under this name is replaced when the new file is whole.
base::Result<JoinedRing> join_ring(const std::vector<RingPiece>& pieces, const std::string& ring, const std::string& path);

// The reader of a recording. If only segments of a ring exist, the error names them.
base::Result<mcap::Reader> open_recording(const std::string& path);
// For options of the command line: the reason if the recording does not exist; empty if it does.
std::string check_recording(const std::string& path);
// True if the file begins as a recording does.
bool is_recording(const std::string& path);
// For options of the command line: the reason if the file is not a recording; empty if it begins as one.
std::string recording_problem(const std::string& path);

}  // namespace recorder
