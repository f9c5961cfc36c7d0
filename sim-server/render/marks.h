// Labels, objects and temperatures of an image of marks. A mark names the visual that a pixel shows: a word for each pixel, rows from the
// top down: 1 + index into Scene::visuals in the lower 24 bits, 0 for nothing; the grey of the visual's signature in the upper 8. Values;
// any thread.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/scene.h"

namespace sim {

// Three bytes a pixel, as RTMSIM_FORMAT_LABELS says.
void write_labels(const Scene& scene, std::span<const std::uint32_t> marks, bool has_instances, std::span<std::uint8_t> out);
// The same for people: red, green, blue of a colour of each label, or of each object; black without one. They depend on label and number
// alone.
void write_label_colors(const Scene& scene, std::span<const std::uint32_t> marks, bool has_instances, std::span<std::uint8_t> out);

// [K] of each pixel; what has no temperature of its own is as warm as the air.
void write_temperatures(const Scene& scene, std::span<const std::uint32_t> marks, double air, std::vector<float>& out);
// Counts of the camera, little endian; beyond its range: at its end.
void write_thermal(std::span<const float> temperatures, const ThermalDef& thermal, std::span<std::uint8_t> out);

// An object that some pixels show.
struct SeenObject {
  std::uint32_t object = 0;  // index into Scene::objects
  std::uint32_t pixels = 0;
  int left = 0, top = 0, right = 0, bottom = 0;  // of the outermost pixels
};
// In the order of the scene.
std::vector<SeenObject> seen_objects(const Scene& scene, std::span<const std::uint32_t> marks, int width);

}  // namespace sim
