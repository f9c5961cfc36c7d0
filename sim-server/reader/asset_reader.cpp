#include "reader/asset_reader.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

#include "base/file_handle.h"
#include "base/packet.h"
#include "base/text.h"

namespace sim {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds stop_period{200};  // after which stop() is noticed

std::optional<Clock::time_point>& thread_deadline() {
  thread_local std::optional<Clock::time_point> when;
  return when;
}

base::Error broken(const char* what, int code) { return {std::string(what) + ": " + std::generic_category().message(code)}; }

// The head and its descriptor; none when something else came.
struct Packet {
  bool is_end = false;
  AnswerHead head;
  base::FileHandle file;
};
Packet receive_answer(int socket) {
  Packet packet;
  auto received = base::receive_packet(socket, std::as_writable_bytes(std::span(&packet.head, 1)), MSG_DONTWAIT);
  packet.is_end = !received;
  if (received && received->size == sizeof packet.head && packet.head.magic == asset_magic && received->files.size() == 1)
    packet.file = std::move(received->files.front());
  return packet;
}

// The content of a picture, for the reader to see and nobody to change.
base::FileHandle memory_with(std::span<const std::uint8_t> content) {
  base::FileHandle memory(::memfd_create("rtm-asset", MFD_CLOEXEC | MFD_ALLOW_SEALING));
  std::size_t done = 0;
  while (memory.get() >= 0 && done < content.size()) {
    const ssize_t count = ::write(memory.get(), content.data() + done, content.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return base::FileHandle();
    done += static_cast<std::size_t>(count);
  }
  return memory;
}

// rtm-asset-reader, with this end of the socket.
base::Result<pid_t> run_program(int socket) {
  std::error_code problem;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", problem).parent_path() / "rtm-asset-reader";
  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
  posix_spawn_file_actions_init(&actions);
  posix_spawnattr_init(&attributes);
  for (const int standard : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
#if defined(__SANITIZE_ADDRESS__)
    if (standard == STDERR_FILENO) continue;  // its reports
#endif
    posix_spawn_file_actions_addopen(&actions, standard, "/dev/null", standard == STDIN_FILENO ? O_RDONLY : O_WRONLY, 0);
  }
  posix_spawn_file_actions_adddup2(&actions, socket, reader_socket);
  posix_spawn_file_actions_addclosefrom_np(&actions, reader_socket + 1);
  sigset_t none, all;
  sigemptyset(&none);
  sigfillset(&all);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setsigdefault(&attributes, &all);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  std::string name = program.string(), job = "--socket";
  char* words[] = {name.data(), job.data(), nullptr};
  pid_t pid = 0;
  const int failed = ::posix_spawn(&pid, program.c_str(), &actions, &attributes, words, environ);
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  if (failed != 0) return broken(("the reader of files does not start, " + program.string()).c_str(), failed);
  return pid;
}

std::string reason_of(int status, const ReadLimits& limits) {
  if (WIFEXITED(status)) return "is damaged: its reader ended with exit status " + std::to_string(WEXITSTATUS(status));
  const int signal = WTERMSIG(status);
  if (signal == SIGXCPU) return "takes more than " + std::to_string(limits.cpu.count()) + " s of processor time to read";
  if (signal == SIGXFSZ) return "is larger than " + std::to_string(max_answer_bytes >> 20U) + " MiB when read";
  if (signal == SIGKILL) return "was not read: its reader was killed";
  const char* name = ::sigdescr_np(signal);
  return "is damaged: its reader ended with signal " + std::to_string(signal) + " (" + (name == nullptr ? "unknown" : name) + ")";
}

}  // namespace

ReadDeadline::ReadDeadline(std::chrono::steady_clock::time_point when) : before_(thread_deadline()) {
  thread_deadline() = before_ ? std::min(*before_, when) : when;
}
ReadDeadline::~ReadDeadline() { thread_deadline() = before_; }

std::shared_ptr<const SealedMemory> SealedMemory::map(int file, std::uint64_t most) {
  const base::FileHandle memory(file);
  errno = 0;
  constexpr int needed = F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_WRITE;
  const int seals = ::fcntl(file, F_GET_SEALS);
  struct stat is {};
  if (seals < 0 || (seals & needed) != needed || ::fstat(file, &is) != 0 || is.st_size < 0 || static_cast<std::uint64_t>(is.st_size) > most)
    return nullptr;
  const auto size = static_cast<std::size_t>(is.st_size);
  if (size == 0) return nullptr;
  void* data = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file, 0);
  if (data == MAP_FAILED) return nullptr;  // errno says why, and closing the descriptor keeps it
  return std::shared_ptr<const SealedMemory>(new SealedMemory(static_cast<const std::byte*>(data), size));
}
SealedMemory::~SealedMemory() { ::munmap(const_cast<std::byte*>(data_), size_); }

// A reader that was started and has not been waited for.
struct AssetReader::Child {
  pid_t pid = 0;
  base::FileHandle socket;

  static base::Result<std::unique_ptr<Child>> start(const Starter& starter);
  ~Child() { static_cast<void>(end()); }
  // Ends it when it has not ended; its status. Again: the same.
  int end() {
    if (!status_) {
      // One that is ending already keeps the status that it ends with.
      ::kill(pid, SIGKILL);
      int status = 0;
      while (::waitpid(pid, &status, 0) < 0 && errno == EINTR) {
      }
      status_ = status;
      socket = base::FileHandle();
    }
    return *status_;
  }

 private:
  std::optional<int> status_;
};

base::Result<std::unique_ptr<AssetReader::Child>> AssetReader::Child::start(const Starter& starter) {
  int ends[2] = {-1, -1};
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0) return broken("no socket for the reader of files", errno);
  auto child = std::make_unique<Child>();
  child->socket = base::FileHandle(ends[0]);
  // Above the number that it gets: a descriptor that is put in its own place would stay closed on exec.
  const base::FileHandle theirs(::fcntl(ends[1], F_DUPFD_CLOEXEC, 10));
  ::close(ends[1]);
  const auto pid = starter ? starter(theirs.get()) : run_program(theirs.get());
  if (!pid) {
    child->status_ = 0;
    return pid.error();
  }
  child->pid = *pid;
  return child;
}

struct AssetReader::State {
  Starter starter;    // empty: run_program
  base::Turn<> turn;  // everything below is for the thread that has it
  std::unique_ptr<Child> child;
  // Files that a reader has ended with.
  struct Deadly {
    FileStamp stamp;
    std::string reason;
  };
  std::map<std::string, Deadly> deadly;
  void remember(const std::string& path, const FileStamp& stamp, const std::string& reason) {
    if (deadly.size() >= max_stamps) deadly.clear();
    deadly.insert_or_assign(path, Deadly{stamp, reason});
  }
  std::atomic<bool> is_stopped{false};
  std::atomic<pid_t> process{0};  // relaxed: for people and tests
  std::atomic<std::size_t> started{0};

  base::Result<Child*> reader() {
    if (child) return child.get();
    auto made = Child::start(starter);
    if (!made) return made.error();
    child = std::move(*made);
    process.store(child->pid, std::memory_order_relaxed);
    started.fetch_add(1, std::memory_order_relaxed);
    return child.get();
  }
  // False: no answer by the deadline, or the simulator ends.
  bool await_answer(int socket, Clock::time_point deadline) const {
    pollfd waiting{socket, POLLIN, 0};
    while (true) {
      const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now());
      const int ready = left > left.zero() ? ::poll(&waiting, 1, static_cast<int>(std::min(left, stop_period).count())) : 0;
      const bool stops = is_stopped.load(std::memory_order_acquire);  // pairs with the release in stop
      if (stops || !((ready < 0 && errno == EINTR) || (ready == 0 && Clock::now() < deadline))) return ready > 0;
    }
  }
  int end_reader() {
    const int status = child->end();
    child.reset();
    process.store(0, std::memory_order_relaxed);
    return status;
  }
};

AssetReader& AssetReader::mine() {
  static auto& reader = *new AssetReader;  // never destroyed: threads may still read at the very end, and the process ends with its socket
  return reader;
}
AssetReader::AssetReader() : state_(std::make_unique<State>()) {}
AssetReader::~AssetReader() = default;
void AssetReader::stop() { state_->is_stopped.store(true, std::memory_order_release); }  // pairs with the acquires in ask
void AssetReader::start_by(Starter starter) { state_->starter = std::move(starter); }
pid_t AssetReader::process() const { return state_->process.load(std::memory_order_relaxed); }
std::size_t AssetReader::started() const { return state_->started.load(std::memory_order_relaxed); }

std::optional<FileStamps> AssetReader::unchanged(const FileStamps& files) {
  FileStamps all;
  for (const FileStamp& file : files) {
    FileStamp now = stamp_of(file.path);
    const bool is_same = is_same_state(file, now);
    if (is_same && (file.content.empty() || is_settled(file))) {
      all.push_back(file);
      continue;
    }
    if (file.content.empty() || !now.exists || now.size != file.size) return std::nullopt;
    const Answer answer = ask({AssetKind::content, file.path, "file", {}});
    if (answer.error || answer.files.empty() || answer.files.front().content != file.content) return std::nullopt;
    all.push_back(answer.files.front());
  }
  return all;
}

namespace {

std::string words_of(const AssetReader::Question& question, const ReadLimits& limits) {
  ArrayWriter packet;
  packet.number(RequestHead{asset_magic, question.kind, static_cast<std::uint64_t>(limits.cpu.count())});
  packet.text(question.path);
  packet.number<std::uint64_t>(question.content.data() == nullptr ? 0 : 1);
  return packet.bytes() + question.details;
}

// What a reader that answered made of the file; an error when its answer is damaged.
base::Result<AssetReader::Answer> result_of(Packet& answer, const FileStamp& stamp) {
  errno = 0;
  const auto memory = answer.file.get() >= 0 ? SealedMemory::map(answer.file.release(), max_answer_bytes) : nullptr;
  const bool is_short = !memory && errno == ENOMEM;
  const std::size_t padded = memory ? (static_cast<std::size_t>(answer.head.result_bytes) + 7) / 8 * 8 : 0;
  if (!memory || answer.head.result_bytes > memory->bytes().size() || padded > memory->bytes().size())
    return base::Error{is_short ? "is too large for the memory" : "is damaged: its reader sent no result"};
  ArrayReader rest(memory->bytes().subspan(padded));
  FileStamps files = take_stamps(rest);
  if (!rest.ok()) files = {stamp};
  const auto result = memory->bytes().first(static_cast<std::size_t>(answer.head.result_bytes));
  if (answer.head.is_error == 0) return AssetReader::Answer{std::nullopt, memory, result, std::move(files)};
  std::string why(reinterpret_cast<const char*>(result.data()), std::min<std::size_t>(result.size(), 1000));
  // One line of printable characters, whatever the reader made of the file.
  for (char& c : why) c = static_cast<unsigned char>(c) < 32 || c == 127 ? ' ' : c;
  return AssetReader::Answer{base::Error{why}, nullptr, {}, std::move(files)};
}

}  // namespace

AssetReader::Answer AssetReader::ask(const Question& question, const ReadLimits& limits) {
  base::expect_no_data_held();
  const auto mine = state_->turn.take();
  const bool is_file = question.content.data() == nullptr;
  const std::string who = question.what + " " + question.path + ": ";
  const auto fail = [&](const std::string& why, FileStamps files) { return Answer{base::Error{who + why}, nullptr, {}, std::move(files)}; };
  const FileStamp stamp = is_file ? stamp_of(question.path) : FileStamp{};
  if (const auto known = state_->deadly.find(question.path); is_file && known != state_->deadly.end()) {
    if (is_same_state(known->second.stamp, stamp)) return fail(known->second.reason, {stamp});
    state_->deadly.erase(known);
  }

  const std::string words = words_of(question, limits);
  if (words.size() > max_request_bytes || question.path.size() > max_path || question.path.find('\0') != std::string::npos)
    return fail("has too long a name", {});
  base::FileHandle content;
  std::vector<int> sent;
  if (!is_file) {
    content = memory_with(question.content);
    if (content.get() < 0) return fail("the memory is not enough to read it", {});
    sent.push_back(content.get());
  }

  const auto own_deadline = Clock::now() + limits.wall;
  const auto deadline = thread_deadline() ? std::min(own_deadline, *thread_deadline()) : own_deadline;
  if (state_->is_stopped.load(std::memory_order_acquire))
    return fail("was not read: the simulator ends", {});  // pairs with the release in stop
  if (Clock::now() >= deadline) return fail("was not read: the time for all files of this model is over", {});
  // A reader that was killed while it had nothing to do, or by somebody else, is no reason to go without the file.
  for (int attempt = 0;; ++attempt) {
    const auto reader = state_->reader();
    if (!reader) return fail(reader.error().message, {});
    Packet answer;
    bool is_late = false;
    if (base::send_packet((*reader)->socket.get(), std::as_bytes(std::span(words)), sent, MSG_DONTWAIT)) {
      is_late = !state_->await_answer((*reader)->socket.get(), deadline);
      if (!is_late) answer = receive_answer((*reader)->socket.get());
    } else {
      answer.is_end = true;
    }
    if (is_late) {
      state_->end_reader();
      const std::string reason = "was not read in time";
      if (!is_file || deadline < own_deadline) return fail(reason, {});
      state_->remember(question.path, stamp, reason + " (" + std::to_string(limits.wall.count()) + " s)");
      return fail(state_->deadly.at(question.path).reason, {stamp});
    }
    if (answer.is_end) {
      const int status = state_->end_reader();
      if (attempt == 0 && WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL) continue;
      const std::string reason = reason_of(status, limits);
      const bool is_by_file = !(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
      if (is_file && is_by_file) state_->remember(question.path, stamp, reason);
      return fail(reason, is_by_file && is_file ? FileStamps{stamp} : FileStamps{});
    }
    auto result = result_of(answer, stamp);
    if (!result) state_->end_reader();
    if (!result || result->error)
      return fail(result ? result->error->message : result.error().message, result ? result->files : FileStamps{stamp});
    return *result;
  }
}

}  // namespace sim
