#include "studio/page_files.h"

#include <libdeflate.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <vector>

#include "base/text.h"

namespace studio {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t max_files = 200;
constexpr std::uintmax_t max_octets = 16 << 20;
constexpr int compression_level = 9;

constexpr std::string_view unbuilt_page =
    "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><title>rtm-studio</title></head><body><h1>rtm-studio</h1><p>The page "
    "was "
    "not built: this installation has no folder share/rtm-sim/studio. The server runs all the same: clients of foxglove.websocket.v1 "
    "connect "
    "to /ws.</p></body></html>\n";

std::string type_of(const std::string& extension) {
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 11> types = {{{".html", "text/html; charset=utf-8"},
                                                                                           {".js", "text/javascript; charset=utf-8"},
                                                                                           {".mjs", "text/javascript; charset=utf-8"},
                                                                                           {".css", "text/css; charset=utf-8"},
                                                                                           {".json", "application/json"},
                                                                                           {".svg", "image/svg+xml"},
                                                                                           {".png", "image/png"},
                                                                                           {".jpg", "image/jpeg"},
                                                                                           {".woff2", "font/woff2"},
                                                                                           {".wasm", "application/wasm"},
                                                                                           {".ico", "image/x-icon"}}};
  for (const auto& [ending, type] : types) {
    if (ending == extension) return std::string(type);
  }
  return "application/octet-stream";
}

std::string compressed(const std::string& octets) {
  const std::unique_ptr<libdeflate_compressor, void (*)(libdeflate_compressor*)> compressor(libdeflate_alloc_compressor(compression_level),
                                                                                            libdeflate_free_compressor);
  if (!compressor) return {};
  std::string result(octets.size(), '\0');
  result.resize(libdeflate_gzip_compress(compressor.get(), octets.data(), octets.size(), result.data(), result.size()));
  return result;
}

base::Result<PageFile> read_file(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  PageFile file{type_of(path.extension().string()), {std::istreambuf_iterator<char>(in), {}}, {}};
  if (!in) return base::Error{"file " + base::in_quotes(path.string()) + ": cannot be read"};
  file.compressed = compressed(file.octets);
  return file;
}

// What a URL may name without any escape.
bool is_plain(const std::string& name) {
  constexpr std::string_view plain = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-";
  return !name.starts_with('.') && name.find_first_not_of(plain) == std::string::npos;
}

}  // namespace

base::Result<PageFiles> PageFiles::read(const std::string& folder) {
  PageFiles page;
  std::error_code error;
  const fs::path root(folder);
  if (!fs::is_regular_file(root / "index.html", error)) {
    page.files_["/"] = {type_of(".html"), std::string(unbuilt_page), {}};
    return page;
  }
  std::vector<std::pair<std::string, fs::path>> found{{"/", root / "index.html"}};
  for (const auto& entry : fs::directory_iterator(root / "assets", error)) {
    const auto name = entry.path().filename().string();
    if (entry.is_regular_file(error) && is_plain(name)) found.emplace_back("/assets/" + name, entry.path());
  }
  if (found.size() > max_files) return base::Error{"folder " + base::in_quotes(folder) + ": has more than 200 files"};
  std::uintmax_t octets = 0;
  for (const auto& [url, path] : found) {
    octets += fs::file_size(path, error);
    if (octets > max_octets) return base::Error{"folder " + base::in_quotes(folder) + ": holds more than 16 MiB"};
    auto file = read_file(path);
    if (!file) return file.error();
    page.files_[url] = std::move(*file);
  }
  return page;
}

const PageFile* PageFiles::find(std::string_view path) const {
  const auto found = files_.find(path);
  return found == files_.end() ? nullptr : &found->second;
}

std::string default_page_folder() {
  std::error_code error;
  return (fs::read_symlink("/proc/self/exe", error).parent_path().parent_path() / "share/rtm-sim/studio").string();
}

}  // namespace studio
