// The protocol of sim-server and rtm-asset-reader over a socket pair (SOCK_SEQPACKET). Any thread.
//
// A request is one packet: RequestHead, then what the kind of request needs (reader/arrays.h), perhaps with a descriptor (the bytes of a
// picture). The answer is one packet, AnswerHead, with a sealed memfd: the result's arrays (or the text of an error), padded to 8 bytes,
// then the stamps of all files that were opened or missed. One request at a time.
//
// The reader (child) trusts the server; the server trusts nothing of what it gets: sizes, seals, counts, indexes and numbers are checked.
// Failures: the reader dies (end of file on the socket), hangs (the server's deadline, then SIGKILL), sends something else (SIGKILL). When
// the server dies, the reader sees the socket's end, also in the middle of a request, and exits.
#pragma once

#include <chrono>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "reader/arrays.h"

namespace sim {

// `content`: no result, the stamp alone.
enum class AssetKind : std::uint32_t { triangles = 1, mesh, skin, animation, image, heights, content };

struct RequestHead {
  std::uint32_t magic = 0;
  AssetKind kind{};
  std::uint64_t cpu_seconds = 0;  // after which the reader is ended by SIGXCPU
};
struct AnswerHead {
  std::uint32_t magic = 0;
  std::uint32_t is_error = 0;
  std::uint64_t result_bytes = 0;  // before the stamps; a multiple of 8 but for an error
};

inline constexpr std::uint32_t asset_magic = 0x72746101;
inline constexpr int reader_socket = 3;  // the descriptor that the reader is started with
inline constexpr std::size_t max_request_bytes = 32768;
inline constexpr std::uint64_t max_answer_bytes = (std::uint64_t{1} << 30U) + (std::uint64_t{1} << 24U);  // the largest picture, and more
inline constexpr std::uint64_t max_reader_memory = std::uint64_t{4} << 30U;                               // of address space
inline constexpr std::uint64_t max_mesh_file = std::uint64_t{512} << 20U;
inline constexpr std::uint64_t max_image_file = std::uint64_t{1} << 30U;
inline constexpr std::size_t max_path = 4096;
inline constexpr std::size_t max_stamps = 4096;

// A file as it was when it was opened, or looked for.
struct FileStamp {
  std::string path;
  bool exists = false;
  std::uint64_t device = 0, inode = 0, size = 0;
  std::int64_t modified_ns = 0, changed_ns = 0;
  std::int64_t seen_ns = 0;  // when it was looked at
  std::string content{};     // hash of what was read (base/content_hash.h); empty: nothing was
};
// As it is now, without its content.
FileStamp stamp_of(const std::string& path);
// Of one path: nothing of what the system says about the file has changed.
bool is_same_state(const FileStamp& a, const FileStamp& b);
// False while the file was so young that another change could leave it with the same times: then the same state is not the same content.
bool is_settled(const FileStamp& stamp);
using FileStamps = std::vector<FileStamp>;
// True when stat alone says that all have the content that they had.
bool are_untouched(const FileStamps& files);
// Differs when the contents differ, or the states of files that were not read; never 0.
std::uint64_t version_of(const FileStamps& files);

void put(ArrayWriter& out, const FileStamps& files);
FileStamps take_stamps(ArrayReader& in);

}  // namespace sim
