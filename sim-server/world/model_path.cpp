#include "world/model_path.h"

#include <algorithm>
#include <cstdlib>
#include <set>

#include "base/suggestion.h"
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

// "https://fuel.gazebosim.org/1.0/Owner/models/Cardboard box/2/files/meshes/x.dae" and
// "https://app.gazebosim.org/Owner/fuel/models/Cardboard box"; empty texts for what the address does not say.
struct FuelAddress {
  std::string server, owner, model, version, file;

  std::string path() const { return file.empty() ? model : model + "/" + file; }
};

FuelAddress fuel_address(std::string_view address) {
  FuelAddress out;
  const std::size_t models = address.find("/models/");
  if (models == std::string_view::npos) return out;
  const std::vector<std::string> before = base::split_list(std::string(address.substr(0, models)), '/');
  if (!before.empty()) out.server = before.front();
  const std::size_t owner = before.size() > 1 && before.back() == "fuel" ? 2 : 1;
  if (before.size() > owner) out.owner = before[before.size() - owner];
  std::string_view rest = address.substr(models + 8);
  if (const std::size_t files = rest.find("/files/"); files != std::string_view::npos) {
    out.file = rest.substr(files + 7);
    rest = rest.substr(0, files);
  }
  const std::size_t slash = rest.find('/');
  out.model = rest.substr(0, slash);
  if (slash != std::string_view::npos) out.version = rest.substr(slash + 1);
  return out;
}

// Folders are usually named in lower case with underscores where Fuel has "Cardboard box".
std::string folder_spelling(std::string_view name) {
  const std::size_t slash = name.find('/');
  std::string first = base::to_lower(name.substr(0, slash));
  std::replace(first.begin(), first.end(), ' ', '_');
  return slash == std::string_view::npos ? first : first.append(name.substr(slash));
}

// The path without links. A file whose target has another extension (as in the store of git-annex) keeps the name that was asked for: the
// extension is its format. The target's folder is not its place then.
fs::path without_links(const fs::path& path) {
  std::error_code problem;
  fs::path clean = fs::weakly_canonical(path, problem);
  if (problem) return path;
  if (clean.extension() == path.extension() || fs::is_directory(clean, problem)) return clean;
  fs::path folder = fs::weakly_canonical(path.parent_path(), problem);
  return problem ? path : folder / path.filename();
}

std::optional<fs::path> usable(const fs::path& path) {
  if (!is_there(path)) return std::nullopt;
  return without_links(path);
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

std::vector<fs::path> folders_in(const fs::path& folder) {
  std::vector<fs::path> out;
  std::error_code problem;
  for (fs::directory_iterator at(folder, problem), end; !problem && at != end; at.increment(problem)) {
    if (at->is_directory(problem)) out.push_back(at->path());
  }
  std::sort(out.begin(), out.end());
  return out;
}

// The version that is asked for, else the newest.
std::optional<fs::path> newest_version(const fs::path& model, const std::string& asked) {
  if (!asked.empty() && is_there(model / asked)) return model / asked;
  std::optional<fs::path> newest;
  std::int64_t best = 0;
  for (const fs::path& folder : folders_in(model)) {
    const std::optional<std::int64_t> number = base::parse_integer(folder.filename().string());
    if (number && *number > best) best = *number, newest = folder;
  }
  return newest;
}

// Names of owners and models are kept in lower case.
std::optional<fs::path> find_in_cache(const fs::path& cache, const FuelAddress& address) {
  std::vector<fs::path> servers = folders_in(cache);
  std::stable_partition(servers.begin(), servers.end(), [&](const fs::path& server) { return server.filename() == address.server; });
  for (const fs::path& server : servers) {
    for (const auto& [owner, model] :
         {std::pair(base::to_lower(address.owner), base::to_lower(address.model)), std::pair(address.owner, address.model)}) {
      const std::optional<fs::path> version = newest_version(server / owner / "models" / model, address.version);
      if (!version) continue;
      if (auto found = usable(address.file.empty() ? *version : *version / address.file)) return found;
    }
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
  ModelPath path(std::move(folders));
  for (const char* variable : {"GZ_FUEL_CACHE_PATH", "IGN_FUEL_CACHE_PATH"}) {
    if (const char* folder = std::getenv(variable)) path.add_fuel_cache(folder);
  }
  if (const char* home = std::getenv("HOME")) {
    for (const char* folder : {".gz/fuel", ".ignition/fuel"}) path.add_fuel_cache(fs::path(home) / folder);
  }
  return path;
}

void ModelPath::add_first(const fs::path& folder) { folders_.insert(folders_.begin(), folder); }

ModelPath ModelPath::confined() const {
  ModelPath path = *this;
  path.is_confined_ = true;
  return path;
}

// Of a path without links.
bool ModelPath::holds(const fs::path& found) const {
  const auto is_in = [&](const fs::path& folder) {
    std::error_code problem;
    const fs::path root = fs::canonical(folder, problem);
    return !problem && std::mismatch(root.begin(), root.end(), found.begin(), found.end()).first == root.end();
  };
  return std::any_of(folders_.begin(), folders_.end(), is_in) || std::any_of(fuel_caches_.begin(), fuel_caches_.end(), is_in);
}

std::optional<fs::path> ModelPath::find(std::string_view uri, const fs::path& folder) const {
  auto found = look_for(uri, folder);
  if (!found || !is_confined_) return found;
  std::error_code problem;
  const fs::path real = fs::canonical(*found, problem);
  return !problem && holds(real) ? std::optional(without_links(*found)) : std::nullopt;
}

std::string ModelPath::other_version(std::string_view uri, const fs::path& found) const {
  const FuelAddress address = fuel_address(without_percent_codes(base::trim(uri)));
  if (!base::parse_integer(address.version)) return {};
  for (const fs::path& cache : fuel_caches_) {
    std::error_code problem;
    const fs::path inside = fs::relative(found, fs::weakly_canonical(cache, problem), problem);
    const std::vector<fs::path> parts(inside.begin(), inside.end());  // server, owner, models, name, version, ...
    if (problem || parts.size() < 5 || parts[0] == ".." || parts[4] == address.version) continue;
    return "version " + parts[4].string() + " of it is taken instead of version " + address.version + ", which is not here";
  }
  return {};
}

std::string ModelPath::suggestion_for(std::string_view uri) const {
  constexpr std::string_view scheme = "model://";
  if (uri.starts_with(scheme)) uri.remove_prefix(scheme.size());
  return uri.find_first_of("/<") == std::string_view::npos ? base::suggestion(uri, models()) : "";
}

std::vector<std::string> ModelPath::models() const {
  std::set<std::string> names;
  for (const fs::path& place : folders_) {
    for (const fs::path& folder : {place, place / "models"}) {
      for (const fs::path& model : folders_in(folder)) {
        if (names.size() >= max_listed) break;
        const std::string name = model.filename().string();
        const bool is_model = is_there(model / "model.config") || is_there(model / "model.sdf");
        if (is_model && find("model://" + name, {})) names.insert(name);
      }
    }
  }
  return {names.begin(), names.end()};
}

std::optional<fs::path> ModelPath::look_for(std::string_view uri, const fs::path& folder) const {
  const std::string text = without_percent_codes(base::trim(uri));
  std::string_view rest = text;
  if (rest.empty() || rest.size() > 4096) return std::nullopt;
  if (const std::size_t end = rest.find(')'); rest.starts_with("$(find ") && end != std::string_view::npos) {
    // As in launch files and xacro.
    return find_model(std::string(base::trim(rest.substr(7, end - 7))).append(rest.substr(end + 1)), folder, folders_);
  }
  if (take_prefix(rest, "http://") || take_prefix(rest, "https://") || take_prefix(rest, "fuel://")) {
    const FuelAddress address = fuel_address(rest);
    if (address.model.empty()) return find_model(std::string(rest), folder, folders_);
    if (auto found = find_model(address.path(), folder, folders_)) return found;
    if (auto found = find_model(folder_spelling(address.path()), folder, folders_)) return found;
    for (const fs::path& cache : fuel_caches_) {
      if (auto found = find_in_cache(cache, address)) return found;
    }
    return std::nullopt;
  }
  if (take_prefix(rest, "model://") || take_prefix(rest, "package://")) {
    while (take_prefix(rest, "/")) {
    }
    return find_model(std::string(rest), folder, folders_);
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
