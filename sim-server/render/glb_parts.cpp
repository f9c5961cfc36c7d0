#include "render/glb_parts.h"

#include <spdlog/fmt/fmt.h>

#include <bit>
#include <cstdint>

#include "base/text.h"

namespace sim::glb {
namespace {

static_assert(std::endian::native == std::endian::little, "glTF is little-endian");

// How many bytes of `rest` are one character of UTF-8; 0: none.
std::size_t utf8_length(std::string_view rest) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(rest[i]); };
  const std::size_t length = byte(0) < 0x80 ? 1 : byte(0) >> 5U == 6 ? 2 : byte(0) >> 4U == 14 ? 3 : byte(0) >> 3U == 30 ? 4 : 0;
  if (length > rest.size()) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if (byte(i) >> 6U != 2) return 0;
  }
  return length;
}

void put_u32(std::string& out, std::size_t value) {
  for (unsigned shift = 0; shift < 32; shift += 8) out.push_back(static_cast<char>(value >> shift & 0xffU));
}

void put_chunk(std::string& out, const char* kind, const std::string& content, char padding) {
  const std::size_t padded = (content.size() + 3) / 4 * 4;
  put_u32(out, padded);
  out.append(kind, 4);
  out += content;
  out.append(padded - content.size(), padding);
}

constexpr const char* list_names[lists] = {"nodes",    "meshes", "materials", "textures",  "images",
                                           "samplers", "skins",  "lights",    "accessors", "bufferViews"};

}  // namespace

std::string text(std::string_view plain) {
  std::string out = "\"";
  for (std::size_t i = 0; i < plain.size();) {
    const std::size_t length = utf8_length(plain.substr(i));
    const char c = plain[i];
    if (length == 0) {
      out += '?';
    } else if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (static_cast<unsigned char>(c) < 32) {
      out += fmt::format("\\u{:04x}", static_cast<int>(c));
    } else {
      out.append(plain.substr(i, length));
    }
    i += std::max<std::size_t>(1, length);
  }
  return out + '"';
}

std::string number(double value) { return fmt::format("{}", value); }

std::string numbers(std::span<const double> values) {
  std::vector<std::string> texts;
  for (const double value : values) texts.push_back(number(value));
  return join(texts);
}

std::string vector3(const Eigen::Vector3d& v) { return numbers(std::span(v.data(), 3)); }

std::string quaternion(const Eigen::Matrix3d& rotation) {
  const Eigen::Quaterniond q = Eigen::Quaterniond(rotation).normalized();
  return numbers(std::span(q.coeffs().data(), 4));
}

std::string matrix(const Eigen::Matrix4d& m) { return numbers(std::span(m.data(), 16)); }

std::string join(const std::vector<std::string>& values) { return "[" + base::join(values, ",") + "]"; }

std::string indices(std::span<const std::size_t> values) {
  std::vector<std::string> texts;
  for (const auto value : values) texts.push_back(std::to_string(value));
  return join(texts);
}

std::size_t Parts::add(List list, std::string object) {
  auto& entries = lists_[static_cast<std::size_t>(list)];
  entries.push_back(std::move(object));
  return entries.size() - 1;
}

std::size_t Parts::add_octets(std::span<const std::byte> octets, Target target) {
  octets_.append((4 - octets_.size() % 4) % 4, '\0');
  const std::string role = target == Target::none ? "" : fmt::format(",\"target\":{}", static_cast<int>(target));
  const auto view =
      add(List::views, fmt::format("{{\"buffer\":0,\"byteOffset\":{},\"byteLength\":{}{}}}", octets_.size(), octets.size(), role));
  octets_.append(reinterpret_cast<const char*>(octets.data()), octets.size());
  return view;
}

std::size_t Parts::add_accessor(std::span<const std::byte> octets, Target target, Component component, std::string_view type,
                                std::size_t count, const std::string& limits) {
  return add(List::accessors, fmt::format("{{\"bufferView\":{},\"componentType\":{},\"type\":\"{}\",\"count\":{}{}}}",
                                          add_octets(octets, target), static_cast<int>(component), type, count, limits));
}

std::string Parts::finish(const std::string& scene, const std::vector<std::string>& extensions) const {
  std::string json = R"({"asset":{"version":"2.0","generator":"rtm-sim"},"scene":0,"scenes":[)" + scene + "]";
  for (std::size_t i = 0; i < lists; ++i) {
    if (lists_[i].empty() || i == static_cast<std::size_t>(List::lights)) continue;
    json += fmt::format(",\"{}\":{}", list_names[i], join(lists_[i]));
  }
  if (!octets_.empty()) json += fmt::format(",\"buffers\":[{{\"byteLength\":{}}}]", octets_.size());
  const auto& lights = lists_[static_cast<std::size_t>(List::lights)];
  if (!lights.empty()) json += R"(,"extensions":{"KHR_lights_punctual":{"lights":)" + join(lights) + "}}";
  if (!extensions.empty()) json += ",\"extensionsUsed\":" + join(extensions);
  json += "}";
  std::string chunks;
  put_chunk(chunks, "JSON", json, ' ');
  if (!octets_.empty()) put_chunk(chunks, std::string("BIN\0", 4).c_str(), octets_, '\0');
  std::string file = "glTF";
  put_u32(file, 2);
  put_u32(file, 12 + chunks.size());
  return file + chunks;
}

}  // namespace sim::glb
