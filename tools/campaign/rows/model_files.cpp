#include "campaign/rows/model_files.h"

#include <cstdlib>

#include "base/beneath.h"
#include "base/child_process.h"
#include "base/text.h"

namespace campaign {
namespace fs = std::filesystem;
namespace {

// What a world may name: no device and no pipe, which could keep us for ever.
bool is_there(const fs::path& path) {
  std::error_code error;
  const auto status = fs::status(path, error);
  return fs::is_regular_file(status) || fs::is_directory(status);
}

// Of a model's folder.
std::optional<fs::path> model_in(const fs::path& folder) {
  if (is_there(folder / "model.sdf")) return folder / "model.sdf";
  pugi::xml_document config;
  const auto file = folder / "model.config";
  if (!base::check_regular_file(file) || !config.load_file(file.c_str())) return std::nullopt;
  const auto named = folder / config.child("model").child("sdf").text().get();
  std::error_code error;
  return fs::is_regular_file(named, error) ? std::optional(named) : std::nullopt;
}

}  // namespace

ModelFiles::ModelFiles(const fs::path& world_folder, const std::vector<std::string>& resource_paths) {
  const auto add = [&](const fs::path& folder) {
    folders_.push_back(folder / "models");
    folders_.push_back(folder);
  };
  add(world_folder);
  for (const auto& path : resource_paths) add(path);
  for (const char* variable :
       {"RTMSIM_RESOURCE_PATH", "GZ_SIM_RESOURCE_PATH", "IGN_GAZEBO_RESOURCE_PATH", "GAZEBO_MODEL_PATH", "GAZEBO_RESOURCE_PATH"}) {
    const char* list = std::getenv(variable);
    for (const auto& path : base::split_list(list != nullptr ? list : "", ':')) add(path);
  }
  add(fs::path(editor::own_program("sim-server")).parent_path().parent_path() / "share" / "rtm-sim" / "worlds");
  add(RTMSIM_WORLDS_DIR);
}

std::optional<fs::path> ModelFiles::find(const std::string& uri, const fs::path& at) const {
  std::string name = uri;
  for (const char* scheme : {"model://", "package://", "file://"}) {
    if (name.starts_with(scheme)) name = name.substr(std::string(scheme).size());
  }
  while (name.starts_with("/") && uri.starts_with("model:///")) name.erase(0, 1);
  if (name.empty()) return std::nullopt;
  if (fs::path(name).is_absolute()) return is_there(name) ? std::optional(fs::path(name)) : std::nullopt;
  if (!at.empty() && is_there(at / name)) return at / name;
  for (const auto& folder : folders_) {
    if (is_there(folder / name)) return folder / name;
  }
  return std::nullopt;
}

std::optional<ModelFiles::Opened> ModelFiles::open(pugi::xml_node include, const fs::path& at, const char* kind) const {
  const std::string uri = include.child("uri").text().get();
  if (uri.starts_with("model://")) {
    if (const auto copy = copies_.find(uri.substr(8)); copy != copies_.end())
      return Opened{copy->second->document.child("sdf").child(kind), copy->second->file};
  }
  auto place = find(uri, at);
  std::error_code error;
  if (place && fs::is_directory(*place, error)) place = model_in(*place);
  if (!place) return std::nullopt;
  auto& document = read_[fs::absolute(*place)];
  if (!document) {
    document = std::make_unique<pugi::xml_document>();
    document->load_file(place->c_str());
  }
  const auto found = document->child("sdf").child(kind);
  return found ? std::optional(Opened{found, fs::absolute(*place)}) : std::nullopt;
}

std::optional<ModelFiles::Opened> ModelFiles::copy(pugi::xml_node include, const fs::path& at, const std::string& name) {
  const auto original = open(include, at);
  if (!original) return std::nullopt;
  auto& copy = copies_[name];
  if (!copy) {
    copy = std::make_unique<Copy>();
    copy->document.reset(*read_.at(original->file));
    copy->file = original->file;
  }
  return Opened{copy->document.child("sdf").child("model"), copy->file};
}

std::string ModelFiles::name_of(pugi::xml_node include, const fs::path& at) const {
  if (const std::string name = include.child("name").text().get(); !name.empty()) return name;
  const auto opened = open(include, at);
  return opened ? opened->model.attribute("name").value() : "";
}

void ModelFiles::walk(pugi::xml_node node, const fs::path& at, const std::function<void(pugi::xml_node, const fs::path&)>& visit) const {
  if (std::string(node.name()) == "include") {
    if (const auto opened = open(node, at)) walk(opened->model, opened->file.parent_path(), visit);
    return;
  }
  visit(node, at);
  for (auto child : node.children()) {
    if (const std::string kind = child.name(); kind == "model" || kind == "include") walk(child, at, visit);
  }
}

bool ModelFiles::add_model(const std::string& uri, std::set<std::string>& files) const {
  auto place = find(uri, fs::path());
  std::error_code error;
  if (place && fs::is_directory(*place, error)) place = model_in(*place);
  if (!place || !fs::is_regular_file(*place, error)) return false;
  files.insert(fs::absolute(*place).string());
  pugi::xml_document document;
  if (document.load_file(place->c_str())) add_files(document, place->parent_path(), files);
  return true;
}

void ModelFiles::add_files(pugi::xml_node node, const fs::path& at, std::set<std::string>& files) const {
  if (std::string(node.name()) == "include") {
    const auto model = open(node, at);
    if (const auto opened = model ? model : open_light(node, at)) {
      files.insert(opened->file.string());
      add_files(opened->model, opened->file.parent_path(), files);
    }
    return;
  }
  for (auto child : node.children()) {
    if (std::string(child.name()) == "uri") {
      const auto found = find(child.text().get(), at);
      std::error_code error;
      if (found && fs::is_regular_file(*found, error)) files.insert(fs::absolute(*found).string());
    }
    add_files(child, at, files);
  }
}

std::vector<double> numbers_in(const std::string& text) {
  std::vector<double> numbers;
  std::string blanks = text;
  for (char& c : blanks) c = c == '\n' || c == '\t' || c == '\r' ? ' ' : c;
  for (const auto& word : base::split_list(blanks, ' ')) {
    const auto number = base::parse_number(word);
    if (!number) break;
    numbers.push_back(*number);
  }
  return numbers;
}

}  // namespace campaign
