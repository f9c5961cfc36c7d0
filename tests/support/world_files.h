// Worlds as texts and files of a test: a folder that goes with the object, and the loader in one call.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include "world/world_loader.h"

namespace sim {

class WorldFiles {
 public:
  WorldFiles() {
    std::string pattern = (std::filesystem::temp_directory_path() / "rtmsim-world-XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
  }
  ~WorldFiles() { std::filesystem::remove_all(folder_); }
  WorldFiles(const WorldFiles&) = delete;
  WorldFiles& operator=(const WorldFiles&) = delete;

  const std::filesystem::path& folder() const { return folder_; }
  std::string write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return (folder_ / name).string();
  }
  // A model folder of the current version.
  void write_model(const std::string& name, const std::string& content) const {
    write(name + "/model.config", "<model><name>" + name + "</name><sdf version='1.9'>model.sdf</sdf></model>");
    write(name + "/model.sdf", "<sdf version='1.9'>" + content + "</sdf>");
  }
  base::Result<LoadResult> load_text(const std::string& text) const { return load_world_text(text, folder_, "w.sdf", ModelPath{}); }
  // The content of a <world>; it must load.
  LoadResult load(const std::string& content, const std::string& version = "1.9") const {
    base::Result<LoadResult> result = load_text("<sdf version='" + version + "'>\n<world name='w'>\n" + content + "\n</world></sdf>");
    if (result) return std::move(*result);
    ADD_FAILURE() << result.error().message;
    return {};
  }

 private:
  std::filesystem::path folder_;
};

// A model with one link that holds `content`.
inline std::string model_of(const std::string& content, const std::string& name = "m") {
  return "<model name='" + name + "'><link name='l'>" + content + "</link></model>";
}

inline std::string all_findings(const LoadResult& result) {
  std::string text;
  for (const Finding& finding : result.findings) text += finding.text() + "\n";
  return text;
}

inline int findings_with(const LoadResult& result, const std::string& words) {
  return static_cast<int>(std::count_if(result.findings.begin(), result.findings.end(),
                                        [&](const Finding& finding) { return finding.text().find(words) != std::string::npos; }));
}

}  // namespace sim
