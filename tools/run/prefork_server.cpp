#include "run/prefork_server.h"

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

#include "base/file_handle.h"
#include "base/packet.h"
#include "run/same_math.h"

namespace tools {
namespace {

using base::Error;
using base::Result;

constexpr int answer_limit = 5'000;  // [ms] for a process to be made

std::string request_of(const base::ProgramCall& call) {
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

}  // namespace

std::optional<PreforkServer> PreforkServer::start(const std::string& name, std::map<std::string, std::string> environment,
                                                  Reporter& reporter) {
  std::array<int, 2> ends{};
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0) return std::nullopt;
  base::FileHandle ours(ends[0]);
  const base::FileHandle theirs(ends[1]);
  base::ProgramCall call{{base::own_program(name), "--warm"}, std::move(environment), ""};
  call.input = theirs.get();
  auto started = base::ChildProcess::start(call);
  if (!started) return std::nullopt;
  return PreforkServer(std::move(*started), call.words.front(), ours.release(), reporter);
}

PreforkServer::~PreforkServer() {
  if (!program_) return;
  close(line_);  // it ends by itself then
  if (*is_silent_) kill(program_->pid(), SIGKILL);
}

bool PreforkServer::is_there() const {
  pollfd end{line_, 0, 0};  // a line whose other end is closed hangs up
  return poll(&end, 1, 0) == 0;
}

Result<base::ChildProcess> PreforkServer::make(const base::ProgramCall& call) const {
  if (*is_silent_ || !call.folder.empty() || call.input >= 0) return base::ChildProcess::start(call);
  const bool collects = call.output.empty();
  base::FileHandle output(collects ? memfd_create("output", MFD_CLOEXEC)
                                   : open(call.output.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600));
  std::array<int, 2> ends{-1, -1};
  if (output.get() < 0 || pipe2(ends.data(), O_CLOEXEC) != 0) return base::ChildProcess::start(call);
  base::FileHandle watched(ends[0]);
  base::FileHandle watcher(ends[1]);
  const std::string request = request_of(call);
  const std::array sent{output.get(), watcher.get()};
  if (!base::send_packet(line_, std::as_bytes(std::span(request)), sent)) return base::ChildProcess::start(call);
  watcher = base::FileHandle();  // theirs alone: its end is theirs
  pollfd event{watched.get(), POLLIN, 0};
  int pid = 0;
  const int answers = poll(&event, 1, answer_limit);
  if (answers == 0 && !is_silent_->exchange(true))
    reporter_->warn(std::filesystem::path(path_).filename().string() + ": the prefork server did not respond within " +
                    std::to_string(answer_limit / 1000) + " s; processes are started directly");
  if (answers <= 0 || read(watched.get(), &pid, sizeof pid) != sizeof pid) return base::ChildProcess::start(call);
  return base::ChildProcess::made_elsewhere(pid, watched.release(), collects ? output.release() : -1,
                                            std::filesystem::path(call.words[0]).filename().string(), call.ends_as_group);
}

PreforkServers::PreforkServers(Reporter& reporter) {
  // What decides how they calculate is read when they are loaded.
  for (const auto& [name, environment] :
       {std::pair<const char*, std::map<std::string, std::string>>{"sim-server", {same_math()}}, {"rtcd", {same_math()}}}) {
    if (auto started = PreforkServer::start(name, environment, reporter)) programs_.push_back(std::move(*started));
  }
}

Result<base::ChildProcess> PreforkServers::make(const base::ProgramCall& call) const {
  const auto program = std::ranges::find_if(programs_, [&](const PreforkServer& one) { return one.path() == call.words.front(); });
  return program == programs_.end() ? base::ChildProcess::start(call) : program->make(call);
}

std::size_t PreforkServers::count() const {
  return static_cast<std::size_t>(std::ranges::count_if(programs_, [](const PreforkServer& one) { return one.is_there(); }));
}

Result<base::ChildProcess> start_program(const PreforkServers* prefork, const base::ProgramCall& call) {
  return prefork != nullptr ? prefork->make(call) : base::ChildProcess::start(call);
}

}  // namespace tools
