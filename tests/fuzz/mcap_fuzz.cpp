// Octets of a recording: whatever comes is read to its end or refused with a line; memory stays bounded. Mutates good files, half of them
// without the sums that would tell a mutated one at once; prints its seed. mcap_fuzz [--runs N] [--seed N]. Built with -DRTMSIM_LIBFUZZER
// (clang) it is a target of libFuzzer over the same check.
#include <sys/resource.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "recording/mcap/mcap.h"
#include "support/usage.h"

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

// Sums of zero are none: chunks and the summary are believed then.
std::string without_sums(std::string octets) {
  constexpr std::size_t magic = 8, head = 9, sum_of_chunk = 24, end = 12;
  for (std::size_t at = magic; at + head < octets.size();) {
    std::uint64_t length = 0;
    std::memcpy(&length, octets.data() + at + 1, sizeof length);
    constexpr char chunk = 6;
    if (octets[at] == chunk) std::memset(octets.data() + at + head + sum_of_chunk, 0, 4);
    at += head + length;
  }
  std::memset(octets.data() + octets.size() - end, 0, 4);
  return octets;
}

#ifndef RTMSIM_LIBFUZZER
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

#endif

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

std::vector<std::string> good_files(const std::string& path) {
  std::vector<std::string> files = {make_recording(path, mcap::Compression::zstd, 200), make_recording(path, mcap::Compression::lz4, 400),
                                    make_recording(path, mcap::Compression::none, 100),
                                    make_recording(path, mcap::Compression::none, 1 << 20)};
  for (std::size_t i = 0, count = files.size(); i < count; ++i) files.push_back(without_sums(files[i]));
  return files;
}

std::size_t check(const std::string& path, std::string_view octets, bool is_repaired) {
  std::ofstream(path, std::ios::binary | std::ios::trunc) << octets;
  const auto answers = read_all(path);
  if (is_repaired) (void)mcap::repair(path, path + ".again");
  return answers;
}

}  // namespace

#ifdef RTMSIM_LIBFUZZER
extern "C" int LLVMFuzzerTestOneInput(const char* data, std::size_t size) {
  static const std::string path = (fs::temp_directory_path() / ("mcap_fuzz_" + std::to_string(getpid()) + ".mcap")).string();
  (void)check(path, {data, size}, size % 8 == 0);
  return 0;
}

// What it begins with when its folder is empty.
extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  const fs::path folder = *argc > 1 ? (*argv)[*argc - 1] : "";
  if (!fs::is_directory(folder) || !fs::is_empty(folder)) return 0;
  int number = 0;
  for (const auto& octets : good_files((folder / "good").string()))
    std::ofstream(folder / std::to_string(++number), std::ios::binary) << octets;
  fs::remove(folder / "good");
  return 0;
}
#else
int main(int argc, char** argv) {
  ::test::answer_help(argc, argv, "mcap_fuzz [--runs N] [--seed N]\nReads damaged recordings; it must not crash or hang.");
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
  const auto seeds = good_files(path);
  std::mt19937 random(static_cast<std::mt19937::result_type>(seed));
  std::size_t answers = 0;
  for (unsigned long run = 0; run < runs; ++run) {
    std::string octets = seeds[random() % seeds.size()];
    mutate(octets, random);
    answers += check(path, octets, run % 8 == 0);
  }
  fs::remove_all(folder);
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  std::printf("%lu files, %zu messages and errors, %ld MiB at most\n", runs, answers, usage.ru_maxrss / 1024);
  return 0;
}
#endif
