#include "run/warm_program.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <string>
#include <utility>

#include "run/same_math.h"

namespace editor {
namespace {

using base::Error;
using base::Result;

constexpr int patience = 10'000;  // [ms] for a process to be made

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

std::optional<WarmProgram> WarmProgram::start_simulator() {
  std::array<int, 2> ends{};
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0) return std::nullopt;
  Descriptor ours(ends[0]), theirs(ends[1]);
  ProgramCall call{{own_program("sim-server"), "--warm"}, {same_math()}, ""};
  call.input = theirs.number;
  auto started = ChildProcess::start(call);
  if (!started) return std::nullopt;
  return WarmProgram(std::move(*started), ours.release());
}

WarmProgram::~WarmProgram() {
  if (program_) close(line_);  // it ends by itself then
}

Result<ChildProcess> WarmProgram::start(const ProgramCall& call) const {
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
  if (poll(&event, 1, patience) <= 0 || read(watched.number, &pid, sizeof pid) != sizeof pid) return ChildProcess::start(call);
  ChildProcess made(pid, collects ? output.release() : -1, std::filesystem::path(call.words[0]).filename().string(), call.ends_as_group);
  made.watched_ = watched.release();
  return made;
}

}  // namespace editor
