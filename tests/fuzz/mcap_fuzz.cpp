// Octets of a recording: whatever comes is read to its end or refused with a line; memory stays bounded. Mutates good files; prints its
// seed. mcap_fuzz [--runs N] [--seed N]
#include <sys/resource.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "mcap/mcap.h"

namespace {

namespace fs = std::filesystem;

std::string octets_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::string make_recording(const std::string& path, mcap::Compression compression, std::size_t chunk_size) {
  auto writer = mcap::Writer::create(path, {.profile = "rtm", .compression = compression, .chunk_size = chunk_size});
  const auto schema = writer->add_schema("T", "omgidl", "struct T { long a; };");
  const auto first = writer->add_channel(*schema, "/one", "cdr", {{"key", "value"}});
  const auto second = writer->add_channel(0, "/two", "json");
  for (std::uint64_t n = 0; n < 40; ++n) {
    const std::string data(n * 7 % 50, static_cast<char>(n));
    (void)writer->write({n % 3 == 0 ? *second : *first, static_cast<std::uint32_t>(n), mcap::Time(n / 4), mcap::Time(n), data});
    if (n == 20) (void)writer->attach({mcap::Time(n), mcap::Time(n), "name", "text/plain", "text"});
  }
  (void)writer->add_metadata({"run", {{"a", "b"}}});
  (void)writer->close();
  return octets_of(path);
}

void mutate(std::string& octets, std::mt19937& random) {
  const auto below = [&](std::size_t end) { return end == 0 ? 0 : random() % end; };
  for (std::size_t i = below(6) + 1; i > 0; --i) {
    switch (below(6)) {
      case 0:
      case 1:
        if (!octets.empty()) octets[below(octets.size())] = static_cast<char>(random());
        break;
      case 2:
        octets.resize(below(octets.size() + 1));
        break;
      case 3:
        octets.insert(below(octets.size() + 1), octets.substr(below(octets.size() + 1), below(100)));
        break;
      default: {  // a length, a count or an offset that lies
        static constexpr std::uint64_t numbers[] = {0, 1, 0xff, 0xffff, 0x7fffffff, 0xffffffff, 1ull << 40, 1ull << 63, UINT64_MAX};
        const std::uint64_t number = numbers[below(std::size(numbers))];
        const std::size_t size = below(2) == 0 ? 4 : 8;
        if (octets.size() >= size) std::memcpy(octets.data() + below(octets.size() - size + 1), &number, size);
      }
    }
  }
}

// The number of messages and errors; ends, since each error costs one chunk.
std::size_t read_all(const std::string& path) {
  auto reader = mcap::Reader::open(path);
  if (!reader) return 0;
  (void)reader->metadata();
  (void)reader->attachment("name");
  std::size_t answers = 0;
  for (;; ++answers) {
    const auto message = reader->next();
    if (message && !message->has_value()) return answers;
    if (answers > 1'000'000) {
      std::fprintf(stderr, "mcap_fuzz: reading does not end\n");
      std::abort();
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  unsigned long runs = 20000;
  unsigned long seed = std::random_device{}();
  for (int i = 1; i + 1 < argc; i += 2) {
    if (std::strcmp(argv[i], "--runs") == 0) runs = std::strtoul(argv[i + 1], nullptr, 10);
    if (std::strcmp(argv[i], "--seed") == 0) seed = std::strtoul(argv[i + 1], nullptr, 10);
  }
  std::printf("seed %lu\n", seed);
  const fs::path folder = fs::temp_directory_path() / ("mcap_fuzz_" + std::to_string(getpid()));
  fs::create_directory(folder);
  const std::string path = (folder / "file.mcap").string();
  const std::vector<std::string> seeds = {
      make_recording(path, mcap::Compression::zstd, 200), make_recording(path, mcap::Compression::lz4, 400),
      make_recording(path, mcap::Compression::none, 100), make_recording(path, mcap::Compression::none, 1 << 20)};
  std::mt19937 random(static_cast<std::mt19937::result_type>(seed));
  std::size_t answers = 0;
  for (unsigned long run = 0; run < runs; ++run) {
    std::string octets = seeds[random() % seeds.size()];
    mutate(octets, random);
    std::ofstream(path, std::ios::binary | std::ios::trunc) << octets;
    answers += read_all(path);
    if (run % 8 == 0) (void)mcap::repair(path, path + ".again");
  }
  fs::remove_all(folder);
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  std::printf("%lu files, %zu messages and errors, %ld MiB at most\n", runs, answers, usage.ru_maxrss / 1024);
  return 0;
}
