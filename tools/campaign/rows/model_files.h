// The models that a world file includes: their files and contents. Changed copies can replace them. Contents are cached; one thread at a
// time.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <pugixml.hpp>
#include <set>
#include <string>
#include <vector>

namespace campaign {

class ModelFiles {
 public:
  ModelFiles() = default;
  ModelFiles(const std::filesystem::path& world_folder, const std::vector<std::string>& resource_paths);

  struct Opened {
    pugi::xml_node model;
    std::filesystem::path file;
  };
  // What an <include> in a file of folder `at` means.
  std::optional<Opened> open(pugi::xml_node include, const std::filesystem::path& at) const { return open(include, at, "model"); }
  // The same of a light, which a file can hold in place of a model.
  std::optional<Opened> open_light(pugi::xml_node include, const std::filesystem::path& at) const { return open(include, at, "light"); }
  // A copy of what the include means, under a name of its own, made at the first call.
  std::optional<Opened> copy(pugi::xml_node include, const std::filesystem::path& at, const std::string& name);
  void drop_copy(const std::string& name) { copies_.erase(name); }
  struct Copy {
    pugi::xml_document document;
    std::filesystem::path file;  // of the original
  };
  const std::map<std::string, std::unique_ptr<Copy>>& copies() const { return copies_; }

  // The name that an included model gets in the world.
  std::string name_of(pugi::xml_node include, const std::filesystem::path& at) const;
  // The models in a <model> or <include>, itself first, with the folder of the file that each stands in.
  void walk(pugi::xml_node node, const std::filesystem::path& at,
            const std::function<void(pugi::xml_node model, const std::filesystem::path& folder)>& visit) const;
  // Adds the files of what a path or an URI means, a folder or a file. False: there is none.
  bool add_model(const std::string& uri, std::set<std::string>& files) const;
  // The files that a <model> or <include> is made of, with its meshes and textures.
  void add_files(pugi::xml_node node, const std::filesystem::path& at, std::set<std::string>& files) const;

 private:
  std::optional<Opened> open(pugi::xml_node include, const std::filesystem::path& at, const char* kind) const;
  std::optional<std::filesystem::path> find(const std::string& uri, const std::filesystem::path& at) const;

  std::vector<std::filesystem::path> folders_;
  std::map<std::string, std::unique_ptr<Copy>> copies_;
  mutable std::map<std::filesystem::path, std::unique_ptr<pugi::xml_document>> read_;
};

// The numbers of a text, as far as they are some.
std::vector<double> numbers_in(const std::string& text);

}  // namespace campaign
