// The contents of the models that a world file includes, by the files that the simulator found. Changed copies can replace them. Contents
// are cached; one thread at a time.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <pugixml.hpp>
#include <string>
#include <vector>

#include "campaign/rows/world_survey.h"

namespace campaign {

class ModelFiles {
 public:
  // `found` must live as long.
  explicit ModelFiles(const FoundFiles& found) : found_(found) {}

  // The file that a URI in a file of folder `at` means; one that was not found stays as it is.
  std::string absolute(const std::string& uri, const std::filesystem::path& at) const;

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

 private:
  std::optional<Opened> open(pugi::xml_node include, const std::filesystem::path& at, const char* kind) const;

  const FoundFiles& found_;
  std::map<std::string, std::unique_ptr<Copy>> copies_;
  mutable std::map<std::filesystem::path, std::unique_ptr<pugi::xml_document>> read_;
};

// The numbers of a text, as far as they are some.
std::vector<double> numbers_in(const std::string& text);

}  // namespace campaign
