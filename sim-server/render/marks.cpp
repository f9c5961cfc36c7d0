#include "render/marks.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/random.h"

namespace sim {
namespace {

constexpr std::uint32_t visual_bits = 0xffffff;

using Triple = std::array<std::uint8_t, 3>;

// A triple for each mark, that of nothing first.
template <class Make>
void write_triples(const Scene& scene, std::span<const std::uint32_t> marks, std::span<std::uint8_t> out, Make make) {
  std::vector<Triple> triples{Triple{}};
  for (const SceneVisual& visual : scene.visuals) triples.push_back(visual.object == 0 ? Triple{} : make(scene.objects[visual.object - 1]));
  const std::size_t pixels = std::min(marks.size(), out.size() / 3);
  for (std::size_t i = 0; i < pixels; ++i) {
    const std::uint32_t mark = marks[i] & visual_bits;
    const Triple& triple = triples[mark < triples.size() ? mark : 0];
    out[3 * i] = triple[0];
    out[3 * i + 1] = triple[1];
    out[3 * i + 2] = triple[2];
  }
}

// Never dark, so that it is told from the background.
Triple color_of(std::uint64_t what) {
  const std::uint64_t bits = base::mix64(what + base::mix64_step);
  Triple color{static_cast<std::uint8_t>(bits), static_cast<std::uint8_t>(bits >> 8), static_cast<std::uint8_t>(bits >> 16)};
  constexpr std::uint8_t bright = 128;
  auto& strongest = *std::max_element(color.begin(), color.end());
  strongest = static_cast<std::uint8_t>(bright + strongest / 2);
  return color;
}

}  // namespace

void write_labels(const Scene& scene, std::span<const std::uint32_t> marks, bool has_instances, std::span<std::uint8_t> out) {
  write_triples(scene, marks, out, [&](const SceneObject& object) {
    if (!has_instances) return Triple{object.label, object.label, object.label};
    return Triple{static_cast<std::uint8_t>(object.number >> 8), static_cast<std::uint8_t>(object.number), object.label};
  });
}

void write_label_colors(const Scene& scene, std::span<const std::uint32_t> marks, bool has_instances, std::span<std::uint8_t> out) {
  write_triples(scene, marks, out, [&](const SceneObject& object) {
    return color_of(object.label + (has_instances ? std::uint64_t{object.number} << 8 : 0));
  });
}

void write_temperatures(const Scene& scene, std::span<const std::uint32_t> marks, double air, std::vector<float>& out) {
  struct Heat {
    float lowest, step;
  };
  std::vector<Heat> heats{{static_cast<float>(air), 0}};
  for (const SceneVisual& visual : scene.visuals) {
    const double step = visual.signature ? (visual.highest - visual.lowest) / 255 : 0;
    heats.push_back(visual.has_heat ? Heat{static_cast<float>(visual.lowest), static_cast<float>(step)} : heats.front());
  }
  out.resize(marks.size());
  for (std::size_t i = 0; i < marks.size(); ++i) {
    const std::uint32_t mark = marks[i] & visual_bits;
    const Heat& heat = heats[mark < heats.size() ? mark : 0];
    out[i] = heat.lowest + heat.step * static_cast<float>(marks[i] >> 24);
  }
}

void write_thermal(std::span<const float> temperatures, const ThermalDef& thermal, std::span<std::uint8_t> out) {
  const std::size_t bytes = thermal.is_wide ? 2 : 1;
  const std::size_t pixels = std::min(temperatures.size(), out.size() / bytes);
  const float most = thermal.is_wide ? 65535 : 255;
  const auto low = static_cast<float>(thermal.lowest), high = static_cast<float>(thermal.highest),
             counts = static_cast<float>(1 / thermal.resolution);
  for (std::size_t i = 0; i < pixels; ++i) {
    const float count = std::min(std::round(std::clamp(temperatures[i], low, high) * counts), most);
    const auto whole = static_cast<std::uint32_t>(count);
    out[bytes * i] = static_cast<std::uint8_t>(whole);
    if (thermal.is_wide) out[2 * i + 1] = static_cast<std::uint8_t>(whole >> 8);
  }
}

std::vector<SeenObject> seen_objects(const Scene& scene, std::span<const std::uint32_t> marks, int width) {
  std::vector<std::uint32_t> object_of{0};  // by mark; 1 + index
  for (const SceneVisual& visual : scene.visuals) object_of.push_back(visual.object);
  std::vector<SeenObject> all(scene.objects.size());
  const auto columns = static_cast<std::size_t>(width);
  // By runs of one mark, of which a row has few.
  for (std::size_t row = 0; (row + 1) * columns <= marks.size(); ++row) {
    const std::span<const std::uint32_t> line = marks.subspan(row * columns, columns);
    for (std::size_t first = 0, end = 0; first < columns; first = end) {
      for (end = first + 1; end < columns && line[end] == line[first];) ++end;
      const std::uint32_t mark = line[first] & visual_bits;
      const std::uint32_t object = mark < object_of.size() ? object_of[mark] : 0;
      if (object == 0) continue;
      SeenObject& seen = all[object - 1];
      const int left = static_cast<int>(first), right = static_cast<int>(end) - 1, y = static_cast<int>(row);
      if (seen.pixels == 0) seen = {object - 1, 0, left, y, right, y};
      seen.pixels += static_cast<std::uint32_t>(end - first);
      seen.left = std::min(seen.left, left);
      seen.right = std::max(seen.right, right);
      seen.bottom = y;
    }
  }
  std::erase_if(all, [](const SeenObject& seen) { return seen.pixels == 0; });
  return all;
}

}  // namespace sim
