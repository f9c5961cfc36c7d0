// A file in Assimp: only the importers of the formats that worlds use, each for its own extension, and only regular files. One thread at a
// time.
#pragma once

#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#include <assimp/LogStream.hpp>
#include <string>

#include "asset-reader/jobs.h"
#include "base/result.h"

namespace sim {

class Import {
 public:
  Import(std::string path, FileLog& files);
  ~Import();
  Import(const Import&) = delete;
  Import& operator=(const Import&) = delete;

  // For its properties.
  Assimp::Importer& importer() { return importer_; }
  // With a root, its indexes checked (scene_check.h). Lives as long as this object. `flags`: of aiPostProcessSteps.
  base::Result<const aiScene*> read(unsigned flags);

 private:
  std::string path_;
  FileLog& files_;
  bool is_known_ = false;
  Assimp::Importer importer_;
  // An importer that leaves out a face with a wrong index says so in its log alone.
  class Losses final : public Assimp::LogStream {
   public:
    void write(const char* message) override;
    bool has_lost_faces = false;
  };
  Losses losses_;
};

}  // namespace sim
