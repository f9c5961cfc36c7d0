#include "world/model_path.h"

#include <algorithm>
#include <cstdlib>

#include "base/text.h"

namespace sim {

namespace fs = std::filesystem;

namespace {

// Pipes and devices are no models: reading one may never end.
bool is_there(const fs::path& path) {
  std::error_code problem;
  const fs::file_status status = fs::status(path, problem);
  return !problem && (fs::is_regular_file(status) || fs::is_directory(status));
}

bool take_prefix(std::string_view& text, std::string_view prefix) {
  if (!text.starts_with(prefix)) return false;
  text.remove_prefix(prefix.size());
  return true;
}

std::string without_percent_codes(std::string_view text) {
  const auto digit = [](char c) { return c >= '0' && c <= '9' ? c - '0' : (c | 32) >= 'a' && (c | 32) <= 'f' ? (c | 32) - 'a' + 10 : -1; };
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '%' && i + 2 < text.size() && digit(text[i + 1]) >= 0 && digit(text[i + 2]) >= 0) {
      out += static_cast<char>(digit(text[i + 1]) * 16 + digit(text[i + 2]));
      i += 2;
    } else {
      out += text[i];
    }
  }
  return out;
}

// "owner/models/Cardboard box/2/files/meshes/x.dae" -> "Cardboard box/meshes/x.dae": what the address means without its server and version.
std::string fuel_model(std::string_view address) {
  const std::size_t models = address.find("/models/");
  if (models == std::string_view::npos) return {};
  std::string_view rest = address.substr(models + 8);
  const std::size_t slash = rest.find('/');
  std::string name(rest.substr(0, slash));
  const std::size_t files = address.find("/files/", models);
  if (files != std::string_view::npos) name.append("/").append(address.substr(files + 7));
  return name;
}

// Folders are usually named in lower case with underscores where Fuel has "Cardboard box".
std::string folder_spelling(std::string_view name) {
  const std::size_t slash = name.find('/');
  std::string first = base::to_lower(name.substr(0, slash));
  std::replace(first.begin(), first.end(), ' ', '_');
  return slash == std::string_view::npos ? first : first.append(name.substr(slash));
}

std::optional<fs::path> usable(const fs::path& path) {
  if (!is_there(path)) return std::nullopt;
  std::error_code problem;
  fs::path clean = fs::weakly_canonical(path, problem);
  return problem ? path : clean;
}

std::optional<fs::path> find_model(const std::string& name, const fs::path& folder, const std::vector<fs::path>& folders) {
  if (name.empty()) return std::nullopt;
  for (const fs::path& candidate : folders) {
    if (auto found = usable(candidate / name)) return found;
    if (auto found = usable(candidate / "models" / name)) return found;
  }
  // A model whose folder is in no path still finds its own files and its neighbours.
  fs::path around = folder;
  for (int up = 0; up < 6 && !around.empty(); ++up) {
    if (auto found = usable(around / name)) return found;
    if (around == around.parent_path()) break;
    around = around.parent_path();
  }
  return std::nullopt;
}

void append_list(std::vector<fs::path>& folders, const char* variable) {
  if (const char* list = std::getenv(variable)) {
    for (std::string& folder : base::split_list(list, ':')) folders.emplace_back(std::move(folder));
  }
}

}  // namespace

ModelPath::ModelPath(std::vector<fs::path> folders) : folders_(std::move(folders)) {}

ModelPath ModelPath::from_environment(const std::vector<std::string>& command_line, const fs::path& installed) {
  std::vector<fs::path> folders(command_line.begin(), command_line.end());
  for (const char* variable :
       {"RTMSIM_RESOURCE_PATH", "GZ_SIM_RESOURCE_PATH", "IGN_GAZEBO_RESOURCE_PATH", "GAZEBO_MODEL_PATH", "GAZEBO_RESOURCE_PATH"}) {
    append_list(folders, variable);
  }
  if (!installed.empty()) folders.push_back(installed);
  return ModelPath(std::move(folders));
}

void ModelPath::add_first(const fs::path& folder) { folders_.insert(folders_.begin(), folder); }

std::optional<fs::path> ModelPath::find(std::string_view uri, const fs::path& folder) const {
  const std::string text = without_percent_codes(base::trim(uri));
  std::string_view rest = text;
  if (rest.empty() || rest.size() > 4096) return std::nullopt;
  if (const std::size_t end = rest.find(')'); rest.starts_with("$(find ") && end != std::string_view::npos) {
    // As in launch files and xacro.
    return find_model(std::string(base::trim(rest.substr(7, end - 7))).append(rest.substr(end + 1)), folder, folders_);
  }
  if (take_prefix(rest, "model://") || take_prefix(rest, "package://") || take_prefix(rest, "fuel://")) {
    while (take_prefix(rest, "/")) {
    }
    return find_model(std::string(rest), folder, folders_);
  }
  if (rest.starts_with("http://") || rest.starts_with("https://")) {
    const std::string name = fuel_model(rest);
    if (auto found = find_model(name, folder, folders_)) return found;
    return find_model(folder_spelling(name), folder, folders_);
  }
  if (take_prefix(rest, "file://") || take_prefix(rest, "material://")) {
  } else if (rest.find("://") != std::string_view::npos) {
    return std::nullopt;
  }
  const fs::path path(rest);
  if (path.is_absolute()) return usable(path);
  if (auto found = usable(folder / path)) return found;
  return find_model(std::string(rest), folder, folders_);
}

}  // namespace sim
