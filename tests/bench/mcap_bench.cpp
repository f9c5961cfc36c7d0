// The writer of recordings beside a bare write(2) of the octets that it wrote: mcap_bench [FOLDER]. In turns, best of several; wall time
// and processor time of the process. Exit 1 when the limit is missed.
#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>

#include "mcap/mcap.h"

namespace {

namespace fs = std::filesystem;

constexpr std::size_t samples = 20'000, sample_size = 8'000;  // as of a scanner with a thousand beams
constexpr double limit = 0.7;
constexpr int rounds = 7;

struct Cost {
  double wall = 1e9, processor = 1e9;  // [s]
};

template <class Work>
void measure(Cost& best, Work work) {
  const auto used = [] {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const auto seconds = [](const timeval& t) { return static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_usec) * 1e-6; };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
  };
  const auto start = std::chrono::steady_clock::now();
  const double before = used();
  work();
  best.wall = std::min(best.wall, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  best.processor = std::min(best.processor, used() - before);
}

void write_recording(const fs::path& file, const std::string& data) {
  auto writer = mcap::Writer::create(file.string(), {.compression = mcap::Compression::none});
  const auto channel = writer->add_channel(0, "/scan", "cdr");
  for (std::uint64_t i = 0; i < samples; ++i) {
    const auto at = i * 64 % (data.size() - sample_size);
    (void)writer->write({*channel, static_cast<std::uint32_t>(i), mcap::Time(i), mcap::Time(i), {data.data() + at, sample_size}});
  }
  (void)writer->close();
}

void write_bare(const fs::path& file, const std::string& octets) {
  const int out = ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  constexpr std::size_t piece = std::size_t{1} << 20;
  for (std::size_t at = 0; at < octets.size(); at += piece) {
    if (::write(out, octets.data() + at, std::min(piece, octets.size() - at)) < 0) std::perror("write");
  }
  ::close(out);
}

}  // namespace

int main(int argc, char** argv) {
  const fs::path folder = argc > 1 ? fs::path(argv[1]) : fs::temp_directory_path();
  const auto ours = folder / ("mcap_bench-" + std::to_string(getpid()) + ".mcap");
  const auto bare = folder / ("mcap_bench-" + std::to_string(getpid()) + ".octets");
  std::string data(1 << 20, '\0');
  std::mt19937 random(1);
  for (char& octet : data) octet = static_cast<char>(random());
  Cost recorded, written;
  std::string octets;
  for (int round = 0; round < rounds; ++round) {
    measure(recorded, [&] { write_recording(ours, data); });
    if (octets.empty()) {
      std::ifstream in(ours, std::ios::binary);
      octets.assign(std::istreambuf_iterator<char>(in), {});
    }
    measure(written, [&] { write_bare(bare, octets); });
    fs::remove(ours);
    fs::remove(bare);
  }
  const double mega = static_cast<double>(octets.size()) * 1e-6;
  const auto row = [&](const char* what, double own, double other) {
    std::printf("| %-48s | %7.0f MB/s | %7.0f MB/s | %5.2f | >= %.1f | %s |\n", what, mega / own, mega / other, other / own, limit,
                other / own >= limit ? "ok" : "MISS");
  };
  row("writer of recordings, bare write: wall time", recorded.wall, written.wall);
  row("the same: processor time", recorded.processor, written.processor);
  return written.processor / recorded.processor >= limit ? 0 : 1;
}
