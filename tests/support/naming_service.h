// omniNames for a test: on a free port of the loopback interface with data of its own, gone with the object. One thread at a time.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>

#include "support/process.h"

namespace support {

// A port of 127.0.0.1 that was free a moment ago.
inline int free_port() {
  const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  if (bind(socket, reinterpret_cast<sockaddr*>(&address), size) != 0) throw std::runtime_error("bind");
  getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size);
  close(socket);
  return ntohs(address.sin_port);
}

inline bool is_listening(int port) {
  const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  const bool answered = connect(socket, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0;
  close(socket);
  return answered;
}

// A folder under the system's temporary folder, removed with everything in it.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    auto pattern = (std::filesystem::temp_directory_path() / "rtmsim-test-XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("mkdtemp");
    path_ = pattern;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

class NamingService {
 public:
  // Ready to answer when the constructor returns.
  NamingService() {
    for (int attempt = 0; attempt < 10; ++attempt) {
      port_ = free_port();
      if (launch()) return;
    }
    throw std::runtime_error("omniNames does not start: " + (process_ ? process_->output() : std::string()));
  }

  int port() const { return port_; }
  // "127.0.0.1:PORT", what corba.nameservers takes.
  std::string address() const { return "127.0.0.1:" + std::to_string(port_); }
  Process& process() { return *process_; }

  // As a crash would end it.
  void kill() { process_.reset(); }
  // On the same port. forget: with empty data, as after a reboot of its host.
  void start_again(bool forget) {
    process_.reset();
    if (forget) {
      for (const auto& entry : std::filesystem::directory_iterator(data_.path())) std::filesystem::remove_all(entry);
    }
    for (int attempt = 0; attempt < 50; ++attempt) {
      if (launch()) return;
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    throw std::runtime_error("omniNames does not start again");
  }

 private:
  bool launch() {
    process_ =
        std::make_unique<Process>(std::vector<std::string>{"omniNames", "-always", "-ignoreport", "-start", std::to_string(port_),
                                                           "-datadir", data_.path().string(), "-ORBendPoint", "giop:tcp:" + address()});
    const auto deadline = std::chrono::steady_clock::now() + watchdog;
    while (process_->running() && std::chrono::steady_clock::now() < deadline) {
      // It listens before it knows its names; the first checkpoint comes after both.
      if (process_->wait_for_output("Checkpointing completed", std::chrono::milliseconds(200))) return is_listening(port_);
    }
    return false;
  }

  TemporaryFolder data_;
  int port_ = 0;
  std::unique_ptr<Process> process_;
};

}  // namespace support
