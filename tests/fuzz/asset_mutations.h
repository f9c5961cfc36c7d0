// Damaged files of meshes and images, made from whole ones. Any thread.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace fuzz {

struct Seed {
  std::filesystem::path file;
  std::string content;
};

// The files in the order of their names, without those of materials and scripts.
std::vector<Seed> seeds_of(std::vector<std::filesystem::path> files);

// The same for the same numbers: bytes and numbers of seeds[which] changed, cut, or taken from another seed.
std::string mutation(const std::vector<Seed>& seeds, std::size_t which, unsigned seed, long number);

}  // namespace fuzz
