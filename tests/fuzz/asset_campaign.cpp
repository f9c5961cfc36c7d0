// Reads many mutations of mesh files by the code of rtm-asset-reader, inside this process, for campaigns with the address sanitizer: a file
// costs no process. What is read crosses the reader's socket and is checked and used as in the simulator, without ODE, Embree and GL.
//   asset_campaign [--seed N] [--runs N] [--keep FOLDER] FILE...
// N mutations of each file, in a child process until one ends it (worker.h). Such ends are counted by their place; those in a library that
// parses files are contained by the reader's process and count no more. Any other one is printed with its report and fails the campaign.
// --keep keeps the files that ended the child. Counts so far are printed every 5000 files.
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "asset-reader/serve.h"
#include "base/text.h"
#include "fuzz/asset_mutations.h"
#include "fuzz/worker.h"
#include "reader/asset_reader.h"
#include "render/mesh_arrays.h"
#include "support/usage.h"
#include "world/triangle_arrays.h"

extern "C" const char* __asan_default_options();
extern "C" const char* __asan_default_options() {
  return "detect_leaks=0:allocator_may_return_null=1:max_allocation_size_mb=2048:quarantine_size_mb=16:symbolize=0:handle_abort=1";
}
extern "C" const char* __ubsan_default_options();
extern "C" const char* __ubsan_default_options() { return "halt_on_error=1:print_stacktrace=1"; }

namespace {

namespace fs = std::filesystem;

constexpr std::size_t reader_memory = 64 << 20U;  // [byte]
constexpr std::chrono::seconds file_limit(20);    // of real time, which a busy machine takes from everybody

struct Options {
  unsigned seed = 1;
  long runs = 1000;
  fs::path keep;
};

// The reader is a thread of this process. One that is late is killed, and this process with it.
void read_inside() {
  ::dup2(STDERR_FILENO, sim::reader_socket);  // its number is taken before the first socket
  sim::AssetReader::mine().start_by([](int socket) -> base::Result<pid_t> {
    ::dup2(socket, sim::reader_socket);
    std::thread([] { sim::serve_assets(); }).detach();
    return ::getpid();
  });
}

// What comes of one question, checked as the simulator checks it; empty: an error.
template <class T, class Take>
std::optional<T> ask(sim::AssetKind kind, const std::string& file, const std::string& details, const Take& take) {
  const sim::AssetReader::Question question{kind, file, "mesh", details};
  auto decoded = sim::AssetReader::decoded<T>(question, sim::AssetReader::mine().ask(question), take);
  return decoded ? std::optional<T>(std::move(*decoded)) : std::nullopt;
}

// Whether anything could be read from the file.
bool use(const std::string& file) {
  const sim::ReadDeadline deadline(std::chrono::steady_clock::now() + file_limit);
  sim::ArrayWriter shape, scale;
  put(shape, sim::MeshShape{file, "", false, {1, 1, 1}});
  scale.number(1.0);
  bool has_result = ask<sim::TriangleMesh>(sim::AssetKind::triangles, file, shape.bytes(), sim::take_triangles).has_value();
  const auto take_mesh = [](sim::ArrayReader& in, sim::MeshFile& mesh) { return take(in, mesh, nullptr); };
  has_result = ask<sim::MeshFile>(sim::AssetKind::mesh, file, shape.bytes(), take_mesh).has_value() || has_result;
  const std::string extension = fs::path(file).extension().string();
  if (extension == ".stl" || extension == ".obj" || extension == ".ply" || extension == ".gltf") return has_result;
  sim::Skin skin;
  const auto take_skin = [&](sim::ArrayReader& in, sim::MeshFile& mesh) { return take(in, mesh, &skin); };
  if (ask<sim::MeshFile>(sim::AssetKind::skin, file, scale.bytes(), take_skin)) {
    has_result = true;
    std::vector<sim::Vertex> vertices = skin.vertices;
    sim::bend(skin, sim::bone_poses(skin, nullptr, 0.3, false), vertices);
  }
  return ask<std::vector<sim::RawTrack>>(sim::AssetKind::animation, file, "", sim::take_tracks).has_value() || has_result;
}

// Whether all ends were in libraries that parse files.
bool run_seed(const std::vector<fuzz::Seed>& seeds, std::size_t which, const Options& options) {
  const fs::path& seed = seeds[which].file;
  const std::string name = seed.filename().string() + " seed " + std::to_string(options.seed);
  const std::string last = fs::absolute("asset_campaign_last" + seed.extension().string()).string();
  long deaths = 0, late = 0, own = 0;
  std::map<std::string, long> ends;
  const auto job = [&](long i) {
    fs::remove(last);
    std::ofstream(last, std::ios::binary) << fuzz::mutation(seeds, which, options.seed, i);
    return use(last);
  };
  const auto ended = [&](long i, const fuzz::Ending& ending) {
    ++(ending.is_late ? late : deaths);
    ++ends[ending.how];
    std::error_code is_gone;  // a child can also end between two files
    if (!options.keep.empty())
      fs::copy_file(
          last,
          options.keep / (seed.stem().string() + "_" + std::to_string(options.seed) + "_" + std::to_string(i) + seed.extension().string()),
          fs::copy_options::overwrite_existing, is_gone);
    if (!ending.is_own_code) return;
    ++own;
    std::fprintf(stderr, "%s, mutation %ld: %s\n%s\n", name.c_str(), i, ending.how.c_str(), ending.report.c_str());
  };
  const auto show = [&](const fuzz::Progress& progress) {
    std::printf("%s: %ld of %ld files, %ld with a result; %ld ended the reader, %ld were late, %ld outside of the parsers\n", name.c_str(),
                progress.done, options.runs, progress.good, deaths, late, own);
    std::fflush(stdout);
  };
  fuzz::run_in_children({options.runs, reader_memory, read_inside, job, ended, show});
  fs::remove(last);
  for (const auto& [how, count] : ends) std::printf("  %ld: %s\n", count, how.c_str());
  return own == 0;
}

}  // namespace

int main(int argc, char** argv) {
  ::test::answer_help(argc, argv,
                      "asset_campaign [--seed N] [--runs N] [--keep FOLDER] FILE...\nReads damaged mesh files inside one process; for the "
                      "address sanitizer.");
  Options options;
  std::vector<fs::path> files;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--seed" && i + 1 < argc) {
      options.seed = static_cast<unsigned>(base::parse_integer(argv[++i]).value_or(1));
    } else if (word == "--runs" && i + 1 < argc) {
      options.runs = base::parse_integer(argv[++i]).value_or(options.runs);
    } else if (word == "--keep" && i + 1 < argc) {
      options.keep = argv[++i];
    } else {
      files.emplace_back(word);
    }
  }
  const auto seeds = fuzz::seeds_of(std::move(files));
  if (seeds.empty()) {
    std::fprintf(stderr, "usage: asset_campaign [--seed N] [--runs N] [--keep FOLDER] FILE...\n");
    return 2;
  }
  if (!options.keep.empty()) fs::create_directories(options.keep);
  bool is_good = true;
  for (std::size_t which = 0; which < seeds.size(); ++which) is_good = run_seed(seeds, which, options) && is_good;
  return is_good ? 0 : 1;
}
