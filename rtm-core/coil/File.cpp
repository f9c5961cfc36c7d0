#include "coil/File.h"

#include <fnmatch.h>

#include <algorithm>
#include <filesystem>
#include <functional>

namespace coil {
namespace {

namespace fs = std::filesystem;

void collect(const std::string& dir, const std::function<bool(const fs::path&)>& is_wanted, std::vector<std::string>& out) {
  std::vector<std::string> found;
  std::error_code error;
  for (fs::recursive_directory_iterator it(dir, fs::directory_options::skip_permission_denied, error), end; !error && it != end;
       it.increment(error)) {
    std::error_code ignored;  // An entry that has gone meanwhile is not there.
    if (it->is_regular_file(ignored) && is_wanted(it->path())) found.push_back(it->path().string());
  }
  std::sort(found.begin(), found.end());
  out.insert(out.end(), found.begin(), found.end());
}

}  // namespace

std::string dirname(const std::string& path) {
  const auto slash = path.rfind('/');
  return slash == std::string::npos ? "./" : path.substr(0, slash + 1);
}

std::string basename(const std::string& path) { return path.substr(path.rfind('/') + 1); }

std::vector<std::string> filelist(const std::string& path, const std::string& glob_str) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator it(path, error), end; !error && it != end; it.increment(error)) {
    std::string name = it->path().filename().string();
    if (glob_str.empty() || ::fnmatch(glob_str.c_str(), name.c_str(), 0) == 0) names.push_back(std::move(name));
  }
  std::sort(names.begin(), names.end());
  return names;
}

void findFile(const std::string& dir, const std::string& filename, std::vector<std::string>& filelist) {
  collect(
      dir, [&](const fs::path& path) { return path.filename() == filename; }, filelist);
}

void getFileList(const std::string& dir, const std::string& ext, std::vector<std::string>& filelist) {
  collect(
      dir, [&](const fs::path& path) { return path.extension() == "." + ext; }, filelist);
}

}  // namespace coil
