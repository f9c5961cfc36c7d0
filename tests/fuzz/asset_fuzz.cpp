// Has mutations of meshes and pictures read as a simulator reads them (by rtm-asset-reader, checked), and gives what comes of them to ODE,
// Embree and the bending of skins: none may end, hang or corrupt this process. The reader may die, which is counted.
//   asset_fuzz [--seed N] [--runs N] [--limit MS] FILE...
// N mutations of each file, each given up after MS milliseconds (2000). A crash leaves the last one in asset_fuzz_last.EXTENSION.
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "base/text.h"
#include "physics/physics.h"
#include "rays/ray_scene.h"
#include "reader/asset_reader.h"
#include "render/assets.h"

namespace {

namespace fs = std::filesystem;
using Below = std::function<std::size_t(std::size_t)>;

void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "asset_fuzz: %s\n", what);
  std::abort();
}

struct Count {
  long files = 0, results = 0, errors = 0;
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

void run(const std::string& file, std::chrono::milliseconds limit, Count& count) {
  const sim::ReadDeadline deadline(std::chrono::steady_clock::now() + limit);
  ++count.files;
  const std::string extension = fs::path(file).extension().string();
  const auto is_one_line = [](const base::Error& error) {
    return !error.message.empty() && error.message.find('\n') == std::string::npos && error.message.size() < 6000;
  };
  bool has_result = false;
  const auto look = [&](const auto& result) {
    if (!result.ok()) require(is_one_line(result.error()), "an error is not one line");
    has_result = has_result || result.ok();
    return result.ok();
  };
  if (extension == ".png" || extension == ".jpg" || extension == ".dds") {
    const auto image = sim::read_image(file);
    if (look(image)) require(image.value().rgba.size() == image.value().size_bytes(), "a picture has not its size");
    look(sim::TriangleCache().heights({file, {1, 1, 1}, {0, 0, 0}, 1, {}, {}}));
  } else {
    const sim::MeshShape shape{file, "", false, {1, 1, 1}};
    sim::TriangleCache cache;
    if (const auto triangles = cache.triangles(shape); look(triangles)) fall_on(shape, **triangles);
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
}

const std::vector<std::string> words{"nan",
                                     "inf",
                                     "-1",
                                     "0",
                                     "1e38",
                                     "1e-38",
                                     "4294967295",
                                     "2147483647",
                                     "-2147483648",
                                     "65536",
                                     "99999999",
                                     "<",
                                     "/>",
                                     "\"",
                                     "{",
                                     "}",
                                     "[",
                                     "]",
                                     "\n",
                                     " ",
                                     "#",
                                     "//",
                                     "\xff",
                                     "property list uchar int x",
                                     "element face 1000000",
                                     "<p>x</p>",
                                     "url=\"#n\"",
                                     "count=\"7\"",
                                     "1 2 3"};

std::string mutate(std::string text, const std::string& other, const Below& below) {
  const bool is_gentle = below(2) == 0;  // numbers alone, so that more than the first line of the file is read
  for (std::size_t changes = 1 + below(below(3) == 0 ? 5 : 2); changes > 0 && !text.empty(); --changes) {
    const std::size_t at = below(text.size());
    const std::size_t length = std::min(text.size() - at, below(below(4) == 0 ? 200 : 12) + 1);
    switch (is_gentle ? 6 + below(2) : below(9)) {
      case 0:
        text[at] = static_cast<char>(below(256));
        break;
      case 1:
        text.erase(at, length);
        break;
      case 2:
        text.insert(at, words[below(words.size())]);
        break;
      case 3:
        text.replace(at, length, words[below(words.size())]);
        break;
      case 4:
        text.insert(below(text.size()), text.substr(at, length));
        break;
      case 5:
        text.resize(at);
        break;
      case 6: {  // another number
        const std::size_t digit = text.find_first_of("0123456789", at);
        if (digit != std::string::npos) text.replace(digit, text.find_first_not_of("0123456789.e-", digit) - digit, words[below(11)]);
        break;
      }
      case 7: {  // four bytes, as binary formats count with
        const std::uint32_t values[] = {0, 1, 0xff, 0xffff, 0x7fffffff, 0x80000000, 0xffffffff, 0x10000, 0x7f800000, 0x7fc00000};
        const std::uint32_t value = values[below(std::size(values))];
        for (std::size_t i = 0; i < 4 && at + i < text.size(); ++i) text[at + i] = static_cast<char>(value >> (8 * i));
        break;
      }
      default:
        if (!other.empty()) text.insert(at, other.substr(below(other.size()), length));
    }
  }
  return text;
}

}  // namespace

int main(int argc, char** argv) {
  unsigned seed = 1;
  long runs = 50;
  std::chrono::milliseconds limit{2000};
  std::vector<fs::path> files;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--seed" && i + 1 < argc) {
      seed = static_cast<unsigned>(base::parse_integer(argv[++i]).value_or(1));
    } else if (word == "--runs" && i + 1 < argc) {
      runs = static_cast<long>(base::parse_integer(argv[++i]).value_or(50));
    } else if (word == "--limit" && i + 1 < argc) {
      limit = std::chrono::milliseconds(base::parse_integer(argv[++i]).value_or(2000));
    } else if (fs::is_directory(word)) {
      for (const auto& entry : fs::directory_iterator(word)) files.push_back(entry.path());
    } else {
      files.emplace_back(word);
    }
  }
  std::erase_if(files, [](const fs::path& file) { return file.extension() == ".mtl" || file.extension() == ".py"; });
  std::sort(files.begin(), files.end());
  if (files.empty()) return std::fprintf(stderr, "usage: asset_fuzz [--seed N] [--runs N] [--limit MS] FILE...\n"), 2;
  std::vector<std::string> contents;
  for (const fs::path& file : files) {
    std::ifstream stream(file, std::ios::binary);
    contents.emplace_back(std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>());
  }
  std::map<std::string, Count> counts;
  const auto started = [] { return sim::AssetReader::mine().started(); };
  for (std::size_t which = 0; which < files.size(); ++which) {
    const std::string extension = files[which].extension().string();
    std::mt19937 random(seed + static_cast<unsigned>(which));
    const Below below = [&](std::size_t n) {
      return n == 0 ? std::size_t{0} : std::uniform_int_distribution<std::size_t>(0, n - 1)(random);
    };
    const std::size_t before = started();
    Count count;
    run(files[which].string(), limit, count);
    const std::string last = "asset_fuzz_last" + extension;
    for (long i = 0; i < runs; ++i) {
      fs::remove(last);
      std::ofstream(last, std::ios::binary) << mutate(contents[which], contents[below(contents.size())], below);
      run(fs::absolute(last).string(), limit, count);
    }
    fs::remove(last);
    std::printf("%-16s seed %u: %ld files, %ld with a result, %ld with an error, %zu readers ended\n", files[which].filename().c_str(),
                seed, count.files, count.results, count.errors, started() - before - (before == 0 ? 1 : 0));
    std::fflush(stdout);
  }
  return 0;
}
