#include "run/warm_program.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <string>
#include <utility>

#include "run/same_math.h"

namespace editor {
namespace {

using base::Error;
using base::Result;

constexpr int answer_limit = 5'000;  // [ms] for a process to be made

struct Descriptor {
  int number = -1;
  explicit Descriptor(int opened) : number(opened) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (number >= 0) close(number);
  }
  int release() { return std::exchange(number, -1); }
};

std::string request_of(const ProgramCall& call) {
  std::string text;
  for (const auto& word : call.words) text += word + '\0';
  text += '\0';
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string variable = *entry;
    if (!variable.empty() && !call.environment.contains(variable.substr(0, variable.find('=')))) text += variable + '\0';
  }
  for (const auto& [key, value] : call.environment) text += key + "=" + value + '\0';
  return text;
}

bool send_with(int line, const std::string& text, int output, int watcher) {
  const std::array both{output, watcher};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof both)> control{};
  iovec data{const_cast<char*>(text.data()), text.size()};
  msghdr message{};
  message.msg_iov = &data;
  message.msg_iovlen = 1;
  message.msg_control = control.data();
  message.msg_controllen = control.size();
  cmsghdr* part = CMSG_FIRSTHDR(&message);
  part->cmsg_level = SOL_SOCKET;
  part->cmsg_type = SCM_RIGHTS;
  part->cmsg_len = CMSG_LEN(sizeof both);
  std::memcpy(CMSG_DATA(part), both.data(), sizeof both);
  return sendmsg(line, &message, MSG_NOSIGNAL) == static_cast<ssize_t>(text.size());
}

}  // namespace

std::optional<WarmProgram> WarmProgram::start(const std::string& name, std::map<std::string, std::string> environment, Reporter& reporter) {
  std::array<int, 2> ends{};
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0) return std::nullopt;
  Descriptor ours(ends[0]), theirs(ends[1]);
  ProgramCall call{{own_program(name), "--warm"}, std::move(environment), ""};
  call.input = theirs.number;
  auto started = ChildProcess::start(call);
  if (!started) return std::nullopt;
  return WarmProgram(std::move(*started), call.words.front(), ours.release(), reporter);
}

WarmProgram::~WarmProgram() {
  if (!program_) return;
  close(line_);  // it ends by itself then
  if (*is_silent_) kill(program_->pid(), SIGKILL);
}

bool WarmProgram::is_there() const {
  pollfd end{line_, 0, 0};  // a line whose other end is closed hangs up
  return poll(&end, 1, 0) == 0;
}

Result<ChildProcess> WarmProgram::make(const ProgramCall& call) const {
  if (*is_silent_ || !call.folder.empty() || call.input >= 0) return ChildProcess::start(call);
  const bool collects = call.output.empty();
  Descriptor output(collects ? memfd_create("output", MFD_CLOEXEC)
                             : open(call.output.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600));
  std::array<int, 2> ends{-1, -1};
  if (output.number < 0 || pipe2(ends.data(), O_CLOEXEC) != 0) return ChildProcess::start(call);
  Descriptor watched(ends[0]);
  Descriptor watcher(ends[1]);
  if (!send_with(line_, request_of(call), output.number, watcher.number)) return ChildProcess::start(call);
  close(watcher.release());  // theirs alone: its end is theirs
  pollfd event{watched.number, POLLIN, 0};
  int pid = 0;
  const int answers = poll(&event, 1, answer_limit);
  if (answers == 0 && !is_silent_->exchange(true))
    reporter_->warn(std::filesystem::path(path_).filename().string() + ": the prefork server did not respond within " +
                    std::to_string(answer_limit / 1000) + " s; processes are started directly");
  if (answers <= 0 || read(watched.number, &pid, sizeof pid) != sizeof pid) return ChildProcess::start(call);
  ChildProcess made(pid, collects ? output.release() : -1, std::filesystem::path(call.words[0]).filename().string(), call.ends_as_group);
  made.watched_ = watched.release();
  return made;
}

WarmPrograms::WarmPrograms(Reporter& reporter) {
  // What decides how they calculate is read when they are loaded.
  for (const auto& [name, environment] :
       {std::pair<const char*, std::map<std::string, std::string>>{"sim-server", {same_math()}}, {"rtcd", {same_math()}}}) {
    if (auto started = WarmProgram::start(name, environment, reporter)) programs_.push_back(std::move(*started));
  }
}

Result<ChildProcess> WarmPrograms::make(const ProgramCall& call) const {
  const auto program = std::ranges::find_if(programs_, [&](const WarmProgram& one) { return one.path() == call.words.front(); });
  return program == programs_.end() ? ChildProcess::start(call) : program->make(call);
}

std::size_t WarmPrograms::count() const {
  return static_cast<std::size_t>(std::ranges::count_if(programs_, [](const WarmProgram& one) { return one.is_there(); }));
}

Result<ChildProcess> start_program(const WarmPrograms* warm, const ProgramCall& call) {
  return warm != nullptr ? warm->make(call) : ChildProcess::start(call);
}

}  // namespace editor
