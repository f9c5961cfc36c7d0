// Search path of models and of the files that they refer to. A value; any thread.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sim {

class ModelPath {
 public:
  ModelPath() = default;
  explicit ModelPath(std::vector<std::filesystem::path> folders);

  // The folders given on the command line first, then RTMSIM_RESOURCE_PATH, GZ_SIM_RESOURCE_PATH, IGN_GAZEBO_RESOURCE_PATH and
  // GAZEBO_MODEL_PATH (lists separated by ":"), then `installed` (the folder of our own worlds, with models/ in it; may be empty). What
  // Gazebo has fetched from Fuel is looked for last: GZ_FUEL_CACHE_PATH, IGN_FUEL_CACHE_PATH, ~/.gz/fuel and ~/.ignition/fuel.
  static ModelPath from_environment(const std::vector<std::string>& command_line, const std::filesystem::path& installed);

  // The folder and models/ in it are searched before all others: the place of the world itself.
  void add_first(const std::filesystem::path& folder);

  const std::vector<std::filesystem::path>& folders() const { return folders_; }
  // A folder in which Gazebo keeps what it has fetched: SERVER/OWNER/models/NAME/VERSION/...; only for Fuel addresses.
  void add_fuel_cache(const std::filesystem::path& folder) { fuel_caches_.push_back(folder); }

  // The same places, but nothing outside of them is found, by whatever address: for models that come from those who may not read all that
  // the server may.
  ModelPath confined() const;

  // What a URI in a file of `folder` means: model://name/..., model:///name, package://, file://, Fuel addresses (by the model's name,
  // then in the caches), absolute and relative paths. The file or folder exists; empty when none does.
  std::optional<std::filesystem::path> find(std::string_view uri, const std::filesystem::path& folder) const;

  // For what find() gave: a line when a Fuel address asks for one version of a model and the cache has another, "version 2 of it is taken
  // instead of version 1, which is not here"; else empty.
  std::string other_version(std::string_view uri, const std::filesystem::path& found) const;

  // Every NAME that find("model://NAME") gives a model for: folders with a model.config or model.sdf, sorted, each once. At most
  // `max_listed` of them; unreadable folders have none. Fuel caches are not looked into.
  static constexpr std::size_t max_listed = 10'000;
  std::vector<std::string> models() const;
  // "; did you mean NAME?" for a URI that find() knows nothing for, when a model has nearly the name in it; else empty.
  std::string suggestion_for(std::string_view uri) const;

 private:
  std::optional<std::filesystem::path> look_for(std::string_view uri, const std::filesystem::path& folder) const;
  bool holds(const std::filesystem::path& found) const;

  bool is_confined_ = false;
  std::vector<std::filesystem::path> folders_;
  std::vector<std::filesystem::path> fuel_caches_;
};

}  // namespace sim
