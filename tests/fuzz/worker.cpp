#include "fuzz/worker.h"

#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <memory>
#include <string_view>

#include "base/file_handle.h"
#include "base/text.h"
#include "fuzz/memory_budget.h"

namespace fuzz {
namespace {

constexpr unsigned job_limit = 60;  // [s]
constexpr long jobs_of_child = 5000;

constexpr std::array<std::string_view, 9> runtime_libraries{"libasan.",  "libubsan.", "libc.so",    "libc-2",   "libm.so",
                                                            "libstdc++", "libgcc_s",  "libpthread", "ld-linux-"};
constexpr std::array<std::string_view, 8> parsers{"libassimp.", "libpng",  "libturbojpeg", "libjpeg",
                                                  "libtiff",    "libz.so", "libpugixml",   "libminizip"};

bool begins_with_one_of(std::string_view name, const auto& list) {
  return std::any_of(list.begin(), list.end(), [&](std::string_view begin) { return name.starts_with(begin); });
}

// Relaxed: the parent reads it when the child has ended.
struct Shared {
  std::atomic<long> at{0}, good{0};
  long next() const { return at.load(std::memory_order_relaxed); }
};

[[noreturn]] void be_worker(Shared& shared, const Work& work, int report) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  ::dup2(report, STDERR_FILENO);
  ::close_range(STDERR_FILENO + 1, ~0U, 0);
  limit_memory(work.memory);
  work.prepare();
  do {
    ::alarm(job_limit);
    if (work.job(shared.next())) shared.good.fetch_add(1, std::memory_order_relaxed);
    shared.at.fetch_add(1, std::memory_order_relaxed);
  } while (shared.next() < work.count && shared.next() % jobs_of_child != 0);
  ::_exit(0);
}

std::string content_of(int file) {
  std::string text(std::size_t{1} << 16U, '\0');
  const ssize_t size = ::pread(file, text.data(), text.size(), 0);
  text.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
  return text;
}

// What the sanitizer calls the fault: "heap-buffer-overflow", "SEGV", "runtime error: ...".
std::string name_of_fault(const std::string& report) {
  if (const auto at = report.find("runtime error: "); at != std::string::npos) return report.substr(at, report.find('\n', at) - at);
  constexpr std::string_view begin = "ERROR: AddressSanitizer: ";
  const auto at = report.find(begin);
  return at == std::string::npos ? ""
                                 : report.substr(at + begin.size(), report.find_first_of(" \n", at + begin.size()) - at - begin.size());
}

Ending ending_of(int status, std::string report) {
  Ending ending;
  const int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  ending.is_late = signal == SIGKILL || signal == SIGXCPU;
  const std::string frame = first_frame(report);
  ending.how = name_of_fault(report);
  if (ending.how.empty())
    ending.how = signal != 0 ? "signal " + std::to_string(signal) : "exit status " + std::to_string(WEXITSTATUS(status));
  if (!frame.empty()) ending.how += " in " + frame;
  // Without a report of a sanitizer the place is not known.
  ending.is_own_code = !ending.is_late && !name_of_fault(report).empty() && !begins_with_one_of(frame, parsers);
  ending.report = std::move(report);
  return ending;
}

}  // namespace

std::string first_frame(const std::string& report) {
  for (const std::string& line : base::split_list(report, '\n')) {
    const auto address = line.find("0x"), open = line.find('('), plus = line.rfind("+0x");
    if (!line.starts_with('#') || open == std::string::npos || plus == std::string::npos || plus < open) continue;
    if (address < open && is_allocation(std::strtoull(line.c_str() + address, nullptr, 16))) continue;
    const std::string module = line.substr(open + 1, plus - open - 1);
    const std::string name = module.substr(module.rfind('/') + 1);
    if (!begins_with_one_of(name, runtime_libraries)) return name + line.substr(plus, line.find_first_of(") ", plus) - plus);
  }
  return {};
}

void run_in_children(const Work& work) {
  void* memory = ::mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) return;
  auto& shared = *std::construct_at(static_cast<Shared*>(memory));
  while (shared.next() < work.count) {
    const base::FileHandle report(::memfd_create("report", MFD_CLOEXEC));
    const pid_t child = ::fork();
    if (child < 0) break;
    if (child == 0) be_worker(shared, work, report.get());
    int status = 0;
    while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    if (status != 0) {
      work.ended(shared.next(), ending_of(status, content_of(report.get())));
      shared.at.fetch_add(1, std::memory_order_relaxed);
    }
    if (shared.next() >= work.count || shared.next() % jobs_of_child == 0)
      work.has_progress({shared.next(), shared.good.load(std::memory_order_relaxed)});
  }
  ::munmap(memory, sizeof(Shared));
}

}  // namespace fuzz
