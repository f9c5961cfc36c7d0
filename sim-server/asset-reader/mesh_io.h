// File access of Assimp: regular files only, read whole. A mesh can name others (material libraries, buffers), and a pipe or a device among
// them would be read endlessly. One thread at a time.
#pragma once

#include <assimp/DefaultIOSystem.h>

#include <string>
#include <string_view>

#include "asset-reader/jobs.h"

namespace sim {

// What a COLLADA image without a file is said to be: Assimp rejects the whole mesh otherwise.
inline constexpr std::string_view no_image = "no_image";
std::string with_named_images(const std::string& collada);

// What to say of an importer that gave nothing: Assimp passes on the name of the exception when memory runs out.
std::string import_fault(std::string_view said);

class MeshIo : public Assimp::DefaultIOSystem {
 public:
  explicit MeshIo(FileLog& files) : files_(files) {}
  bool Exists(const char* file) const override;
  // Null: it is none; the importer that asked says what it misses.
  Assimp::IOStream* Open(const char* file, const char* mode) override;

 private:
  FileLog& files_;
};

}  // namespace sim
