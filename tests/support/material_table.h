// Visuals on a table under even light, from the SDF text to the pixel, and pictures to lay on them.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "support/studio.h"
#include "support/world_files.h"

namespace sim::test {

using Colors = std::vector<std::array<int, 3>>;

// Pictures of n x n pixels, each a colour and an opacity.
using Pixel = std::array<std::uint8_t, 4>;
inline std::string write_picture(const WorldFiles& files, const std::string& name, int side, const std::function<Pixel(int, int)>& color) {
  Image image{side, side, {}};
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x)
      for (const auto c : color(x, y)) image.rgba.push_back(c);
  const auto file = files.folder() / name;
  std::filesystem::create_directories(file.parent_path());
  EXPECT_TRUE(write_png(image, file).ok());
  return file.string();
}
// Visuals side by side along y on the ground, one metre apart, seen from above in a light under which they have their own colours.
struct Table {
  LoadResult loaded;
  std::unique_ptr<Studio> studio;
  std::vector<std::string> complaints;
  int count = 0;

  Table(const WorldFiles& files, const std::vector<std::string>& visuals) : count(static_cast<int>(visuals.size())) {
    std::string text;
    for (std::size_t i = 0; i < visuals.size(); ++i)
      text += "<model name='m" + std::to_string(i) + "'><static>true</static><pose>0 " + std::to_string(-static_cast<int>(i)) +
              " 0 0 0 0</pose><link name='l'><visual name='v'>" + visuals[i] + "</visual></link></model>\n";
    loaded = files.load(text);
    WorldDef& world = loaded.world;
    // What faces up receives 0.8 * 1.25 = 1.
    const auto level = static_cast<float>(encode(0.8));
    world.scene = SceneDef{};
    world.scene.ambient = {level, level, level, 1};
    world.scene.background = {0, 0, 0, 1};
    world.scene.grid = false;
    world.lights.clear();
    studio = std::make_unique<Studio>(world);
    complaints = studio->assets.take_complaints();
  }
  // 40 pixels a metre; the first visual in the middle of the first metre from the left.
  Image picture() {
    View view;
    view.is_parallel = true;
    view.pose = at(0, 0, 20);
    view.pose.linear() << Eigen::Vector3d(0, 0, -1), Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(1, 0, 0);
    view.left = -0.5, view.right = count - 0.5, view.bottom = -0.5, view.top = 0.5;
    view.width = 40 * count, view.height = 40;
    return studio->picture(view);
  }
  Colors colors() {
    const Image image = picture();
    Colors out;
    for (int i = 0; i < count; ++i) out.push_back(pixel(image, 40 * i + 20, 20));
    return out;
  }
};

inline std::string plate(const std::string& material) {
  return "<geometry><box><size>0.9 0.9 0.1</size></box></geometry>" + (material.empty() ? "" : "<material>" + material + "</material>");
}
inline std::string script(const std::string& uri, const std::string& name) {
  return "<script><uri>" + uri + "</uri><name>" + name + "</name></script>";
}

}  // namespace sim::test
