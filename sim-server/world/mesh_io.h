// What Assimp may open: ordinary files. A mesh can name others (material libraries, buffers), and a pipe or a device among them would be
// read for ever. One thread at a time.
#pragma once

#include <assimp/DefaultIOSystem.h>

#include <filesystem>
#include <string>

namespace sim {

class MeshIo : public Assimp::DefaultIOSystem {
 public:
  bool Exists(const char* file) const override {
    std::error_code problem;
    return std::filesystem::is_regular_file(file, problem);
  }
  // Null: it is none; the importer that asked says what it misses.
  Assimp::IOStream* Open(const char* file, const char* mode) override {
    return Exists(file) ? Assimp::DefaultIOSystem::Open(file, mode) : nullptr;
  }
};

}  // namespace sim
