// Model files: each is read, corrected and checked once per world, with all its includes in place. One thread at a time.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <pugixml.hpp>
#include <set>
#include <string>

#include "base/result.h"
#include "world/complaints.h"
#include "world/found_files.h"
#include "world/model_path.h"
#include "world/sdf_library.h"

namespace sim {

// Of a node and all in it. Models, nested ones too, count for 50: their frames cost more than anything else.
std::size_t element_count(pugi::xml_node node);

class ModelFiles {
 public:
  // All three outlive the object.
  ModelFiles(const ModelPath& model_path, SdfLibrary& library, Complaints& complaints);

  // A document in the current version: parsed, repaired, translated; not yet checked. Fails for what is no SDFormat (or URDF) at all.
  base::Result<pugi::xml_document> open_text(const std::string& text, const std::string& file_name);

  // Checks an entity of a document, makes its file names absolute and puts the models that it includes inside models in their places.
  // Includes that stand directly in a <world> are left alone. False when the entity is not fit to be used (a finding says why).
  bool complete(pugi::xml_node entity, const std::filesystem::path& folder);

  // The <model>, <actor> or <light> that an <include> names, complete, of the file's own name and pose. Empty, with a finding made, when
  // there is none. The node lives as long as this object and must not be changed.
  pugi::xml_node included(pugi::xml_node include, const std::filesystem::path& folder);

  // The entity in a file or in a folder with a model.config.
  base::Result<pugi::xml_node> entity(const std::filesystem::path& path);

  // Puts name, pose, placement frame, static flag and plugins of the <include> on a copy of the entity.
  static void apply_include(pugi::xml_node include, pugi::xml_node copy);

  const ModelPath& model_path() const { return model_path_; }
  // So far: models, meshes and textures.
  const FoundFiles& found() const { return found_files_; }

 private:
  base::Result<pugi::xml_node> load(const std::filesystem::path& file);
  base::Result<std::filesystem::path> file_in_folder(const std::filesystem::path& folder);
  void resolve_uris(pugi::xml_node entity, const std::filesystem::path& folder);
  void expand_includes(pugi::xml_node model, const std::filesystem::path& folder);

  const ModelPath& model_path_;
  SdfLibrary& library_;
  Complaints& complaints_;
  std::map<std::string, pugi::xml_document> documents_;
  std::map<std::string, std::string> failures_;
  std::map<std::string, std::optional<std::filesystem::path>> found_;  // by URI and folder
  std::set<std::string> being_loaded_;
  FoundFiles found_files_;
};

}  // namespace sim
