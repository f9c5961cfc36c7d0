// Mesh and picture files as exporters and Gazebo's own media have them: names of nodes, model://, images without a file, alpha that means
// nothing, light of their own, DirectDraw surfaces.
#include <gmock/gmock.h>

#include <cstring>

#include "asset-reader/dds.h"
#include "support/material_table.h"
#include "support/memory_limit.h"
#include "world/materials.h"

namespace sim {
namespace {

using namespace test;

struct Dae {
  std::string image = "<image id='i'><init_from>q.png</init_from></image>";
  std::string effect = "<diffuse><texture texture='t' texcoord='UV'/></diffuse>";  // of a lambert
};

// A square of 0.9 m of the node "Plate" (id "node1") and, 3 m further along y, one of the node "Other".
std::string dae(const Dae& with) {
  const auto source = [](const std::string& id, const std::string& numbers, int count, int stride, const std::string& names) {
    std::string params;
    for (const char c : names) params += std::string("<param name='") + c + "' type='float'/>";
    return "<source id='" + id + "'><float_array id='" + id + "a' count='" + std::to_string(count * stride) + "'>" + numbers +
           "</float_array><technique_common><accessor source='#" + id + "a' count='" + std::to_string(count) + "' stride='" +
           std::to_string(stride) + "'>" + params + "</accessor></technique_common></source>";
  };
  const std::string instance =
      "<instance_geometry url='#g'><bind_material><technique_common><instance_material symbol='a' "
      "target='#m'/></technique_common></bind_material></instance_geometry></node>";
  return "<?xml version='1.0'?><COLLADA xmlns='http://www.collada.org/2005/11/COLLADASchema' version='1.4.1'>"
         "<asset><unit name='meter' meter='1'/><up_axis>Z_UP</up_axis></asset><library_images>" +
         with.image +
         "</library_images><library_effects><effect id='e'><profile_COMMON>"
         "<newparam sid='s'><surface type='2D'><init_from>i</init_from></surface></newparam>"
         "<newparam sid='t'><sampler2D><source>s</source></sampler2D></newparam><technique sid='c'><lambert>" +
         with.effect +
         "</lambert></technique></profile_COMMON></effect></library_effects>"
         "<library_materials><material id='m'><instance_effect url='#e'/></material></library_materials>"
         "<library_geometries><geometry id='g' name='Square'><mesh>" +
         source("p", "-0.45 -0.45 0 0.45 -0.45 0 0.45 0.45 0 -0.45 0.45 0", 4, 3, "XYZ") + source("n", "0 0 1", 1, 3, "XYZ") +
         source("u", "0 0 1 0 1 1 0 1", 4, 2, "ST") +
         "<vertices id='v'><input semantic='POSITION' source='#p'/></vertices><triangles material='a' count='2'>"
         "<input semantic='VERTEX' source='#v' offset='0'/><input semantic='NORMAL' source='#n' offset='1'/>"
         "<input semantic='TEXCOORD' source='#u' offset='2' set='0'/><p>0 0 0 1 0 1 2 0 2 0 0 0 2 0 2 3 0 3</p></triangles>"
         "</mesh></geometry></library_geometries><library_visual_scenes><visual_scene id='vs'><node id='node1' name='Plate'>" +
         instance + "<node id='node2' name='Other'><translate>0 3 0</translate>" + instance +
         "</visual_scene></library_visual_scenes><scene><instance_visual_scene url='#vs'/></scene></COLLADA>";
}

std::string submesh(const std::string& file, const std::string& name, const std::string& material = "") {
  return "<geometry><mesh><uri>" + file + "</uri><submesh><name>" + name + "</name></submesh></mesh></geometry>" +
         (material.empty() ? "" : "<material>" + material + "</material>");
}

void write_half_open(const WorldFiles& files, const std::string& name) {
  write_picture(files, name, 16, [](int, int y) { return Pixel{200, 90, 40, static_cast<std::uint8_t>(y < 12 ? 0 : 255)}; });
}

TEST(RenderMedia, alpha_of_a_texture_counts_only_where_the_mesh_says_that_it_is_not_opaque) {
  const WorldFiles files;
  write_half_open(files, "q.png");
  files.write("opaque.dae", dae({}));
  files.write("cut.dae", dae({.effect = "<diffuse><texture texture='t' texcoord='UV'/></diffuse><transparent opaque='A_ONE'><texture "
                                        "texture='t' texcoord='UV'/></transparent>"}));
  Table table(files, {submesh("opaque.dae", "Plate"), submesh("cut.dae", "Plate")});
  EXPECT_TRUE(table.complaints.empty()) << table.complaints.front();
  EXPECT_TRUE(is_bytes(table.colors()[0], {200, 90, 40}, 2));
  EXPECT_TRUE(is_bytes(table.colors()[1], {0, 0, 0}, 2)) << "a hole";
}

TEST(RenderMedia, alpha_of_a_script_s_texture_counts_where_it_says_so) {
  const std::string unit = "texture_unit { texture q.png\n } } } }\n";
  const auto materials = parse_material_script("material Solid { technique { pass { " + unit +
                                               "material Cut { technique { pass { alpha_rejection greater 128\n " + unit);
  EXPECT_FALSE(materials.at("Solid").has_alpha_texture);
  EXPECT_TRUE(materials.at("Cut").has_alpha_texture);
}

TEST(RenderMedia, submeshes_are_found_by_the_name_of_their_node_and_by_its_id) {
  const WorldFiles files;
  write_picture(files, "q.png", 8, [](int, int) { return Pixel{200, 90, 40, 255}; });
  files.write("two.dae", dae({}));
  for (const char* name : {"Plate", "node1"}) {
    const MeshShape shape{(files.folder() / "two.dae").string(), name, false, Eigen::Vector3d::Ones()};
    const auto seen = read_mesh_file(shape);
    ASSERT_TRUE(seen) << seen.error().message;
    EXPECT_EQ(seen->mesh.indices.size(), 6U) << name;
    EXPECT_LT(seen->mesh.bounds.max().y(), 1) << name;
    const auto met = TriangleCache().triangles(shape);
    ASSERT_TRUE(met) << met.error().message;
    EXPECT_EQ((*met)->triangles.size(), 2U) << name;
  }
  const auto none = read_mesh_file({(files.folder() / "two.dae").string(), "Nobody", false, Eigen::Vector3d::Ones()});
  ASSERT_FALSE(none);
  EXPECT_THAT(none.error().message, testing::HasSubstr("has no submesh \"Nobody\""));
}

TEST(RenderMedia, pictures_are_found_by_model_addresses_in_meshes) {
  const WorldFiles files;
  write_picture(files, "paint/materials/textures/far.png", 8, [](int, int) { return Pixel{200, 90, 40, 255}; });
  files.write("thing/meshes/a.dae",
              dae({.image = "<image id='i'><init_from>model://paint/materials/textures/far.png</init_from></image>"}));
  const LoadResult loaded = files.load("");
  const MeshShape shape{(files.folder() / "thing/meshes/a.dae").string(), "Plate", false, Eigen::Vector3d::Ones()};
  const auto mesh = read_mesh_file(shape, loaded.world.model_path);
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(mesh->mesh.parts.at(0).material.texture, (files.folder() / "paint/materials/textures/far.png").string());
}

TEST(RenderMedia, images_without_a_file_cost_a_mesh_nothing) {
  const WorldFiles files;
  int number = 0;
  for (const char* image : {"<image id='i'><init_from/></image>", "<image id='i'/>", "<image id='i'><init_from> </init_from></image>",
                            "<image id='i' name='x'></image>"}) {
    const std::string file = "m" + std::to_string(number++) + ".dae";
    files.write(file, dae({.image = image}));
    Table table(files, {submesh(file, "Plate", "<diffuse>0.8 0.2 0.1 1</diffuse>"), submesh(file, "Plate")});
    EXPECT_TRUE(table.complaints.empty()) << image << ": " << table.complaints.front();
    EXPECT_TRUE(is_bytes(table.colors()[0], {204, 51, 26})) << image;
    const auto met = TriangleCache().triangles(MeshShape{(files.folder() / file).string(), "Plate", false, Eigen::Vector3d::Ones()});
    EXPECT_TRUE(met) << met.error().message;
  }
}

// As calibration boards and screens are exported: the picture shows as it is, in any light.
TEST(RenderMedia, light_of_its_own_shows_a_picture_as_it_is) {
  const WorldFiles files;
  write_picture(files, "q.png", 8, [](int, int) { return Pixel{200, 90, 40, 255}; });
  files.write("glow.dae",
              dae({.effect = "<emission><color>1 1 1 1</color></emission><diffuse><texture texture='t' texcoord='UV'/></diffuse>"}));
  Table table(files, {submesh("glow.dae", "Plate")});
  EXPECT_TRUE(is_bytes(table.colors()[0], {200, 90, 40}, 2));
}

// Known colours under one lamp and under eight: what is painted never gets brighter than its paint.
TEST(RenderMedia, many_lights_do_not_burn_out_pictures) {
  const WorldFiles files;
  write_picture(files, "q.png", 16, [](int x, int y) { return (x < 8) == (y < 8) ? Pixel{200, 90, 40, 255} : Pixel{30, 120, 180, 255}; });
  Table table(files, {plate("<pbr><metal><albedo_map>q.png</albedo_map><roughness>1</roughness></metal></pbr>")});
  for (int i = 0; i < 8; ++i) {
    LightDef lamp;
    lamp.pose = at(0.3 * i - 1, 0.2, 3);
    lamp.diffuse = {0.8F, 0.8F, 0.8F, 1};
    lamp.specular = {0, 0, 0, 1};
    lamp.range = 20;
    lamp.constant_attenuation = 0.5, lamp.linear_attenuation = 0.01, lamp.quadratic_attenuation = 0.001;
    table.loaded.world.lights.push_back(lamp);
  }
  table.studio = std::make_unique<Studio>(table.loaded.world);
  const Image image = table.picture();
  EXPECT_TRUE(is_bytes(pixel(image, 10, 10), {200, 90, 40}, 3) || is_bytes(pixel(image, 10, 10), {30, 120, 180}, 3));
  EXPECT_TRUE(is_bytes(pixel(image, 30, 10), {200, 90, 40}, 3) || is_bytes(pixel(image, 30, 10), {30, 120, 180}, 3));
}

TEST(RenderMedia, pictures_of_gazebo_itself_get_a_colour_like_theirs) {
  const WorldFiles files;
  Table table(files, {plate("<pbr><metal><albedo_map>file://media/materials/textures/grass_diffusespecular.png</albedo_map>"
                            "<roughness>1</roughness></metal></pbr>"),
                      plate(script("file://media/materials/scripts/gazebo.material", "Gazebo/GreyTransparent"))});
  EXPECT_EQ(all_findings(table.loaded), "");
  EXPECT_TRUE(table.complaints.empty());
  const auto grass = table.colors()[0];
  EXPECT_GT(grass[1], grass[0]);
  EXPECT_GT(grass[0], grass[2]);
  EXPECT_TRUE(is_bytes(table.colors()[1], {92, 92, 92}, 40)) << "half of grey, and black behind";
}

TEST(RenderMedia, shapes_of_too_many_corners_are_refused_and_large_height_maps_thinned) {
  PolylineShape polyline;
  polyline.outlines.emplace_back(5001, Eigen::Vector2d(0, 0));
  const auto outline = TriangleCache().triangles(polyline);
  ASSERT_FALSE(outline);
  EXPECT_EQ(outline.error().message, "polyline: has 5001 corners, at most 5000 are expected");
  const WorldFiles files;
  HeightmapShape map;
  map.path = write_picture(files, "h.png", 2051, [](int x, int) {
    const auto level = static_cast<std::uint8_t>(x * 255 / 2050);
    return Pixel{level, level, level, 255};
  });
  map.size = {10, 10, 255};
  const auto grid = TriangleCache().heights(map);
  ASSERT_TRUE(grid) << grid.error().message;
  EXPECT_EQ((*grid)->columns, 2049);
  EXPECT_NEAR((*grid)->heights.front(), 0, 1e-3);
  EXPECT_NEAR((*grid)->heights.back(), 255, 1e-3) << "the corners stay where they are";
}

// A binary STL that claims two million triangles, of which the disk holds none.
TEST(RenderMedia, meshes_that_the_memory_does_not_hold_are_named) {
  if (!test::MemoryLimit::is_kept) GTEST_SKIP() << "sanitizers need the memory";
  const WorldFiles files;
  std::string head(84, ' ');
  const std::uint32_t count = 2000000;
  std::memcpy(head.data() + 80, &count, 4);
  const std::string path = files.write("large.stl", head);
  std::filesystem::resize_file(path, 84 + 50ULL * count);
  const MeshShape shape{path, "", false, Eigen::Vector3d::Ones()};
  const test::MemoryLimit limit(16U << 20U);
  const auto seen = read_mesh_file(shape);
  const auto met = TriangleCache().triangles(shape);
  ASSERT_FALSE(seen);
  ASSERT_FALSE(met);
  EXPECT_EQ(seen.error().message, "mesh " + path + ": is too large for the memory");
  EXPECT_EQ(met.error().message, "mesh " + path + ": is too large for the memory");
}

TEST(RenderMedia, an_stl_file_that_claims_more_triangles_than_it_has_is_told) {
  const WorldFiles files;
  std::string head(84 + 50 * 3, '\0');
  const std::uint32_t count = 4'000'000'000;
  std::memcpy(head.data() + 80, &count, 4);
  const std::string path = files.write("claims.stl", head);
  const MeshShape shape{path, "", false, Eigen::Vector3d::Ones()};
  const auto seen = read_mesh_file(shape);
  const auto met = TriangleCache().triangles(shape);
  ASSERT_FALSE(seen);
  ASSERT_FALSE(met);
  const std::string line = "mesh " + path + ": is no STL file: neither text, nor as long as the number of its triangles says";
  EXPECT_EQ(seen.error().message, line);
  EXPECT_EQ(met.error().message, line);
}

// --- DirectDraw surfaces

std::vector<std::uint8_t> dds(const std::string& code, int width, int height, const std::vector<std::uint8_t>& data,
                              const std::array<std::uint32_t, 5>& bits_and_masks = {}) {
  std::vector<std::uint8_t> bytes(128);
  const auto put = [&](std::size_t at, std::uint32_t value) {
    for (std::size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<std::uint8_t>(value >> (8 * i));
  };
  std::copy_n("DDS ", 4, bytes.begin());
  put(4, 124), put(12, static_cast<std::uint32_t>(height)), put(16, static_cast<std::uint32_t>(width)), put(76, 32);
  put(80, code.empty() ? 0x41 : 4);
  std::copy(code.begin(), code.end(), bytes.begin() + 84);
  for (std::size_t i = 0; i < 5; ++i) put(88 + 4 * i, bits_and_masks[i]);
  bytes.insert(bytes.end(), data.begin(), data.end());
  return bytes;
}

std::array<int, 4> at(const Image& image, int x, int y) {
  const std::uint8_t* p = &image.rgba[static_cast<std::size_t>(y * image.width + x) * 4];
  return {p[0], p[1], p[2], p[3]};
}

TEST(RenderMedia, direct_draw_surfaces_are_unpacked) {
  // Red and blue; the first row red, the second blue, the third 2:1, the fourth 1:2.
  const std::vector<std::uint8_t> colors{0x00, 0xf8, 0x1f, 0x00, 0x00, 0x55, 0xaa, 0xff};
  const auto plain = decode_dds(dds("DXT1", 4, 4, colors));
  ASSERT_TRUE(plain) << plain.error().message;
  EXPECT_EQ(at(*plain, 0, 0), (std::array<int, 4>{255, 0, 0, 255}));
  EXPECT_EQ(at(*plain, 3, 1), (std::array<int, 4>{0, 0, 255, 255}));
  EXPECT_EQ(at(*plain, 0, 2), (std::array<int, 4>{170, 0, 85, 255}));
  EXPECT_EQ(at(*plain, 0, 3), (std::array<int, 4>{85, 0, 170, 255}));
  // The other order of the same colours: the third is the mean, the fourth a hole.
  const auto holes = decode_dds(dds("DXT1", 3, 4, {0x1f, 0x00, 0x00, 0xf8, 0x00, 0x55, 0xaa, 0xff}));
  ASSERT_TRUE(holes);
  EXPECT_EQ(at(*holes, 0, 2), (std::array<int, 4>{128, 0, 128, 255}));
  EXPECT_EQ(at(*holes, 2, 3)[3], 0);
  std::vector<std::uint8_t> alpha3{0xf0, 0xff, 0, 0, 0, 0, 0, 0};
  alpha3.insert(alpha3.end(), colors.begin(), colors.end());
  const auto dxt3 = decode_dds(dds("DXT3", 4, 4, alpha3));
  ASSERT_TRUE(dxt3);
  EXPECT_EQ(at(*dxt3, 0, 0)[3], 0);
  EXPECT_EQ(at(*dxt3, 1, 0)[3], 255);
  std::vector<std::uint8_t> alpha5{255, 0, 0x88, 0, 0, 0, 0, 0};  // first index 0, second 1, third 2
  alpha5.insert(alpha5.end(), colors.begin(), colors.end());
  const auto dxt5 = decode_dds(dds("DXT5", 4, 4, alpha5));
  ASSERT_TRUE(dxt5);
  EXPECT_EQ(at(*dxt5, 0, 0)[3], 255);
  EXPECT_EQ(at(*dxt5, 1, 0)[3], 0);
  EXPECT_EQ(at(*dxt5, 2, 0)[3], 219);
  const auto bgra = decode_dds(dds("", 1, 1, {10, 20, 30, 40}, {32, 0xff0000, 0xff00, 0xff, 0xff000000}));
  ASSERT_TRUE(bgra);
  EXPECT_EQ(at(*bgra, 0, 0), (std::array<int, 4>{30, 20, 10, 40}));
}

TEST(RenderMedia, direct_draw_surfaces_that_are_cut_short_or_unknown_are_told) {
  const auto why = [](const std::vector<std::uint8_t>& bytes) {
    const auto image = decode_dds(bytes);
    return image ? std::string("read") : image.error().message;
  };
  EXPECT_EQ(why(dds("DXT5", 4, 4, {1, 2, 3})), "is cut short");
  EXPECT_EQ(why(dds("BC7 ", 4, 4, {})), "DDS of format BC7  is not read; DXT1, DXT3, DXT5 or no compression is expected");
  EXPECT_THAT(why(dds("DXT1", 100000, 4, {})), testing::HasSubstr("got 100000 x 4"));
  EXPECT_EQ(why({'D', 'D', 'S', ' ', 1}), "is cut short");
}

}  // namespace
}  // namespace sim
