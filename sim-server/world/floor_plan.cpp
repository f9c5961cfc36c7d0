#include "world/floor_plan.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <utility>

#include "base/text.h"
#include "reader/asset_reader.h"
#include "world/xml_file.h"
#include "world/xml_values.h"

namespace sim {

namespace fs = std::filesystem;

namespace {

constexpr std::int64_t max_plan_pixels = 4096;
constexpr std::size_t max_walls = 20'000;

struct Picture {
  std::int64_t width = 0, height = 0;
  std::vector<std::uint8_t> rgba;
};

bool take_picture(ArrayReader& in, Picture& picture) {
  picture.width = in.number<std::int64_t>();
  picture.height = in.number<std::int64_t>();
  if (picture.width < 1 || picture.height < 1 || std::max(picture.width, picture.height) > 16384) return false;
  const auto bytes = static_cast<std::uint64_t>(picture.width * picture.height * 4);
  picture.rgba = in.array<std::uint8_t>(bytes);
  return in.ok() && picture.rgba.size() == bytes;
}

base::Result<Picture> read_picture(const fs::path& file) {
  ArrayWriter details;
  details.number<std::int64_t>(16384);  // nothing is halved: the size of a pixel is given
  const AssetReader::Question question{AssetKind::image, file.string(), "image", details.bytes()};
  const auto answer = AssetReader::mine().ask(question);
  auto picture = AssetReader::decoded<Picture>(question, answer, take_picture);
  if (picture && std::max(picture->width, picture->height) > max_plan_pixels)
    return base::Error{fmt::format("image {} is larger than {} pixels a side", file.string(), max_plan_pixels)};
  return picture;
}

std::vector<bool> dark_pixels(const Picture& picture, double threshold) {
  std::vector<bool> out(picture.rgba.size() / 4);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const std::uint8_t* p = &picture.rgba[4 * i];
    out[i] = p[3] >= 128 && 0.299 * p[0] + 0.587 * p[1] + 0.114 * p[2] < 255 * threshold;
  }
  return out;
}

// How large a pixel is, and the walls on them [m].
struct Plan {
  double pixel_x = 0, pixel_y = 0, height = 1;
};

// The element's number; nothing, with a line, if it is there and is not positive.
std::optional<double> positive_element(pugi::xml_node include, const char* name, double fallback, Complaints& complaints) {
  if (!include.child(name)) return fallback;
  const auto value = number_at(include, name);
  if (value && *value > 0) return value;
  complaints.drop(include, fmt::format("<{}> of floor plan {} must be a positive number, got {}; the floor plan is left out", name,
                                       base::in_quotes(text_of(include.child("uri"))), base::in_quotes(text_of(include.child(name)))));
  return std::nullopt;
}

std::optional<Plan> plan_of(pugi::xml_node include, const Picture& picture, Complaints& complaints) {
  const auto resolution = positive_element(include, "resolution", 0, complaints),
             height = positive_element(include, "height", 1, complaints);
  if (!resolution || !height) return std::nullopt;
  Plan plan{*resolution, *resolution, *height};
  if (*resolution > 0) return plan;
  const auto size = parse_numbers(text_of(include.child("size")));
  if (size && size->size() >= 2 && (*size)[0] > 0 && (*size)[1] > 0) {
    plan.pixel_x = (*size)[0] / static_cast<double>(picture.width);
    plan.pixel_y = (*size)[1] / static_cast<double>(picture.height);
    return plan;
  }
  complaints.drop(include, "floor plan " + base::in_quotes(text_of(include.child("uri"))) +
                               " is left out: <resolution> (size of a pixel) or <size> (x y of the picture) is expected, in metres");
  return std::nullopt;
}

void add_box(pugi::xml_node link, const std::string& name, const std::string& pose, const std::string& size) {
  for (const char* kind : {"collision", "visual"}) {
    pugi::xml_node shape = link.append_child(kind);
    shape.append_attribute("name") = name.c_str();
    shape.append_child("pose").text() = pose.c_str();
    shape.append_child("geometry").append_child("box").append_child("size").text() = size.c_str();
  }
  link.last_child().append_child("material").append_child("diffuse").text() = "0.62 0.58 0.52 1";
}

pugi::xml_node add_model(pugi::xml_node include, const Picture& picture, const Plan& plan, const std::vector<PixelBox>& boxes) {
  pugi::xml_node model = include.parent().insert_child_before("model", include);
  const std::string name = text_of(include.child("name"));
  model.append_attribute("name") = name.empty() ? fs::path(text_of(include.child("uri"))).stem().c_str() : name.c_str();
  model.append_copy(include.attribute(line_mark));
  model.append_child("static").text() = "true";
  if (include.child("pose")) model.append_copy(include.child("pose"));
  pugi::xml_node link = model.append_child("link");
  link.append_attribute("name") = "walls";
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const PixelBox& box = boxes[i];
    const double x = (box.x + 0.5 * box.width - 0.5 * static_cast<double>(picture.width)) * plan.pixel_x;
    const double y = (0.5 * static_cast<double>(picture.height) - box.y - 0.5 * box.height) * plan.pixel_y;
    add_box(link, fmt::format("wall_{}", i), fmt::format("{:.9g} {:.9g} {:.9g} 0 0 0", x, y, 0.5 * plan.height),
            fmt::format("{:.9g} {:.9g} {:.9g}", box.width * plan.pixel_x, box.height * plan.pixel_y, plan.height));
  }
  return model;
}

void insert_one(pugi::xml_node include, const fs::path& folder, const ModelPath& model_path, Complaints& complaints) {
  const std::string uri = text_of(include.child("uri")), words = "floor plan " + base::in_quotes(uri);
  const auto file = model_path.find(uri, folder);
  if (!file) return complaints.drop(include, words + " is not found and is left out");
  const auto picture = read_picture(*file);
  if (!picture) return complaints.drop(include, words + " is left out: " + picture.error().message);
  const auto plan = plan_of(include, *picture, complaints);
  const auto threshold = positive_element(include, "threshold", 0.5, complaints);
  if (!plan || !threshold) return;
  const auto boxes = boxes_of(dark_pixels(*picture, *threshold), static_cast<int>(picture->width), static_cast<int>(picture->height));
  if (boxes.empty()) return complaints.drop(include, words + " has no dark pixel and is left out");
  if (boxes.size() > max_walls)
    return complaints.drop(include, fmt::format("{} is left out: it has {} walls, expected at most {}; a lower <threshold> or a picture "
                                                "without noise has fewer",
                                                words, boxes.size(), max_walls));
  add_model(include, *picture, *plan, boxes);
}

}  // namespace

bool is_floor_plan(std::string_view uri) {
  static constexpr std::array<std::string_view, 4> ends{".png", ".jpg", ".jpeg", ".pgm"};
  const std::string name = base::to_lower(uri);
  return std::any_of(ends.begin(), ends.end(), [&](std::string_view end) { return name.ends_with(end); });
}

std::vector<PixelBox> boxes_of(const std::vector<bool>& is_dark, int width, int height) {
  std::vector<bool> left = is_dark;
  const auto at = [&](int x, int y) { return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x); };
  const auto is_row_left = [&](int x, int y, int count) {
    for (int i = 0; i < count; ++i) {
      if (!left[at(x + i, y)]) return false;
    }
    return true;
  };
  std::vector<PixelBox> out;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (!left[at(x, y)]) continue;
      PixelBox box{x, y, 1, 1};
      while (x + box.width < width && left[at(x + box.width, y)]) ++box.width;
      while (y + box.height < height && is_row_left(x, y + box.height, box.width)) ++box.height;
      for (int row = 0; row < box.height; ++row) {
        for (int i = 0; i < box.width; ++i) left[at(x + i, y + row)] = false;
      }
      out.push_back(box);
    }
  }
  return out;
}

void insert_floor_plans(pugi::xml_node entity, const fs::path& folder, const ModelPath& model_path, Complaints& complaints) {
  for (pugi::xml_node child = entity.first_child(), next; child; child = next) {
    next = child.next_sibling();
    const std::string_view kind = child.name();
    if (kind == "model") insert_floor_plans(child, folder, model_path, complaints);
    if (kind != "include" || !is_floor_plan(text_of(child.child("uri")))) continue;
    insert_one(child, folder, model_path, complaints);
    entity.remove_child(child);
  }
}

}  // namespace sim
