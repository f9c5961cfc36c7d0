// Fans, trails and names as triangles.
#include "render/overlay.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "render/renderer.h"

namespace sim {
namespace {

// Strokes of the printable ASCII characters from ' ' on: pairs of digits x y, blanks between strokes' points, '/' between strokes.
constexpr std::array<std::string_view, 95> glyphs = {
    "",                                                 // space
    "26 22/20 20",                                      // !
    "16 14/36 34",                                      // "
    "10 16/30 36/02 42/04 44",                          // #
    "45 36 16 05 04 13 33 42 41 30 10 01/27 2:",        // $
    "00 46/06 16 15 05 06/31 41 40 30 31",              // %
    "40 05 06 16 26 25 02 01 10 20 42",                 // &
    "26 24",                                            // '
    "36 25 21 30",                                      // (
    "16 25 21 10",                                      // )
    "25 21/04 42/02 44",                                // *
    "25 21/03 43",                                      // +
    "21 2: ",                                           // ,
    "13 33",                                            // -
    "20 20",                                            // .
    "00 46",                                            // /
    "10 01 05 16 36 45 41 30 10/01 45",                 // 0
    "15 26 20/10 30",                                   // 1
    "05 16 36 45 44 00 40",                             // 2
    "05 16 36 45 44 33 42 41 30 10 01/33 13",           // 3
    "30 36 02 42",                                      // 4
    "46 06 03 33 42 41 30 10 01",                       // 5
    "45 36 16 05 01 10 30 41 42 33 13 02",              // 6
    "06 46 20",                                         // 7
    "13 04 05 16 36 45 44 33 13 02 01 10 30 41 42 33",  // 8
    "01 10 30 41 45 36 16 05 04 13 33 44",              // 9
    "23 23/20 20",                                      // :
    "23 23/21 2:",                                      // ;
    "36 03 30",                                         // <
    "04 44/02 42",                                      // =
    "16 43 10",                                         // >
    "05 16 36 45 44 23 22/20 20",                       // ?
    "32 34 24 13 22 32 43 45 36 16 05 01 10 40",        // @
    "00 26 40/12 32",                                   // A
    "00 06 36 45 44 33 03/33 42 41 30 00",              // B
    "45 36 16 05 01 10 30 41",                          // C
    "00 06 26 44 42 20 00",                             // D
    "40 00 06 46/03 33",                                // E
    "00 06 46/03 33",                                   // F
    "45 36 16 05 01 10 30 41 43 23",                    // G
    "00 06/40 46/03 43",                                // H
    "10 30/16 36/20 26",                                // I
    "01 10 20 31 36",                                   // J
    "00 06/46 03 40",                                   // K
    "06 00 40",                                         // L
    "00 06 23 46 40",                                   // M
    "00 06 40 46",                                      // N
    "10 01 05 16 36 45 41 30 10",                       // O
    "00 06 36 45 44 33 03",                             // P
    "10 01 05 16 36 45 41 30 10/22 40",                 // Q
    "00 06 36 45 44 33 03/23 40",                       // R
    "45 36 16 05 04 13 33 42 41 30 10 01",              // S
    "06 46/26 20",                                      // T
    "06 01 10 30 41 46",                                // U
    "06 20 46",                                         // V
    "06 10 23 30 46",                                   // W
    "00 46/06 40",                                      // X
    "06 23 46/23 20",                                   // Y
    "06 46 00 40",                                      // Z
    "36 16 10 30",                                      // [
    "06 40",                                            // backslash
    "16 36 30 10",                                      // ]
    "14 26 34",                                         // ^
    "00 40",                                            // _
    "16 25",                                            // `
    "03 14 34 43 40/42 12 01 10 30 41",                 // a
    "06 00/03 14 34 43 41 30 10 01",                    // b
    "43 34 14 03 01 10 30 41",                          // c
    "46 40/43 34 14 03 01 10 30 41",                    // d
    "02 42 43 34 14 03 01 10 40",                       // e
    "46 36 25 20/14 34",                                // f
    "44 4; 3: 1:/43 34 14 03 01 10 30 41",              // g
    "06 00/03 14 34 43 40",                             // h
    "24 20/26 26",                                      // i
    "24 2; 1:/26 26",                                   // j
    "06 00/44 02/13 40",                                // k
    "26 21 30",                                         // l
    "00 04/03 14 23 20/23 34 43 40",                    // m
    "00 04/03 14 34 43 40",                             // n
    "10 01 03 14 34 43 41 30 10",                       // o
    "04 0:/03 14 34 43 41 30 10 01",                    // p
    "44 4:/43 34 14 03 01 10 30 41",                    // q
    "00 04/02 24 34",                                   // r
    "43 34 14 03 12 32 41 30 10 01",                    // s
    "26 21 30 40/14 34",                                // t
    "04 01 10 30 41/44 40",                             // u
    "04 20 44",                                         // v
    "04 10 23 30 44",                                   // w
    "00 44/04 40",                                      // x
    "04 20/44 1:",                                      // y
    "04 44 00 40",                                      // z
    "36 25 24 13 22 21 30",                             // {
    "26 20",                                            // |
    "16 25 24 33 22 21 10",                             // }
    "03 14 32 43",                                      // ~
};

// Digits are themselves, ':' is -2 and ';' is -1: below the base line.
double coordinate(char c) { return c == ':' ? -2 : c == ';' ? -1 : c - '0'; }

void set_color(OverlayVertex& vertex, const Color& color, float alpha) {
  vertex.color[0] = color.r;
  vertex.color[1] = color.g;
  vertex.color[2] = color.b;
  vertex.color[3] = alpha;
}

OverlayVertex at(const Eigen::Vector3d& p, const Color& color, double alpha) {
  OverlayVertex v{{static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())}, {}};
  set_color(v, color, static_cast<float>(alpha));
  return v;
}

// Metres that a pixel covers at a point relative to the camera.
double pixel_at(const View& view, const Eigen::Vector3d& p) {
  const double across = (view.right - view.left) / view.width;
  if (view.is_parallel) return across;
  return across * std::max(view.near_clip, p.dot(view.pose.linear().col(0)));
}

// A band round a line from a to b, `width` pixels wide, turned to the camera.
void add_band(std::vector<OverlayVertex>& out, const View& view, const Eigen::Vector3d& a, const Eigen::Vector3d& b, double width,
              const Color& color, double alpha) {
  const Eigen::Vector3d forward = view.pose.linear().col(0);
  const Eigen::Vector3d along = b - a;
  if (along.norm() < 1e-9) return;
  Eigen::Vector3d side_a = along.cross(view.is_parallel ? forward : Eigen::Vector3d(a));
  Eigen::Vector3d side_b = along.cross(view.is_parallel ? forward : Eigen::Vector3d(b));
  if (side_a.norm() < 1e-9 || side_b.norm() < 1e-9) return;
  side_a *= 0.5 * width * pixel_at(view, a) / side_a.norm();
  side_b *= 0.5 * width * pixel_at(view, b) / side_b.norm();
  // A little beyond the ends closes the gaps at corners.
  const Eigen::Vector3d reach_a = along.normalized() * side_a.norm() * 0.5;
  const Eigen::Vector3d reach_b = along.normalized() * side_b.norm() * 0.5;
  const auto v0 = at(a - reach_a - side_a, color, alpha), v1 = at(a - reach_a + side_a, color, alpha);
  const auto v2 = at(b + reach_b + side_b, color, alpha), v3 = at(b + reach_b - side_b, color, alpha);
  out.insert(out.end(), {v0, v1, v2, v0, v2, v3});
}

// In pixels of the picture, y down; empty behind the camera.
std::optional<Eigen::Vector2d> project(const View& view, const Eigen::Vector3d& world) {
  const Eigen::Vector3d p = view.pose.inverse() * world;
  if (!view.is_parallel && p.x() < view.near_clip) return std::nullopt;
  const double depth = view.is_parallel ? 1 : p.x();
  const double x = (-p.y() / depth - view.left) / (view.right - view.left);
  const double y = (view.top - p.z() / depth) / (view.top - view.bottom);
  return Eigen::Vector2d(x * view.width, y * view.height);
}

// Where a name is tried: above right first, as in maps [unit vectors in pixels, y down].
const std::array<Eigen::Vector2d, 4> label_sides = {Eigen::Vector2d{0.7071, -0.7071}, Eigen::Vector2d{-0.7071, -0.7071},
                                                    Eigen::Vector2d{0.7071, 0.7071}, Eigen::Vector2d{-0.7071, 0.7071}};

class LabelDrawer {
 public:
  LabelDrawer(const View& view, std::vector<OverlayVertex>& out) : view_(view), out_(out) {}

  void text(const std::string& text, Eigen::Vector2d base_left, double unit, double width, const Color& color, double alpha) {
    for (const char c : text) {
      for (const auto& stroke : glyph_strokes(c)) {
        for (std::size_t i = 0; i + 1 < stroke.size(); ++i)
          line(base_left + to_pixels(stroke[i], unit), base_left + to_pixels(stroke[i + 1], unit), width, color, alpha);
      }
      base_left.x() += 5.6 * unit;
    }
  }

  void line(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double width, const Color& color, double alpha) {
    Eigen::Vector2d along = b - a;
    along = along.norm() > 1e-9 ? Eigen::Vector2d(along.normalized()) : Eigen::Vector2d(1, 0);
    const Eigen::Vector2d side = Eigen::Vector2d(-along.y(), along.x()) * 0.5 * width;
    quad(a - side, a + side, b + side, b - side, color, alpha);
    cap(a, 0.5 * width, color, alpha);
    cap(b, 0.5 * width, color, alpha);
  }

 private:
  static Eigen::Vector2d to_pixels(const Eigen::Vector2d& p, double unit) { return {p.x() * unit, -p.y() * unit}; }

  void cap(const Eigen::Vector2d& p, double radius, const Color& color, double alpha) {
    constexpr int corners = 8;
    for (int i = 0; i < corners; ++i) {
      const double a = 2 * std::numbers::pi * i / corners, b = 2 * std::numbers::pi * (i + 1) / corners;
      vertex(p, color, alpha);
      vertex(p + radius * Eigen::Vector2d(std::cos(a), std::sin(a)), color, alpha);
      vertex(p + radius * Eigen::Vector2d(std::cos(b), std::sin(b)), color, alpha);
    }
  }
  void quad(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c, const Eigen::Vector2d& d, const Color& color,
            double alpha) {
    for (const auto* p : {&a, &b, &c, &a, &c, &d}) vertex(*p, color, alpha);
  }
  void vertex(const Eigen::Vector2d& p, const Color& color, double alpha) {
    out_.push_back(at({2 * p.x() / view_.width - 1, 2 * p.y() / view_.height - 1, 0}, color, alpha));
  }

  const View& view_;
  std::vector<OverlayVertex>& out_;
};

void add_notice(const Overlay& overlay, const View& view, double pixel_scale, LabelDrawer& drawer) {
  if (overlay.notice.empty()) return;
  const double cells = 5.6 * static_cast<double>(overlay.notice.size());
  const double unit = std::min((overlay.is_notice_central ? 18 : 12) * pixel_scale / 6, 0.94 * view.width / cells);
  const Eigen::Vector2d base(0.5 * (view.width - cells * unit), overlay.is_notice_central ? 0.5 * view.height : view.height - 5 * unit);
  drawer.text(overlay.notice, base, unit, 2.6 * unit, {0.05F, 0.05F, 0.08F, 1}, 1);
  drawer.text(overlay.notice, base, unit, 0.95 * unit, {1, 0.85F, 0.3F, 1}, 1);
}

}  // namespace

std::vector<std::vector<Eigen::Vector2d>> glyph_strokes(char character) {
  const int index = character - ' ';
  const std::string_view code =
      index >= 0 && index < static_cast<int>(glyphs.size()) ? glyphs[static_cast<std::size_t>(index)] : "00 06 46 40 00";
  std::vector<std::vector<Eigen::Vector2d>> strokes(1);
  for (std::size_t i = 0; i + 1 < code.size();) {
    if (code[i] == '/') {
      strokes.emplace_back();
      ++i;
    } else if (code[i] == ' ') {
      ++i;
    } else {
      strokes.back().emplace_back(coordinate(code[i]), coordinate(code[i + 1]));
      i += 2;
    }
  }
  return strokes;
}

Color overlay_color(std::size_t index) {
  static constexpr std::array<Color, 6> colors = {Color{0.16F, 0.42F, 1.0F, 1}, Color{0.15F, 0.8F, 0.25F, 1},
                                                  Color{1.0F, 0.55F, 0.1F, 1},  Color{0.75F, 0.3F, 0.95F, 1},
                                                  Color{0.1F, 0.8F, 0.85F, 1},  Color{0.95F, 0.25F, 0.35F, 1}};
  return colors[index % colors.size()];
}

std::vector<OverlayVertex> overlay_triangles(const Overlay& overlay, const View& view, double pixel_scale) {
  std::vector<OverlayVertex> out;
  const Eigen::Vector3d eye = view.pose.translation();
  for (const auto& fan : overlay.fans) {
    const Eigen::Vector3d origin = fan.origin - eye;
    for (std::size_t i = 0; i + 1 < fan.points.size(); ++i) {
      const Eigen::Vector3d a = fan.points[i] - eye, b = fan.points[i + 1] - eye;
      out.push_back(at(origin, fan.color, 0.34));
      out.push_back(at(a, fan.color, 0.20));
      out.push_back(at(b, fan.color, 0.20));
    }
    for (std::size_t i = 0; i + 1 < fan.points.size(); ++i) {
      // A step from one thing to another is no surface.
      const double step = (fan.points[i + 1] - fan.points[i]).norm();
      const double alpha = step < 0.5 ? 0.85 : 0.3;
      add_band(out, view, fan.points[i] - eye, fan.points[i + 1] - eye, 1.6 * pixel_scale, fan.color, alpha);
    }
    if (!fan.points.empty()) {
      add_band(out, view, origin, fan.points.front() - eye, 1.0 * pixel_scale, fan.color, 0.5);
      add_band(out, view, origin, fan.points.back() - eye, 1.0 * pixel_scale, fan.color, 0.5);
    }
  }
  for (const auto& trail : overlay.trails) {
    for (std::size_t i = 0; i + 1 < trail.points.size(); ++i) {
      const double age = 1 - static_cast<double>(i + 1) / static_cast<double>(trail.points.size());
      add_band(out, view, trail.points[i] - eye, trail.points[i + 1] - eye, trail.width * pixel_scale, trail.color, 0.95 - 0.6 * age);
    }
  }
  return out;
}

std::vector<LabelPlace> label_places(const Overlay& overlay, const View& view, double pixel_scale) {
  struct Named {
    std::size_t label;
    Eigen::Vector2d at;
    double radius;  // [pixel]
  };
  std::vector<Named> all;
  std::vector<Eigen::AlignedBox2d> taken;
  for (std::size_t i = 0; i < overlay.labels.size(); ++i) {
    const auto& label = overlay.labels[i];
    const auto at = project(view, label.at);
    if (!at) continue;
    const double radius = label.radius / pixel_at(view, label.at - view.pose.translation());
    all.push_back({i, *at, radius});
    taken.emplace_back(*at - Eigen::Vector2d::Constant(0.7 * radius), *at + Eigen::Vector2d::Constant(0.7 * radius));
  }
  const Eigen::AlignedBox2d picture(Eigen::Vector2d::Zero(), Eigen::Vector2d(view.width, view.height));
  std::vector<LabelPlace> out;
  for (const auto& named : all) {
    const auto& label = overlay.labels[named.label];
    const double unit = label.size * pixel_scale / 6;
    const Eigen::Vector2d size((5.6 * static_cast<double>(label.text.size()) - 1.6) * unit, 6 * unit);
    std::optional<LabelPlace> best;
    for (const Eigen::Vector2d& side : label_sides) {
      // A thing is seldom as wide everywhere as the circle round it.
      LabelPlace place{named.label, {}, named.at + side * 0.6 * named.radius, named.at + side * (named.radius + 2 * unit)};
      const Eigen::Vector2d corner = place.line_to + Eigen::Vector2d(side.x() > 0 ? unit : -size.x() - unit, -0.5 * size.y());
      place.text = {corner, corner + size};
      const bool is_inside = picture.contains(place.text);
      const bool is_free = std::none_of(taken.begin(), taken.end(), [&](const auto& box) { return box.intersects(place.text); });
      if (!best || (is_inside && !picture.contains(best->text))) best = place;
      if (!is_inside || !is_free) continue;
      best = place;
      break;
    }
    taken.push_back(best->text);
    out.push_back(*best);
  }
  return out;
}

std::vector<OverlayVertex> label_triangles(const Overlay& overlay, const View& view, double pixel_scale) {
  std::vector<OverlayVertex> out;
  LabelDrawer drawer(view, out);
  for (const auto& place : label_places(overlay, view, pixel_scale)) {
    const auto& label = overlay.labels[place.label];
    const double unit = label.size * pixel_scale / 6;
    const Eigen::Vector2d base(place.text.min().x(), place.text.max().y());
    const Color rim{0.05F, 0.05F, 0.08F, 1};
    drawer.line(place.line_from, place.line_to, 1.6 * unit, rim, 1);
    drawer.text(label.text, base, unit, 2.6 * unit, rim, 1);
    drawer.line(place.line_from, place.line_to, 0.6 * unit, label.color, 1);
    drawer.text(label.text, base, unit, 0.95 * unit, label.color, 1);
  }
  add_notice(overlay, view, pixel_scale, drawer);
  return out;
}

}  // namespace sim
