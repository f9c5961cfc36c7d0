// Walls from a picture: <include> of a PNG, JPEG or PGM file becomes a static model of boxes, one for each rectangle of dark pixels. The
// picture is read by the asset reader. Any thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <pugixml.hpp>
#include <string_view>
#include <vector>

#include "world/complaints.h"
#include "world/model_path.h"

namespace sim {

// Whether a file name is that of a picture that can be a floor plan.
bool is_floor_plan(std::string_view uri);

// Rectangles of pixels; together they cover the dark ones, each once. Row 0 is the upper one.
struct PixelBox {
  int x = 0, y = 0, width = 0, height = 0;
  bool operator==(const PixelBox&) const = default;
};
std::vector<PixelBox> boxes_of(const std::vector<bool>& is_dark, int width, int height);

// Puts a static model in the place of each <include> of a picture below `entity`. Its elements:
//   uri         the file
//   resolution  size of a pixel [m], or
//   size        of the whole picture, x y [m]; its middle is at the pose
//   height      of the walls [m] (1); they begin at the pose
//   threshold   brightness below which a pixel is a wall, 0 to 1 (0.5); transparent pixels are none
// and <name> and <pose> as of any include. What cannot be used gets one line and is left out.
void insert_floor_plans(pugi::xml_node entity, const std::filesystem::path& folder, const ModelPath& model_path, Complaints& complaints);

}  // namespace sim
