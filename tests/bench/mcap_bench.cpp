// mcap_bench [FOLDER]: the writer of recordings beside a bare write(2) of the octets that it wrote, in turns, best of several, wall time
// and processor time of the process; and a place in a recording of an hour, whose octets are in the memory of the machine or on its disk
// alone. mcap_bench --hour FILE only writes such a recording. Exit 1 when a limit is missed.
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
#include <string_view>
#include <vector>

#include "recording/mcap/mcap.h"
#include "support/usage.h"

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

// ---- an hour ----

using namespace std::chrono_literals;

constexpr std::uint64_t hour_ms = 3'600'000;

// What a robot with a scanner and a camera says in an hour: a scan of 682 beams ten times a second, a picture of 6 kB five times, odometry
// and poses fifty times. Flushed twice a second, as a recording in real time is.
void write_hour(const fs::path& file) {
  auto writer = mcap::Writer::create(file.string());
  const auto scans = writer->add_schema("bench_msgs/msg/Scan", "ros2msg", "float32[] ranges\n");
  const auto octets = writer->add_schema("bench_msgs/msg/Octets", "ros2msg", "uint8[] data\n");
  struct Source {
    std::uint16_t channel;
    std::uint64_t period;  // [ms]
    std::size_t size, element;
    std::uint32_t sequence = 0;
  };
  std::vector<Source> sources = {{*writer->add_channel(*scans, "/scan", "cdr"), 100, 682 * 4, 4},
                                 {*writer->add_channel(*octets, "/image", "cdr"), 200, 6000, 1},
                                 {*writer->add_channel(*octets, "/odometry", "cdr"), 20, 720, 1},
                                 {*writer->add_channel(*octets, "/tf", "cdr"), 20, 300, 1}};
  std::mt19937 random(1);
  std::string noise(1 << 16, '\0');
  for (char& octet : noise) octet = static_cast<char>(random() % 64);
  for (std::uint64_t ms = 0; ms < hour_ms; ms += 20) {
    for (Source& source : sources) {
      if (ms % source.period != 0) continue;
      std::string data("\0\1\0\0", 4);
      const auto count = static_cast<std::uint32_t>(source.size / source.element);
      data.append(reinterpret_cast<const char*>(&count), sizeof count).append(noise, random() % (noise.size() - source.size), source.size);
      const mcap::Time time(ms * 1'000'000);
      (void)writer->write({source.channel, source.sequence++, time, time, data});
    }
    if (ms % 500 == 0) (void)writer->flush();
  }
  (void)writer->close();
}

// The file is opened, and the first scan from 50 minutes on is read [s].
Cost seek_cost(const fs::path& file, bool is_in_memory) {
  Cost best;
  for (int round = 0; round < rounds; ++round) {
    if (!is_in_memory) {
      const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
      ::fsync(descriptor);
      ::posix_fadvise(descriptor, 0, 0, POSIX_FADV_DONTNEED);
      ::close(descriptor);
    }
    measure(best, [&] {
      auto reader = mcap::Reader::open(file.string());
      reader->seek({.channels = {1}, .from = 3000s});
      const auto message = reader->next();
      if (!message || !*message || (*message)->log_time != 3000s) std::puts("the sample at 3000 s is not there");
    });
  }
  return best;
}

bool seek_in_an_hour(const fs::path& folder) {
  const auto file = folder / ("mcap_bench-" + std::to_string(getpid()) + "-hour.mcap");
  write_hour(file);
  constexpr double most = 0.050;  // [s]
  const auto row = [&](const char* what, double seconds) {
    std::printf("| %-48s | %7.1f ms   |              |       | <= %.0f | %s |\n", what, 1000 * seconds, 1000 * most,
                seconds <= most ? "ok" : "MISS");
    return seconds <= most;
  };
  std::printf("a recording of an hour, %.0f MB\n", static_cast<double>(fs::file_size(file)) * 1e-6);
  const Cost memory = seek_cost(file, true), disk = seek_cost(file, false);
  const bool is_met = row("opened and read at 3000 s: wall time", memory.wall);
  row("the same: processor time", memory.processor);
  const bool is_met_cold = row("not in the memory of the machine: wall time", disk.wall);
  fs::remove(file);
  return is_met && is_met_cold;
}

}  // namespace

int main(int argc, char** argv) {
  ::test::answer_help(
      argc, argv,
      "mcap_bench [FOLDER]\n       mcap_bench --hour FILE\nMeasures recordings beside plain files; --hour writes a recording of an hour.");
  if (argc > 2 && std::string_view(argv[1]) == "--hour") return write_hour(argv[2]), 0;
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
  const bool is_found = seek_in_an_hour(folder);
  return written.processor / recorded.processor >= limit && is_found ? 0 : 1;
}
