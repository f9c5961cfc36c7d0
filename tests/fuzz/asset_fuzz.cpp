// Has mutations of meshes and pictures read as a simulator reads them (by rtm-asset-reader, checked), and gives what comes of them to ODE,
// Embree and the bending of skins: none may end, hang or corrupt this process. The reader may die, which is counted.
//   asset_fuzz [--fork] [--seed N] [--runs N] [--limit MS] [--bodies N] [--keep FOLDER] FILE...
// N mutations of each file, each given up after MS milliseconds (2000); bodies fall on every Nth mesh (1). A crash leaves the last one in
// asset_fuzz_last.EXTENSION; --keep keeps those that ended the reader or were not read in time. One reader reads until a file ends it.
// Prints counts by file and by format, and of each way in which readers ended. --fork, for campaigns: readers are forked (fork_server.h)
// and have 64 MiB; sanitizer reports of readers go to stderr.
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/text.h"
#include "fuzz/asset_mutations.h"
#include "fuzz/fork_server.h"
#include "physics/physics.h"
#include "rays/ray_scene.h"
#include "reader/asset_reader.h"
#include "render/assets.h"
#include "support/usage.h"

// Readers end in thousands: a report names addresses, which addr2line translates where somebody asks.
extern "C" const char* __asan_default_options();
extern "C" const char* __asan_default_options() {
  return "detect_leaks=0:allocator_may_return_null=1:max_allocation_size_mb=2048:quarantine_size_mb=16:symbolize=0";
}
extern "C" const char* __ubsan_default_options();
extern "C" const char* __ubsan_default_options() { return "halt_on_error=1:print_stacktrace=1"; }

namespace {

namespace fs = std::filesystem;

void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "asset_fuzz: %s\n", what);
  std::abort();
}

constexpr std::size_t reader_memory = 64 << 20U;  // [byte] with --fork

struct Count {
  long files = 0, results = 0, errors = 0, deaths = 0, late = 0;
  std::map<std::string, long> ends;  // of readers, by how they ended
  void add(const Count& other) {
    files += other.files, results += other.results, errors += other.errors, deaths += other.deaths, late += other.late;
    for (const auto& [how, count] : other.ends) ends[how] += count;
  }
  void print(const std::string& name) const {
    std::printf("%-28s %ld files: %ld with a result, %ld with an error; %ld ended the reader, %ld were not read in time\n", name.c_str(),
                files, results, errors, deaths, late);
    for (const auto& [how, count] : ends) std::printf("  %ld: %s\n", count, how.c_str());
    std::fflush(stdout);
  }
};

struct Options {
  unsigned seed = 1;
  long runs = 50;
  std::chrono::milliseconds limit{2000};
  long bodies = 1;
  bool has_fork_server = false;
  fs::path keep;
};

// A ball, a box, a cylinder and a capsule on the mesh, and another one of it in the air.
void fall_on(const sim::MeshShape& shape, const sim::TriangleMesh& triangles) {
  if (triangles.triangles.size() > 20000) return;
  Eigen::AlignedBox3d box;
  for (const auto& vertex : triangles.vertices) box.extend(vertex);
  sim::WorldDef world;
  const auto add = [&](const std::string& name, sim::GeometryDef geometry, const Eigen::Vector3d& at, bool is_static) {
    sim::ModelDef model;
    model.name = name;
    model.is_static = is_static;
    model.canonical_link = "l";
    model.pose.translation() = at;
    sim::LinkDef link;
    link.name = "l";
    sim::CollisionDef collision;
    collision.name = "c";
    collision.geometry = std::move(geometry);
    link.collisions.push_back(std::move(collision));
    model.links.push_back(std::move(link));
    world.models.push_back(std::move(model));
  };
  const Eigen::Vector3d middle = box.center();
  add("mesh", shape, Eigen::Vector3d::Zero(), true);
  add("ball", sim::SphereShape{0.3}, middle, false);
  add("box", sim::BoxShape{{0.5, 0.5, 0.5}}, middle + Eigen::Vector3d(0.1, 0, 0.1), false);
  add("rod", sim::CylinderShape{0.2, 0.6}, middle + Eigen::Vector3d(-0.1, 0.1, 0), false);
  add("pill", sim::CapsuleShape{0.2, 0.3}, middle + Eigen::Vector3d(0, -0.2, 0), false);
  add("other", shape, Eigen::Vector3d(0.2, 0.1, 0.3), false);
  world.physics.gravity = {0, 0, -9.8};
  sim::WorkerPool pool(1);
  sim::TriangleCache cache;
  std::vector<std::string> notes, dropped;
  sim::Physics physics(std::make_shared<const sim::WorldDef>(std::move(world)), pool, cache, notes, dropped);
  sim::RayScene rays(cache);
  const sim::GeometryDef geometry = shape;
  sim::RayShape seen{};
  seen.geometry = &geometry;
  rays.add_static({&seen, 1}, Eigen::Isometry3d::Identity(), notes);
  rays.commit();
  require(!std::isnan(rays.trace_one(middle + Eigen::Vector3d(0, 0, 10), {0, 0, -1}, 0, 100).range), "a range is no number");
  for (int i = 0; i < 4; ++i) physics.step();
  for (sim::ModelId id = 0; id < physics.model_slots(); ++id)
    require(!physics.exists(id) || physics.model_pose(id).matrix().allFinite(), "a pose is not finite");
}

// True: it has ended the reader, or was not read in time.
bool run(const std::string& file, const Options& options, Count& count) {
  const sim::ReadDeadline deadline(std::chrono::steady_clock::now() + options.limit);
  ++count.files;
  const std::string extension = fs::path(file).extension().string();
  const auto is_one_line = [](const base::Error& error) {
    return !error.message.empty() && error.message.find('\n') == std::string::npos && error.message.size() < 6000;
  };
  bool has_result = false, is_deadly = false, is_late = false;
  const auto look = [&](const auto& result) {
    if (!result.ok()) {
      const std::string& why = result.error().message;
      require(is_one_line(result.error()), "an error is not one line");
      if (!is_deadly && (why.find("its reader") != std::string::npos || why.find("of processor time") != std::string::npos)) {
        is_deadly = true;
        ++count.ends[why.substr(std::min(why.size(), why.find(file) + file.size() + 2))];
      }
      is_late = is_late || why.find("in time") != std::string::npos;
    }
    has_result = has_result || result.ok();
    return result.ok();
  };
  if (extension == ".png" || extension == ".jpg" || extension == ".dds" || extension == ".pgm" || extension == ".tif") {
    const auto image = sim::read_image(file);
    if (look(image)) require(image.value().rgba.size() == image.value().size_bytes(), "a picture has not its size");
    look(sim::TriangleCache().heights({file, {1, 1, 1}, {0, 0, 0}, 1, {}, {}}));
  } else {
    const sim::MeshShape shape{file, "", false, {1, 1, 1}};
    sim::TriangleCache cache;
    if (const auto triangles = cache.triangles(shape); look(triangles) && count.files % options.bodies == 0) fall_on(shape, **triangles);
    if (const auto mesh = sim::read_mesh_file(shape); look(mesh)) {
      for (const auto index : mesh.value().mesh.indices) require(index < mesh.value().mesh.vertices.size(), "an index is out of range");
      for (const auto& image : mesh.value().images) look(sim::decode_image(image.bytes, image.name));
    }
    if (extension == ".dae" || extension == ".glb" || extension == ".bvh" || extension == ".fbx") {
      if (const auto skin = sim::read_skin_file(file, 1); look(skin)) {
        const auto animation = sim::read_skin_animation(file, 1, skin.value().skin);
        const auto poses = sim::bone_poses(skin.value().skin, animation.ok() ? &animation.value() : nullptr, 0.3, false);
        std::vector<sim::Vertex> vertices = skin.value().skin.vertices;
        sim::bend(skin.value().skin, poses, vertices);
      }
    }
  }
  ++(has_result ? count.results : count.errors);
  count.deaths += is_deadly ? 1 : 0;
  count.late += is_late ? 1 : 0;
  return is_deadly || is_late;
}

Count run_seed(const std::vector<fuzz::Seed>& seeds, std::size_t which, const Options& options) {
  const std::string extension = seeds[which].file.extension().string();
  Count count;
  run(seeds[which].file.string(), options, count);
  const std::string last = "asset_fuzz_last" + extension;
  for (long i = 0; i < options.runs; ++i) {
    fs::remove(last);
    std::ofstream(last, std::ios::binary) << fuzz::mutation(seeds, which, options.seed, i);
    const bool is_kept = run(fs::absolute(last).string(), options, count);
    if (!is_kept || options.keep.empty()) continue;
    const std::string name = seeds[which].file.stem().string() + "_" + std::to_string(options.seed) + "_" + std::to_string(i) + extension;
    fs::copy_file(last, options.keep / name, fs::copy_options::overwrite_existing);
  }
  fs::remove(last);
  return count;
}

}  // namespace

int main(int argc, char** argv) {
  ::test::answer_help(
      argc, argv, "asset_fuzz [--fork] [--runs N] [--seed N] [FILE]...\nReads damaged mesh and image files; it must not crash or hang.");
  Options options;
  std::vector<fs::path> files;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const auto number = [&](long otherwise) { return static_cast<long>(base::parse_integer(argv[++i]).value_or(otherwise)); };
    if (word == "--fork") {
      options.has_fork_server = true;
    } else if (word == "--seed" && i + 1 < argc) {
      options.seed = static_cast<unsigned>(number(1));
    } else if (word == "--runs" && i + 1 < argc) {
      options.runs = number(50);
    } else if (word == "--limit" && i + 1 < argc) {
      options.limit = std::chrono::milliseconds(number(2000));
    } else if (word == "--bodies" && i + 1 < argc) {
      options.bodies = std::max(1L, number(1));
    } else if (word == "--keep" && i + 1 < argc) {
      options.keep = argv[++i];
    } else if (fs::is_directory(word)) {
      for (const auto& entry : fs::directory_iterator(word)) files.push_back(entry.path());
    } else {
      files.emplace_back(word);
    }
  }
  const auto seeds = fuzz::seeds_of(std::move(files));
  if (seeds.empty()) {
    std::fprintf(stderr, "usage: asset_fuzz [--fork] [--seed N] [--runs N] [--limit MS] [--bodies N] [--keep FOLDER] FILE...\n");
    return 2;
  }
  std::optional<fuzz::ForkServer> forks;
  if (options.has_fork_server) {
    forks.emplace(reader_memory);
    sim::AssetReader::mine().start_by([&forks](int socket) { return forks->start(socket); });
  }
  std::map<std::string, Count> formats;
  for (std::size_t which = 0; which < seeds.size(); ++which) {
    const Count count = run_seed(seeds, which, options);
    count.print(seeds[which].file.filename().string() + " seed " + std::to_string(options.seed));
    formats[seeds[which].file.extension().string()].add(count);
  }
  for (const auto& [extension, count] : formats) count.print("all " + extension);
  return 0;
}
