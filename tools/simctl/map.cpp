// The occupancy map of a world, as map_server reads it: made from the simulator's export of the shapes that collide.
#include <png.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>

#include "base/text.h"
#include "base/whole_file.h"
#include "simctl/simctl.h"

namespace simctl {
namespace {

using Json = nlohmann::ordered_json;
using base::Error;
using base::Result;

constexpr double occupied_threshold = 0.65, free_threshold = 0.196;

Result<std::string> png_of(const std::vector<std::uint8_t>& pixels, const shm::MapArea& area) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(area.width);
  image.height = static_cast<png_uint_32>(area.height);
  image.format = PNG_FORMAT_GRAY;
  png_alloc_size_t size = 0;
  if (png_image_write_to_memory(&image, nullptr, &size, 0, pixels.data(), 0, nullptr) == 0)
    return Error{std::string("map: ") + image.message};
  std::string out(size, '\0');
  if (png_image_write_to_memory(&image, out.data(), &size, 0, pixels.data(), 0, nullptr) == 0)
    return Error{std::string("map: ") + image.message};
  out.resize(size);
  return out;
}

// The name of the picture as JSON, which YAML reads: whatever is in it.
std::string yaml_of(const std::string& picture, const shm::MapArea& area) {
  return "image: " + Json(picture).dump(-1, ' ', true, Json::error_handler_t::replace) +
         "\nmode: trinary\nresolution: " + base::format_number(area.resolution) + "\norigin: [" + base::format_number(area.x) + ", " +
         base::format_number(area.y) + ", 0]\nnegate: 0\noccupied_thresh: " + base::format_number(occupied_threshold) +
         "\nfree_thresh: " + base::format_number(free_threshold) + "\n";
}

void report(const Control& control, const shm::MapArea& area, const std::vector<std::uint8_t>& pixels, const std::string& yaml) {
  const auto occupied = std::ranges::count(pixels, 0), free = std::ranges::count(pixels, 254);
  const auto unknown = static_cast<std::ptrdiff_t>(pixels.size()) - occupied - free;
  if (control.json()) {
    return control.print({{"yaml", yaml},
                          {"width", area.width},
                          {"height", area.height},
                          {"resolution", area.resolution},
                          {"origin", {area.x, area.y, 0}},
                          {"occupied", occupied},
                          {"free", free},
                          {"unknown", unknown}});
  }
  std::cout << yaml << ": " << area.width << " x " << area.height << " cells of " << base::format_number(area.resolution) << " m, "
            << occupied << " occupied, " << free << " free, " << unknown << " unknown\n";
}

}  // namespace

void map(Control& control, const MapOptions& options) {
  const auto reply = control.ask(shm::ExportRequest{true}, std::chrono::minutes(10));
  if (!reply) return;
  const auto made = shm::make_map(reply->text, options);
  if (!made) return control.fail(made.error().message);
  const auto png = png_of(made->pixels, made->area);
  if (!png) return control.fail(png.error().message);
  const std::filesystem::path picture = options.file;
  const auto yaml = std::filesystem::path(picture).replace_extension(".yaml");
  if (const auto written = base::write_whole_file(picture, *png); !written) return control.fail(written.error().message);
  if (const auto written = base::write_whole_file(yaml, yaml_of(picture.filename().string(), made->area)); !written)
    return control.fail(written.error().message);
  report(control, made->area, made->pixels, yaml.string());
}

}  // namespace simctl
