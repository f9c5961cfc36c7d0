// Materials as worlds write them, from the SDF text to the pixel: scripts, built-in colours, maps, mesh files, what is missing or broken.
#include <gtest/gtest.h>

#include <functional>

#include "render/camera.h"
#include "support/material_table.h"

namespace sim {
namespace {

using namespace test;

// 16 x 16 pixels of one colour, 200 90 40, as a JPEG file.
constexpr const char* flat_jpeg =
    "/9j/4AAQSkZJRgABAQAAAQABAAD/2wBDAAMCAgMCAgMDAwMEAwMEBQgFBQQEBQoHBwYIDAoMDAsKCwsNDhIQDQ4RDgsLEBYQERMUFRUVDA8XGB"
    "YUGBIUFRT/2wBDAQMEBAUEBQkFBQkUDQsNFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBT/wAARCAAQ"
    "ABADAREAAhEBAxEB/8QAHwAAAQUBAQEBAQEAAAAAAAAAAAECAwQFBgcICQoL/8QAtRAAAgEDAwIEAwUFBAQAAAF9AQIDAAQRBRIhMUEGE1FhBy"
    "JxFDKBkaEII0KxwRVS0fAkM2JyggkKFhcYGRolJicoKSo0NTY3ODk6Q0RFRkdISUpTVFVWV1hZWmNkZWZnaGlqc3R1dnd4eXqDhIWGh4iJipKT"
    "lJWWl5iZmqKjpKWmp6ipqrKztLW2t7i5usLDxMXGx8jJytLT1NXW19jZ2uHi4+Tl5ufo6erx8vP09fb3+Pn6/8QAHwEAAwEBAQEBAQEBAQAAAA"
    "AAAAECAwQFBgcICQoL/8QAtREAAgECBAQDBAcFBAQAAQJ3AAECAxEEBSExBhJBUQdhcRMiMoEIFEKRobHBCSMzUvAVYnLRChYkNOEl8RcYGRom"
    "JygpKjU2Nzg5OkNERUZHSElKU1RVVldYWVpjZGVmZ2hpanN0dXZ3eHl6goOEhYaHiImKkpOUlZaXmJmaoqOkpaanqKmqsrO0tba3uLm6wsPExc"
    "bHyMnK0tPU1dbX2Nna4uPk5ebn6Onq8vP09fb3+Pn6/9oADAMBAAIRAxEAPwDCr8KP6dCgAoAKAP/Z";

std::string from_base64(std::string_view text) {
  static constexpr std::string_view letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  unsigned bits = 0;
  int count = 0;
  for (const char c : text) {
    const auto value = letters.find(c);
    if (value == std::string_view::npos) continue;
    bits = bits << 6 | static_cast<unsigned>(value);
    count += 6;
    if (count >= 8) out += static_cast<char>(bits >> (count -= 8) & 0xff);
  }
  return out;
}

// Red, green / blue, white.
Pixel quarters(int x, int y, int side) {
  if (y < side / 2) return x < side / 2 ? Pixel{200, 40, 40, 255} : Pixel{40, 180, 40, 255};
  return x < side / 2 ? Pixel{40, 60, 200, 255} : Pixel{240, 240, 240, 255};
}

TEST(RenderMaterial, built_in_colours_are_known_and_unknown_ones_are_grey) {
  WorldFiles files;
  const std::string uri = "file://media/materials/scripts/gazebo.material";
  Table table(files, {plate(script(uri, "Gazebo/Red")), plate(script(uri, "Gazebo/Orange")), plate(script(uri, "Gazebo/FlatBlack")),
                      plate(script(uri, "Gazebo/NoSuchColour")), plate("")});
  const Colors colors = table.colors();
  EXPECT_TRUE(is_bytes(colors[0], {255, 0, 0}));
  EXPECT_TRUE(is_bytes(colors[1], {255, 130, 15}));
  EXPECT_TRUE(is_bytes(colors[2], {25, 25, 25}));
  EXPECT_TRUE(is_bytes(colors[3], {178, 178, 178}));
  EXPECT_TRUE(is_bytes(colors[4], {178, 178, 178}));
  EXPECT_NE(all_findings(table.loaded).find("\"Gazebo/NoSuchColour\" is not known"), std::string::npos);
}

TEST(RenderMaterial, scripts_give_colours_textures_scales_and_parents) {
  WorldFiles files;
  write_picture(files, "textures/quarters.png", 32, [](int x, int y) { return quarters(x, y, 32); });
  const auto uri = files.write("scripts/a.material", R"(
material Base
{
  technique
  {
    pass
    {
      diffuse 1 1 1 1
      texture_unit
      {
        texture quarters.png
      }
    }
    pass
    {
      diffuse 0 0 0 1
    }
  }
}
material Small : Base { technique { pass { texture_unit {
 texture quarters.png
 scale 0.5 0.5
 } } } }
material Tinted : Base { technique { pass { diffuse 0.5 1 1 1
 } } }
material Plain { technique { pass { ambient 0.1 0.1 0.1 1
 diffuse 0.2 0.4 0.8 1
 } } }
material Unlit { technique { pass { lighting off
 diffuse 0.9 0.1 0.5
 } } }
)");
  Table table(files, {plate(script(uri, "Base")), plate(script(uri, "Small")), plate(script(uri, "Tinted")), plate(script(uri, "Plain")),
                      plate(script(uri, "Unlit"))});
  EXPECT_EQ(all_findings(table.loaded), "");
  EXPECT_TRUE(table.complaints.empty());
  const Image image = table.picture();
  const auto quarter = [&](int i, int right, int down) { return pixel(image, 40 * i + 10 + 20 * right, 10 + 20 * down); };
  std::vector<std::array<int, 3>> seen;
  for (int i = 0; i < 4; ++i) seen.push_back(quarter(0, i & 1, i >> 1));
  for (const auto& wanted : {Pixel{200, 40, 40, 0}, Pixel{40, 180, 40, 0}, Pixel{40, 60, 200, 0}, Pixel{240, 240, 240, 0}}) {
    const bool is_there = std::any_of(seen.begin(), seen.end(), [&](const auto& p) {
      return bool(is_bytes(p, {wanted[0], wanted[1], wanted[2]}));
    });
    EXPECT_TRUE(is_there) << int(wanted[0]) << ' ' << int(wanted[1]) << ' ' << int(wanted[2]);
  }
  // Twice as often: half a plate on the same colour.
  EXPECT_TRUE(is_bytes(pixel(image, 40 + 7, 7), pixel(image, 40 + 7 + 18, 7), 6));
  EXPECT_FALSE(is_bytes(pixel(image, 7, 7), pixel(image, 7 + 18, 7), 6));
  // The tint multiplies linear light.
  const auto white =
      *std::max_element(seen.begin(), seen.end(), [](const auto& a, const auto& b) { return a[0] + a[1] + a[2] < b[0] + b[1] + b[2]; });
  int tinted_white = 0;
  for (int i = 0; i < 4; ++i) {
    const auto p = quarter(2, i & 1, i >> 1);
    tinted_white +=
        bool(is_near(p, Eigen::Vector3d(decode(0.5) * decode(white[0] / 255.0), decode(white[1] / 255.0), decode(white[2] / 255.0)), 2));
  }
  EXPECT_EQ(tinted_white, 1);
  EXPECT_TRUE(is_bytes(quarter(3, 0, 0), {51, 102, 204}));
  EXPECT_TRUE(is_bytes(quarter(4, 0, 0), {230, 26, 128}));
}

TEST(RenderMaterial, holes_are_cut_out_and_alpha_lets_through) {
  WorldFiles files;
  write_picture(files, "leaf.png", 32, [](int x, int) { return x < 16 ? Pixel{60, 160, 50, 255} : Pixel{0, 0, 0, 0}; });
  const auto uri = files.write(
      "a.material",
      "material Leaf { technique { pass { alpha_rejection greater 128\n texture_unit { texture leaf.png\n } } } }\n"
      "material Glass { technique { pass { lighting off\n scene_blend alpha_blend\n depth_write off\n diffuse 1 0 0 0.5\n } } }");
  const std::string below = "</visual><visual name='w'><pose>0 0 -1 0 0 0</pose>" + plate("<diffuse>1 1 1 1</diffuse>");
  Table glass(files, {plate(script(uri, "Glass")) + below});
  EXPECT_TRUE(is_bytes(glass.colors()[0], {255, 128, 128}, 2));
  Table holes(files, {plate(script(uri, "Leaf"))});
  const Image image = holes.picture();
  int green = 0, hole = 0;
  for (int y = 5; y < 35; ++y)
    for (int x = 5; x < 35; ++x) {
      green += is_bytes(pixel(image, x, y), {60, 160, 50}, 3) ? 1 : 0;
      hole += pixel(image, x, y) == std::array<int, 3>{0, 0, 0} ? 1 : 0;
    }
  EXPECT_GT(green, 350);
  EXPECT_GT(hole, 350);
}

TEST(RenderMaterial, half_transparent_textures_are_mixed_with_what_is_behind) {
  WorldFiles files;
  write_picture(files, "glass.png", 8, [](int, int) { return Pixel{255, 0, 0, 102}; });
  const std::string below = "</visual><visual name='w'><pose>0 0 -1 0 0 0</pose>" + plate("<diffuse>1 1 1 1</diffuse>");
  Table table(files, {plate("<pbr><metal><albedo_map>glass.png</albedo_map><roughness>1</roughness></metal></pbr>") + below});
  EXPECT_TRUE(is_bytes(table.colors()[0], {255, 153, 153}, 2));
}

TEST(RenderMaterial, broken_scripts_cost_one_line_and_keep_the_rest) {
  WorldFiles files;
  const auto uri =
      files.write("bad.material",
                  "material Broken { technique { pass { diffuse x y z\n ambient 1\n texture_unit { scale 0 0\n texture\n } } } }\n"
                  "material Lost { technique { pass { texture_unit { texture nowhere.png\n } } } }\n"
                  "material Good { technique { pass { diffuse 0 1 1 1\n } } }\n}}}\nmaterial\nmaterial Open { technique { pass {");
  Table table(files, {plate(script(uri, "Broken")), plate(script(uri, "Good")), plate(script(uri, "Lost")), plate(script(uri, "Nowhere")),
                      plate(script("nosuch.material", "X"))});
  const Colors colors = table.colors();
  EXPECT_TRUE(is_bytes(colors[0], {255, 255, 255}));
  EXPECT_TRUE(is_bytes(colors[1], {0, 255, 255}));
  EXPECT_TRUE(is_bytes(colors[3], {178, 178, 178}));
  const std::string findings = all_findings(table.loaded);
  EXPECT_NE(findings.find("texture \"nowhere.png\" of material \"Lost\" is not found; a chequer stands in"), std::string::npos) << findings;
  EXPECT_NE(findings.find("\"Nowhere\" is not known"), std::string::npos);
  EXPECT_NE(findings.find("material script \"nosuch.material\" is not found"), std::string::npos);
  EXPECT_TRUE(table.complaints.empty());
}

TEST(RenderMaterial, missing_textures_and_meshes_are_told_once_and_stand_out) {
  WorldFiles files;
  Table table(files, {plate("<pbr><metal><albedo_map>nowhere.png</albedo_map></metal></pbr>"),
                      "<geometry><mesh><uri>nowhere.dae</uri></mesh></geometry>"});
  const std::string findings = all_findings(table.loaded);
  EXPECT_NE(findings.find("texture \"nowhere.png\" is not found; a chequer stands in"), std::string::npos) << findings;
  EXPECT_NE(findings.find("is not found; a stand-in is drawn"), std::string::npos) << findings;
  EXPECT_TRUE(table.complaints.empty());
  const Image image = table.picture();
  int magenta = 0, dark = 0;
  for (int x = 4; x < 36; ++x) magenta += pixel(image, x, 20)[0] > 200 && pixel(image, x, 20)[1] < 60, dark += pixel(image, x, 20)[0] < 60;
  EXPECT_GT(magenta, 8);
  EXPECT_GT(dark, 8);
  EXPECT_TRUE(is_bytes(pixel(image, 60, 20), {255, 0, 255}));
}

TEST(RenderMaterial, pbr_maps_and_jpeg_files_are_used) {
  WorldFiles files;
  files.write("flat.jpg", from_base64(flat_jpeg));
  const auto glow = write_picture(files, "glow.png", 8, [](int, int) { return Pixel{0, 188, 0, 255}; });
  Table table(
      files,
      {plate("<pbr><metal><albedo_map>flat.jpg</albedo_map><roughness>1</roughness></metal></pbr>"),
       plate("<diffuse>0 0 0 1</diffuse><emissive>0.5 0.25 0 1</emissive>"),
       plate("<diffuse>0.5 0 0 1</diffuse><pbr><metal><emissive_map>" + glow + "</emissive_map></metal></pbr>"),
       plate("<diffuse>0 0 0 1</diffuse><emissive>1 0.5 1 1</emissive><pbr><metal><emissive_map>glow.png</emissive_map></metal></pbr>")});
  EXPECT_EQ(all_findings(table.loaded), "");
  EXPECT_TRUE(table.complaints.empty());
  const Colors colors = table.colors();
  EXPECT_TRUE(is_bytes(colors[0], {200, 90, 40}, 3));
  EXPECT_TRUE(is_bytes(colors[1], {128, 64, 0}));
  EXPECT_TRUE(is_bytes(colors[2], {128, 188, 0}, 2));
  EXPECT_TRUE(is_near(colors[3], Eigen::Vector3d(0, decode(0.5) * decode(188 / 255.0), 0), 2));
}

TEST(RenderMaterial, metal_shines_in_its_own_colour_and_rough_things_little) {
  WorldFiles files;
  const auto ball = [](const std::string& pbr) {
    return "<geometry><sphere><radius>0.45</radius></sphere></geometry><material><diffuse>0.9 0.6 0.1 1</diffuse><pbr><metal>" + pbr +
           "</metal></pbr></material>";
  };
  Table table(files,
              {ball("<metalness>1</metalness><roughness>0.3</roughness>"), ball("<metalness>0</metalness><roughness>0.3</roughness>"),
               ball("<metalness>0</metalness><roughness>1</roughness>")});
  WorldDef world = table.loaded.world;
  world.scene.ambient = {0, 0, 0, 1};
  world.lights.push_back(sun({0, 0, -1}, {0.4F, 0.4F, 0.4F, 1}, false));
  world.lights.back().specular = {1, 1, 1, 1};
  table.studio = std::make_unique<Studio>(world);
  const Image image = table.picture();
  const auto spread = [&](int i) { return pixel(image, 40 * i + 20, 20)[2] - pixel(image, 40 * i + 30, 20)[2]; };
  EXPECT_GT(spread(1), spread(2) + 10) << "the smooth one has a highlight";
  // The metal reflects yellow: blue stays behind red.
  EXPECT_GT(pixel(image, 20, 20)[0], pixel(image, 20, 20)[2] + 60);
}

TEST(RenderMaterial, normal_maps_tilt_the_light) {
  WorldFiles files;
  // A slope along u by 30 degrees; along the other half the other way.
  const auto tilted = [](double along_u, double along_v) {
    const double z = std::sqrt(1 - along_u * along_u - along_v * along_v);
    const auto byte = [](double c) { return static_cast<std::uint8_t>(std::lround(127.5 + 127.5 * c)); };
    return Pixel{byte(along_u), byte(along_v), byte(z), 255};
  };
  write_picture(files, "u.png", 8, [&](int, int) { return tilted(0.5, 0); });
  write_picture(files, "v.png", 8, [&](int, int) { return tilted(0, 0.5); });
  write_picture(files, "flat.png", 8, [&](int, int) { return tilted(0, 0); });
  const auto map = [&](const char* name) {
    return plate(std::string("<diffuse>1 1 1 1</diffuse><pbr><metal><roughness>1</roughness><normal_map>") + name +
                 "</normal_map></metal></pbr>");
  };
  Table table(files, {map("u.png"), map("v.png"), map("flat.png"),
                      plate("<diffuse>1 1 1 1</diffuse><pbr><metal><roughness>1</roughness></metal></pbr>")});
  EXPECT_EQ(all_findings(table.loaded), "");
  const auto lit_from = [&](const Eigen::Vector3d& direction) {
    WorldDef world = table.loaded.world;
    world.scene.ambient = {0, 0, 0, 1};
    world.lights.push_back(sun(direction, {0.5F, 0.5F, 0.5F, 1}, false));
    world.lights.back().specular = {0, 0, 0, 1};
    table.studio = std::make_unique<Studio>(world);
    return table.colors();
  };
  // The top of a box has u along x, and the map's second component points up the image: against v, along y.
  const Eigen::Vector3d along_x = Eigen::Vector3d(-0.5, 0, -1).normalized(), along_y = Eigen::Vector3d(0, -0.5, -1).normalized();
  const Colors x = lit_from(along_x), y = lit_from(along_y);
  const auto expected = [](const Eigen::Vector3d& n, const Eigen::Vector3d& l) {
    const double light = 0.5 * std::max(0.0, -n.dot(l));
    return Eigen::Vector3d(light, light, light);
  };
  const double z = std::sqrt(0.75);
  EXPECT_TRUE(is_near(x[0], expected({0.5, 0, z}, along_x), 2));
  EXPECT_TRUE(is_near(y[0], expected({0.5, 0, z}, along_y), 2));
  EXPECT_TRUE(is_near(x[1], expected({0, 0.5, z}, along_x), 2));
  EXPECT_TRUE(is_near(y[1], expected({0, 0.5, z}, along_y), 2));
  EXPECT_TRUE(is_near(x[2], expected({0, 0, 1}, along_x), 2));
  EXPECT_TRUE(is_near(x[3], expected({0, 0, 1}, along_x), 1));
}

TEST(RenderMaterial, height_maps_have_their_layers_by_height) {
  WorldFiles files;
  write_picture(files, "height.png", 17, [](int x, int) {
    return Pixel{static_cast<std::uint8_t>(x * 255 / 16), static_cast<std::uint8_t>(x * 255 / 16), static_cast<std::uint8_t>(x * 255 / 16),
                 255};
  });
  write_picture(files, "low.png", 8, [](int, int) { return Pixel{40, 160, 40, 255}; });
  write_picture(files, "high.png", 8, [](int, int) { return Pixel{240, 240, 250, 255}; });
  const std::string layer = "</diffuse><normal>low.png</normal><size>1</size></texture>";
  Table table(files, {"<geometry><heightmap><uri>height.png</uri><size>0.9 0.9 0.02</size><pos>0 0 0</pos><texture><diffuse>low.png" +
                      layer + "<texture><diffuse>high.png" + layer +
                      "<blend><min_height>0.009</min_height><fade_dist>0.002</fade_dist></blend></heightmap></geometry>"});
  EXPECT_TRUE(table.complaints.empty());
  const Image image = table.picture();
  // u runs along x, which is up in the picture.
  EXPECT_TRUE(is_bytes(pixel(image, 20, 34), {40, 160, 40}, 4));
  EXPECT_TRUE(is_bytes(pixel(image, 20, 5), {240, 240, 250}, 4));
}

TEST(RenderMaterial, collada_files_bring_their_materials) {
  WorldFiles files;
  write_picture(files, "meshes/q.png", 32, [](int x, int y) { return quarters(x, y, 32); });
  const auto source = [](const std::string& id, const std::string& numbers, int count, int stride, const std::string& names) {
    std::string params;
    for (const char c : names) params += std::string("<param name='") + c + "' type='float'/>";
    return "<source id='" + id + "'><float_array id='" + id + "a' count='" + std::to_string(count * stride) + "'>" + numbers +
           "</float_array><technique_common><accessor source='#" + id + "a' count='" + std::to_string(count) + "' stride='" +
           std::to_string(stride) + "'>" + params + "</accessor></technique_common></source>";
  };
  files.write(
      "meshes/two.dae",
      "<?xml version='1.0'?><COLLADA xmlns='http://www.collada.org/2005/11/COLLADASchema' version='1.4.1'>"
      "<asset><unit name='meter' meter='1'/><up_axis>Z_UP</up_axis></asset>"
      "<library_images><image id='i'><init_from>q.png</init_from></image></library_images><library_effects>"
      "<effect id='e1'><profile_COMMON><newparam sid='s'><surface type='2D'><init_from>i</init_from></surface></newparam>"
      "<newparam sid='t'><sampler2D><source>s</source></sampler2D></newparam><technique sid='c'><lambert><diffuse>"
      "<texture texture='t' texcoord='UV'/></diffuse></lambert></technique></profile_COMMON></effect>"
      "<effect id='e2'><profile_COMMON><technique sid='c'><lambert><diffuse><color>0.8 0.2 0.1 1</color></diffuse></lambert>"
      "</technique></profile_COMMON></effect></library_effects>"
      "<library_materials><material id='m1'><instance_effect url='#e1'/></material><material id='m2'><instance_effect url='#e2'/>"
      "</material></library_materials><library_geometries><geometry id='g'><mesh>" +
          source("p", "-0.4 -0.4 0 0.4 -0.4 0 0.4 0.4 0 -0.4 0.4 0 -0.4 0.6 0 0.4 0.6 0 0.4 1.4 0 -0.4 1.4 0", 8, 3, "XYZ") +
          source("n", "0 0 1", 1, 3, "XYZ") + source("u", "0 0 1 0 1 1 0 1", 4, 2, "ST") +
          "<vertices id='v'><input semantic='POSITION' source='#p'/></vertices>"
          "<triangles material='a' count='2'><input semantic='VERTEX' source='#v' offset='0'/><input semantic='NORMAL' source='#n' "
          "offset='1'/>"
          "<input semantic='TEXCOORD' source='#u' offset='2' set='0'/><p>0 0 0 1 0 1 2 0 2 0 0 0 2 0 2 3 0 3</p></triangles>"
          "<triangles material='b' count='2'><input semantic='VERTEX' source='#v' offset='0'/><input semantic='NORMAL' source='#n' "
          "offset='1'/>"
          "<p>4 0 5 0 6 0 4 0 6 0 7 0</p></triangles></mesh></geometry></library_geometries>"
          "<library_visual_scenes><visual_scene id='s'><node id='o'><instance_geometry url='#g'><bind_material><technique_common>"
          "<instance_material symbol='a' target='#m1'/><instance_material symbol='b' target='#m2'/></technique_common></bind_material>"
          "</instance_geometry></node></visual_scene></library_visual_scenes><scene><instance_visual_scene url='#s'/></scene></COLLADA>");
  // The mesh is two metres long in y: it lies on the second place and on the first.
  Table table(files, {"<geometry><box><size>0.01 0.01 0.01</size></box></geometry>",
                      "<geometry><mesh><uri>meshes/two.dae</uri></mesh></geometry>"});
  EXPECT_TRUE(table.complaints.empty()) << table.complaints.front();
  const Image image = table.picture();
  EXPECT_TRUE(is_bytes(pixel(image, 20, 12), {204, 51, 26}));
  // u along x (up in the picture), v along y (to the left); images begin at the top of v.
  EXPECT_TRUE(is_bytes(pixel(image, 70, 30), {40, 60, 200}, 2));
  EXPECT_TRUE(is_bytes(pixel(image, 50, 30), {200, 40, 40}, 2));
  EXPECT_TRUE(is_bytes(pixel(image, 50, 10), {40, 180, 40}, 2));
  EXPECT_TRUE(is_bytes(pixel(image, 70, 10), {240, 240, 240}, 2));
}

TEST(RenderMaterial, broken_meshes_are_told_and_the_usable_triangles_are_drawn) {
  WorldFiles files;
  const std::string corners = "v -0.4 -0.4 0\nv 0.4 -0.4 0\nv 0.4 0.4 0\nv -0.4 0.4 0\n";
  // Triangles without area beside two good ones: no normals in the file, so they are made.
  files.write("some.obj", corners + "f 1 1 2\nf 3 3 3\nf 1 2 3\nf 1 3 4\nf 2 2 3\n");
  files.write("none.obj", "v 0 0 0\nv 0 0 0\nv 0 0 0\nf 1 2 3\n");
  files.write("lines.obj", "v 0 0 0\nv 1 1 1\nl 1 2\n");
  files.write("garbage.dae", "<COLLADA><<<");
  files.write("empty.stl", "");
  const auto mesh = [](const char* name) { return std::string("<geometry><mesh><uri>") + name + "</uri></mesh></geometry>"; };
  Table table(files, {mesh("some.obj") + "<material><diffuse>0.2 0.6 0.4 1</diffuse></material>", mesh("none.obj"), mesh("lines.obj"),
                      mesh("garbage.dae"), mesh("empty.stl")});
  EXPECT_EQ(table.complaints.size(), 4U);
  const Colors colors = table.colors();
  EXPECT_TRUE(is_bytes(colors[0], {51, 153, 102}));
  for (std::size_t i = 1; i < 5; ++i) EXPECT_TRUE(is_bytes(colors[i], {255, 0, 255})) << i;
}

TEST(RenderMaterial, negative_scales_mirror_and_keep_the_outside_out) {
  WorldFiles files;
  // A corner with a long arm along +x and a short one along +y.
  files.write("arm.obj", "v 0 0 0\nv 0.4 0 0\nv 0 0.2 0\nv 0 0 0.3\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
  const auto mesh = [](const std::string& scale) {
    return "<geometry><mesh><uri>arm.obj</uri><scale>" + scale +
           "</scale></mesh></geometry><material><diffuse>1 1 1 1</diffuse></material>";
  };
  Table table(files, {mesh("1 1 1"), mesh("-1 1 1"), mesh("1 -1 1"), mesh("-1 -1 1")});
  const Image image = table.picture();
  // Where the long arm lies: up (+x) or down, and the short one left (+y) or right.
  for (int i = 0; i < 4; ++i) {
    const int up = (i & 1) != 0 ? 1 : -1, side = (i & 2) != 0 ? 1 : -1;
    const auto on = pixel(image, 40 * i + 20 + 2 * side, 20 + 8 * up), off = pixel(image, 40 * i + 20 - 2 * side, 20 - 8 * up);
    EXPECT_GT(on[0], 150) << i;  // lit from above: it is the outside that shows
    EXPECT_EQ(off[0], 0) << i;
  }
}

}  // namespace
}  // namespace sim
