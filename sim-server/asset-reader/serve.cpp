#include "asset-reader/serve.h"

#include <fcntl.h>
#include <malloc.h>
#include <poll.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <span>
#include <string>
#include <thread>

#include "asset-reader/jobs.h"
#include "base/packet.h"
#include "reader/protocol.h"

namespace sim {
namespace {

void limit(__rlimit_resource what, rlim_t most) {
  rlimit now{};
  getrlimit(what, &now);
  if (now.rlim_cur != RLIM_INFINITY && now.rlim_cur < most) most = now.rlim_cur;  // the server has less itself
  const rlimit wanted{most, most};
  setrlimit(what, &wanted);
}

void set_limits() {
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_NOFILE, 64);
  limit(RLIMIT_FSIZE, max_answer_bytes);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  limit(RLIMIT_AS, max_reader_memory);
#endif
  // When the memory of the machine runs out, this process ends before any other.
  if (const int file = ::open("/proc/self/oom_score_adj", O_WRONLY | O_CLOEXEC); file >= 0) {
    static_cast<void>(::write(file, "1000", 4));
    ::close(file);
  }
}

// From now on; the limit counts what this process has used before.
void limit_time(std::uint64_t seconds) {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  rlimit time{};
  getrlimit(RLIMIT_CPU, &time);
  time.rlim_cur = static_cast<rlim_t>(used.ru_utime.tv_sec + used.ru_stime.tv_sec + 1) + seconds;
  if (time.rlim_max != RLIM_INFINITY && time.rlim_cur > time.rlim_max) time.rlim_cur = time.rlim_max;
  setrlimit(RLIMIT_CPU, &time);
}

// The server's end of the socket is closed when the server ends, however it ends; this process may be in the middle of a file then.
std::jthread end_with_server() {
  return std::jthread([] {
    pollfd socket{reader_socket, POLLRDHUP, 0};
    while (::poll(&socket, 1, -1) <= 0) {
    }
    ::_exit(0);
  });
}

struct Request {
  std::string words;
  base::FileHandle content;
};

bool receive(Request& request) {
  request.words.resize(max_request_bytes);
  auto packet = base::receive_packet(reader_socket, std::as_writable_bytes(std::span(request.words)));
  if (!packet) return false;
  request.words.resize(packet->size);
  request.content = packet->files.empty() ? base::FileHandle() : std::move(packet->files.front());
  return true;
}

std::string all_of(int file) {
  std::string bytes;
  struct stat is {};
  if (::fstat(file, &is) == 0) bytes.resize(static_cast<std::size_t>(is.st_size));
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t count = ::pread(file, bytes.data() + done, bytes.size() - done, static_cast<off_t>(done));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    done += static_cast<std::size_t>(count);
  }
  bytes.resize(done);
  return bytes;
}

// False: the server has gone, or there is no memory for an answer.
bool answer(const Request& request) {
  ArrayReader in(std::as_bytes(std::span(request.words)));
  const auto head = in.number<RequestHead>();
  if (head.magic != asset_magic) return false;
  limit_time(head.cpu_seconds);
  FileLog files;
  const std::string path = in.text(max_path);
  const bool has_content = in.number<std::uint64_t>() != 0;
  const std::string content = has_content && request.content.get() >= 0 ? all_of(request.content.get()) : std::string();
  const base::FileHandle made(::memfd_create("rtm-asset", MFD_CLOEXEC | MFD_ALLOW_SEALING));
  const int memory = made.get();
  if (memory < 0) return false;
  ArrayWriter out(memory);
  Job job{path, in, has_content, {reinterpret_cast<const std::uint8_t*>(content.data()), content.size()}, files, out};
  auto done = read_asset(head.kind, job);
  if (done && !out.finish()) done = base::Error{"is too large for the memory"};
  AnswerHead result{asset_magic, done ? 0U : 1U, out.size()};
  ArrayWriter rest(memory);
  if (!done) {
    result.result_bytes = done.error().message.size();
    if (::ftruncate(memory, 0) != 0 || ::lseek(memory, 0, SEEK_SET) != 0) return false;
    std::string padded = done.error().message;
    padded.resize((padded.size() + 7) / 8 * 8, ' ');
    if (::write(memory, padded.data(), padded.size()) != static_cast<ssize_t>(padded.size())) return false;
  }
  put(rest, files.stamps());
  return rest.finish() && ::fcntl(memory, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_WRITE | F_SEAL_SEAL) == 0 &&
         base::send_packet(reader_socket, std::as_bytes(std::span(&result, 1)), std::span(&memory, 1));
}

}  // namespace

int serve_assets() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) ::signal(signal, SIG_IGN);  // it ends with its server
  set_limits();
  const std::jthread end = end_with_server();
  Request request;
  while (receive(request) && answer(request)) ::malloc_trim(0);  // it may have nothing to do for hours
  ::shutdown(reader_socket, SHUT_RDWR);                          // the thread sees it
  return 0;
}

}  // namespace sim
