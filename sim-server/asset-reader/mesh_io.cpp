#include "asset-reader/mesh_io.h"

#include <assimp/MemoryIOWrapper.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>

#include "base/text.h"

namespace sim {

namespace {

bool is_blank(std::string_view text) { return base::trim(text).empty(); }

// Whether what stands between <image> and </image> names no file and holds no picture.
bool names_nothing(std::string_view inside) {
  if (inside.find("<data") != std::string_view::npos) return false;
  const std::size_t begin = inside.find("<init_from");
  if (begin == std::string_view::npos) return true;
  const std::size_t end = inside.find('>', begin);
  if (end == std::string_view::npos) return false;
  if (inside[end - 1] == '/') return true;
  const std::size_t close = inside.find("</init_from", end);
  return close != std::string_view::npos && is_blank(inside.substr(end + 1, close - end - 1));
}

}  // namespace

std::string with_named_images(const std::string& collada) {
  const std::string naming = "<init_from>" + std::string(no_image) + "</init_from>";
  std::string out;
  std::size_t copied = 0;
  for (std::size_t at = collada.find("<image"); at != std::string::npos; at = collada.find("<image", at + 1)) {
    const char next = at + 6 < collada.size() ? collada[at + 6] : '\0';
    const std::size_t tag_end = collada.find('>', at);
    if ((next != ' ' && next != '>' && next != '/' && next != '\n' && next != '\t' && next != '\r') || tag_end == std::string::npos)
      continue;
    if (collada[tag_end - 1] == '/') {
      out.append(collada, copied, tag_end - 1 - copied).append(">" + naming + "</image>");
      copied = tag_end + 1;
      continue;
    }
    const std::size_t close = collada.find("</image", tag_end);
    if (close == std::string::npos) break;
    if (!names_nothing(std::string_view(collada).substr(tag_end + 1, close - tag_end - 1))) continue;
    out.append(collada, copied, tag_end + 1 - copied).append(naming);
    copied = close;
  }
  return copied == 0 ? collada : out.append(collada, copied);
}

std::string import_fault(std::string_view said) {
  const auto is_said = [&](std::string_view words) { return said.find(words) != std::string_view::npos; };
  if (is_said("bad_alloc")) return "is too large for the memory";
  if (is_said("STL storage representation")) return "is no STL file: neither text, nor as long as the number of its triangles says";
  return base::in_quotes(said);
}

bool MeshIo::Exists(const char* file) const { return files_.exists(file); }

Assimp::IOStream* MeshIo::Open(const char* file, const char* mode) {
  if (std::string_view(mode).find_first_of("wa+") != std::string_view::npos) return nullptr;
  const auto content = files_.read(file, max_mesh_file);
  if (!content) return nullptr;
  const bool is_collada = base::to_lower(std::filesystem::path(file).extension().string()) == ".dae";
  const std::string text = is_collada ? with_named_images(*content) : std::string();
  const std::string& all = is_collada ? text : *content;
  auto* bytes = new std::uint8_t[all.size() + 1];  // the stream's from now on
  std::copy(all.begin(), all.end(), bytes);
  return new Assimp::MemoryIOStream(bytes, all.size(), true);
}

}  // namespace sim
