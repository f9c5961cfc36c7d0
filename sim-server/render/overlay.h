// Overlays of a screenshot: scans of range finders as fans, trails, names. Values; any thread.
#pragma once

#include <Eigen/Geometry>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "world/world_def.h"

namespace sim {

struct Overlay {
  // The area that a scan has found free: from the origin to each point in turn, the border brighter.
  struct Fan {
    Eigen::Vector3d origin{0, 0, 0};      // in the world
    std::vector<Eigen::Vector3d> points;  // in the world, in the order of the beams
    Color color{0.2F, 0.4F, 1, 1};
  };
  struct Trail {
    std::vector<Eigen::Vector3d> points;  // in the world
    Color color{1, 1, 1, 1};
    double width = 2.5;  // [pixel]
  };
  // The name of a thing. It is beside the thing, with a thin line to it, and off other labelled things and names if there is room.
  struct Label {
    Eigen::Vector3d at{0, 0, 0};  // middle of the thing, in the world
    double radius = 0;            // round `at`: the text keeps off it [m]
    std::string text;
    Color color{1, 1, 1, 1};
    double size = 14;  // height of a capital letter [pixel]
  };
  std::vector<Fan> fans;
  std::vector<Trail> trails;
  std::vector<Label> labels;
  std::string notice;              // one line at the lower edge, as large as fits
  bool is_notice_central = false;  // in the middle instead, where nothing else is to be seen
};

// The colour of the i-th scanner or robot of a picture: blue, green, orange, ...
Color overlay_color(std::size_t index);

// One corner of the triangles that an overlay is drawn with.
struct OverlayVertex {
  float position[3];
  float color[4];  // sRGB, opacity
};

struct View;

// Triangles in world axes relative to the camera: fans and trails. `pixel_scale`: pixels drawn per pixel that sizes speak of.
std::vector<OverlayVertex> overlay_triangles(const Overlay& overlay, const View& view, double pixel_scale);
// Triangles in [-1, 1] of the picture, y down: the names and their lines, with a dark rim. Names behind the camera are left out.
std::vector<OverlayVertex> label_triangles(const Overlay& overlay, const View& view, double pixel_scale);

// Where a label is drawn [pixels of the picture, y down].
struct LabelPlace {
  std::size_t label = 0;               // index
  Eigen::AlignedBox2d text;            // what the letters cover
  Eigen::Vector2d line_from, line_to;  // from the edge of the thing to the text
};
std::vector<LabelPlace> label_places(const Overlay& overlay, const View& view, double pixel_scale);

// The strokes of a character: polylines in a cell 4 wide and 6 high, y up from the base line. Unknown ones are a box.
std::vector<std::vector<Eigen::Vector2d>> glyph_strokes(char character);

}  // namespace sim
