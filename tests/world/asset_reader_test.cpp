// Meshes and pictures read by a process of their own: what comes of it is checked, read once, and read again when the file has changed.
#include <fcntl.h>
#include <signal.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>

#include "reader/asset_reader.h"
#include "render/mesh_arrays.h"
#include "support/paths.h"
#include "support/world_files.h"
#include "world/reported_files.h"
#include "world/triangle_arrays.h"

namespace sim {
namespace {

std::span<const std::byte> bytes_of(const ArrayWriter& out) { return std::as_bytes(std::span(out.bytes())); }

TriangleMesh corner() { return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}}; }

bool is_taken(const TriangleMesh& mesh) {
  ArrayWriter out;
  put(out, mesh);
  ArrayReader in(bytes_of(out));
  TriangleMesh taken;
  return take_triangles(in, taken) && taken.vertices == mesh.vertices && taken.triangles == mesh.triangles;
}

TEST(AssetArrays, triangles_come_as_they_were_sent) { EXPECT_TRUE(is_taken(corner())); }

TEST(AssetArrays, triangles_with_indexes_out_of_range_or_impossible_corners_are_refused) {
  TriangleMesh mesh = corner();
  mesh.triangles[0][2] = 3;
  EXPECT_FALSE(is_taken(mesh));
  for (const double value : {std::nan(""), infinite, 2e7}) {
    mesh = corner();
    mesh.vertices[1].y() = value;
    EXPECT_FALSE(is_taken(mesh)) << value;
  }
  mesh = corner();
  mesh.triangles.clear();
  EXPECT_FALSE(is_taken(mesh));
}

TEST(AssetArrays, what_is_cut_short_is_refused_at_every_length) {
  ArrayWriter out;
  put(out, corner());
  const auto all = bytes_of(out);
  for (std::size_t size = 0; size < all.size(); ++size) {
    ArrayReader in(all.first(size));
    TriangleMesh mesh;
    EXPECT_FALSE(take_triangles(in, mesh)) << size;
  }
}

TEST(AssetArrays, a_count_beyond_all_bytes_takes_no_memory) {
  ArrayWriter out;
  out.number<std::uint64_t>(~std::uint64_t{0} / 8);
  ArrayReader in(bytes_of(out));
  EXPECT_TRUE(in.array<double>(~std::uint64_t{0}).empty());
  EXPECT_FALSE(in.ok());
}

TEST(AssetArrays, meshes_and_skins_that_make_no_sense_are_refused) {
  MeshFile file;
  file.mesh.vertices.resize(3, Vertex{{0, 0, 0}, {0, 0, 1}, {0, 0}});
  file.mesh.indices = {0, 1, 2};
  file.mesh.parts.push_back({0, 3, {}, {}, false});
  Skin skin;
  skin.nodes.resize(2);
  skin.nodes[1].parent = 0;
  skin.bones.push_back({1, Eigen::Affine3d::Identity()});
  skin.vertices = file.mesh.vertices;
  skin.weights.resize(3);
  const auto is_taken = [](const MeshFile& sent, const Skin& with) {
    ArrayWriter out;
    put(out, sent, &with);
    ArrayReader in(bytes_of(out));
    MeshFile taken;
    Skin worn;
    return take(in, taken, &worn);
  };
  EXPECT_TRUE(is_taken(file, skin));
  MeshFile bad = file;
  bad.mesh.indices[1] = 3;
  EXPECT_FALSE(is_taken(bad, skin)) << "index";
  bad = file;
  bad.mesh.vertices[2].position[0] = std::nanf("");
  EXPECT_FALSE(is_taken(bad, skin)) << "corner";
  bad = file;
  bad.mesh.parts[0].index_count = 6;
  EXPECT_FALSE(is_taken(bad, skin)) << "part";
  Skin odd = skin;
  odd.nodes[1].parent = 1;
  EXPECT_FALSE(is_taken(file, odd)) << "parent";
  odd = skin;
  odd.bones[0].node = 2;
  EXPECT_FALSE(is_taken(file, odd)) << "node";
  odd = skin;
  odd.weights[0].bones[3] = 1;
  EXPECT_FALSE(is_taken(file, odd)) << "bone";
  odd = skin;
  odd.weights.pop_back();
  EXPECT_FALSE(is_taken(file, odd)) << "weights";
}

TEST(AssetReader, memory_that_the_reader_could_still_change_is_refused) {
  for (const int seals : {0, F_SEAL_SHRINK | F_SEAL_GROW, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_WRITE}) {
    const int file = memfd_create("test", MFD_CLOEXEC | MFD_ALLOW_SEALING);
    ASSERT_EQ(write(file, "12345678", 8), 8);
    ASSERT_EQ(fcntl(file, F_ADD_SEALS, seals), 0);
    const auto memory = SealedMemory::map(file, 8);
    EXPECT_EQ(memory != nullptr, (seals & F_SEAL_WRITE) != 0) << seals;
  }
}

std::string obj(double size) { return "v 0 0 0\nv " + std::to_string(size) + " 0 0\nv 0 1 0\nf 1 2 3\n"; }

TEST(AssetReader, a_file_is_read_once_and_again_when_it_has_changed) {
  const WorldFiles files;
  const MeshShape shape{files.write("a.obj", obj(1)), "", false, {1, 1, 1}};
  TriangleCache first, second;
  const auto one = first.triangles(shape), same = second.triangles(shape);
  ASSERT_TRUE(one) << one.error().message;
  EXPECT_EQ(*one, *same);
  files.write("a.obj", obj(2.5));
  TriangleCache third;
  const auto other = third.triangles(shape);
  ASSERT_TRUE(other);
  EXPECT_DOUBLE_EQ((*other)->vertices[1].x(), 2.5);
  EXPECT_EQ(*first.triangles(shape), *one);  // what is there keeps its shape
}

TEST(AssetReader, a_file_that_was_written_again_with_the_same_content_stays_the_same_mesh) {
  const WorldFiles files;
  const MeshShape shape{files.write("a.obj", obj(1)), "", false, {1, 1, 1}};
  const auto one = TriangleCache().triangles(shape);
  ASSERT_TRUE(one) << one.error().message;
  std::filesystem::remove(files.folder() / "a.obj");
  files.write("a.obj", obj(1));
  const auto same = TriangleCache().triangles(shape);
  ASSERT_TRUE(same);
  EXPECT_EQ(*one, *same);
}

// The clock of a file system is coarse: most of these changes leave size and times of the file as they were.
TEST(AssetReader, a_file_that_changes_right_after_it_was_read_is_read_again) {
  const WorldFiles files;
  for (int i = 0; i < 200; ++i) {
    const double size = 1 + i % 8;
    const auto mesh = TriangleCache().triangles(MeshShape{files.write("a.obj", obj(size)), "", false, {1, 1, 1}});
    ASSERT_TRUE(mesh) << mesh.error().message;
    ASSERT_DOUBLE_EQ((*mesh)->vertices[1].x(), size) << i;
  }
}

TEST(AssetReader, a_file_is_settled_once_the_clock_of_its_file_system_has_moved_on) {
  FileStamp stamp{"a.obj", true};
  stamp.changed_ns = 1'700'000'000'123'456'789;
  stamp.seen_ns = stamp.changed_ns + 10'000'000;
  EXPECT_FALSE(is_settled(stamp));
  stamp.seen_ns = stamp.changed_ns + 100'000'000;
  EXPECT_TRUE(is_settled(stamp));
  stamp.changed_ns = 1'700'000'000'000'000'000;  // a file system that keeps seconds
  stamp.seen_ns = stamp.changed_ns + 1'500'000'000;
  EXPECT_FALSE(is_settled(stamp));
}

TEST(AssetReader, a_mesh_is_read_again_when_a_file_that_it_names_has_come) {
  const WorldFiles files;
  const MeshShape shape{files.write("a.obj", "mtllib a.mtl\nusemtl red\n" + obj(1)), "", false, {1, 1, 1}};
  const auto before = read_mesh_file(shape);
  ASSERT_TRUE(before) << before.error().message;
  files.write("a.mtl", "newmtl red\nKd 1 0 0\n");
  const auto after = read_mesh_file(shape);
  ASSERT_TRUE(after);
  EXPECT_EQ(after.value().mesh.parts[0].material.diffuse, (Color{1, 0, 0, 1}));
}

TEST(AssetReader, a_file_that_ends_the_reader_is_not_tried_again_until_it_changes) {
  const WorldFiles files;
  const auto cycle = std::filesystem::path(paths::source_dir) / "tests/worlds/damaged_meshes/node_cycle.dae";
  const std::string path = (files.folder() / "a.dae").string();
  std::filesystem::copy_file(cycle, path);
  const MeshShape shape{path, "", false, {1, 1, 1}};
  const auto started = [] { return AssetReader::mine().started(); };
  const auto met = TriangleCache().triangles(shape);
  ASSERT_FALSE(met);
  EXPECT_THAT(met.error().message, testing::HasSubstr(path + ": is damaged: its reader ended with"));
  const auto readers = started();
  EXPECT_FALSE(read_mesh_file(shape));
  EXPECT_FALSE(TriangleCache().triangles(shape));
  EXPECT_EQ(started(), readers);
  std::ofstream(path, std::ios::app) << " ";
  EXPECT_FALSE(TriangleCache().triangles(shape));
  EXPECT_EQ(started(), readers + 1);
}

// A triangle, and a second face: the count of its corners, and each.
std::string ply(const std::string& corners) {
  std::string head = "ply\nformat ascii 1.0\nelement vertex 3\n";
  for (const char* axis : {"x", "y", "z"}) head += std::string("property float ") + axis + "\n";
  return head + "element face 2\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n" + corners + "\n";
}

TEST(AssetReader, a_face_that_names_a_vertex_that_is_not_there_is_told_and_ends_no_reader) {
  const WorldFiles files;
  const auto read = [&](const std::string& corner) {
    return MeshShape{files.write("a" + corner + ".ply", ply("3 0 1 " + corner)), "", false, {1, 1, 1}};
  };
  ASSERT_TRUE(TriangleCache().triangles(read("2")));
  const auto readers = AssetReader::mine().started();
  for (const std::string corner : {"3", "1000000", "90000000", "4294967295"}) {
    const MeshShape shape = read(corner);
    const auto triangles = TriangleCache().triangles(shape);
    const auto mesh = read_mesh_file(shape);
    ASSERT_FALSE(triangles) << corner;
    ASSERT_FALSE(mesh) << corner;
    for (const auto& error : {triangles.error(), mesh.error()})
      EXPECT_THAT(error.message, testing::HasSubstr("is damaged: mesh 0 \"\": face 1 names vertex " + corner + " of 3"));
  }
  EXPECT_EQ(AssetReader::mine().started(), readers);
}

// The text with the first `old` replaced.
std::string changed(std::string text, const std::string& old, const std::string& now) {
  const auto at = text.find(old);
  EXPECT_NE(at, std::string::npos) << old;
  return at == std::string::npos ? text : text.replace(at, old.size(), now);
}

TEST(AssetReader, a_mesh_with_a_corner_that_is_no_number_or_too_far_away_is_refused_in_each_format) {
  const WorldFiles files;
  const std::string nan = std::string("\0\0\xc0\x7f", 4), one = std::string("\0\0\0\x3f", 4);
  for (const auto& [file, old, now] : {std::tuple<std::string, std::string, std::string>{"cube.obj", "0.5", "nan"},
                                       {"cube.obj", "0.5", "3e7"},
                                       {"text.stl", "0.5", "nan"},
                                       {"text.ply", "0.5", "nan"},
                                       {"limb.dae", ">0 0 0 1 0 0", ">0 0 nan 1 0 0"},
                                       {"cube.fbx", "0.5", "nan"},
                                       {"binary.stl", one, nan},
                                       {"binary.ply", one, nan},
                                       {"cube.glb", one, nan}}) {
    std::ifstream in(std::filesystem::path(paths::source_dir) / "tests/fuzz/assets" / file, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    const MeshShape shape{files.write("bad_" + file, changed(text, old, now)), "", false, {1, 1, 1}};
    const auto triangles = TriangleCache().triangles(shape);
    const auto mesh = read_mesh_file(shape);
    ASSERT_FALSE(triangles) << file << " " << now;
    ASSERT_FALSE(mesh) << file << " " << now;
    for (const auto& error : {triangles.error(), mesh.error()})
      EXPECT_THAT(error.message, testing::HasSubstr("is damaged: a triangle has a corner at ")) << file << " " << now;
  }
}

TEST(AssetReader, a_gltf_face_that_names_a_vertex_that_is_not_there_is_told) {
  const MeshShape shape{std::string(paths::source_dir) + "/tests/worlds/damaged_meshes/index_beyond.gltf", "", false, {1, 1, 1}};
  const auto triangles = TriangleCache().triangles(shape);
  const auto mesh = read_mesh_file(shape);
  ASSERT_FALSE(triangles);
  ASSERT_FALSE(mesh);
  for (const auto& error : {triangles.error(), mesh.error()})
    EXPECT_THAT(error.message, testing::HasSubstr("is damaged: a face names a vertex that is not there"));
}

TEST(AssetReader, the_first_fault_of_a_file_is_told_until_it_changes) {
  const WorldFiles files;
  const auto path = files.write("a.obj", "v");
  EXPECT_TRUE(is_first_report(path));
  EXPECT_FALSE(is_first_report(path));
  std::filesystem::remove(path);
  EXPECT_TRUE(is_first_report(path));  // another state of it
  EXPECT_FALSE(is_first_report(path));
}

// Physics and rays fail to read the same file, one after the other.
TEST(AssetReader, a_fault_is_told_once_however_many_there_were_before) {
  const WorldFiles files;
  for (int i = 0; i < 10000; ++i) {
    const auto path = (files.folder() / ("none" + std::to_string(i))).string();
    EXPECT_TRUE(is_first_report(path));
    EXPECT_FALSE(is_first_report(path)) << i;
  }
}

TEST(AssetReader, a_face_without_corners_is_left_out) {
  const WorldFiles files;
  const MeshShape shape{files.write("a.ply", ply("0")), "", false, {1, 1, 1}};
  const auto triangles = TriangleCache().triangles(shape);
  ASSERT_TRUE(triangles) << triangles.error().message;
  EXPECT_EQ((*triangles)->triangles.size(), 1U);
  const auto mesh = read_mesh_file(shape);
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(mesh.value().mesh.indices.size(), 3U);
}

// Assimp searches for the end of a header for ever, and reserves what the header counts.
TEST(AssetReader, a_ply_whose_header_does_not_fit_the_file_is_refused_before_it_is_read) {
  const std::string head = "ply\nformat ascii 1.0\n";
  const std::string corner = "property float x\nproperty float y\nproperty float z\n";
  const std::string faces = "property list uchar int vertex_indices\n";
  const std::string end = "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  const WorldFiles files;
  int number = 0;
  const auto said = [&](const std::string& content) {
    const auto met =
        TriangleCache().triangles(MeshShape{files.write("a" + std::to_string(number++) + ".ply", content), "", false, {1, 1, 1}});
    return met ? std::string("read") : met.error().message;
  };
  EXPECT_EQ(said(head + "element vertex 3\n" + corner + "element face 1\n" + faces + end), "read");
  EXPECT_EQ(said(head + "element vertex 3\n" + corner + "comment element vertex 9999999\nelement face 1\n" + faces + end), "read");
  EXPECT_THAT(said(head + "element vertex 3\n" + corner), testing::HasSubstr("is damaged: its header has no line \"end_header\""));
  EXPECT_THAT(said(head + "element vertex 3\n" + corner + "an end_header\n0 0 0\n"), testing::HasSubstr("no line \"end_header\""));
  EXPECT_THAT(said(head + "element vertex 3\n" + corner + "end_headers\n0 0 0\n"), testing::HasSubstr("no line \"end_header\""));
  EXPECT_THAT(said(head + "element vertex 99999999\n" + corner + "element face 1\n" + faces + end),
              testing::HasSubstr("is damaged: its header counts 99999999 of \"vertex\", the file has room for 4"));
  EXPECT_THAT(said(head + "element vertex 3\n" + corner + "element face 18446744073709551615\n" + faces + end),
              testing::HasSubstr("18446744073709551615 of \"face\""));
  EXPECT_THAT(said(head + "element vertex -3\n" + corner + end),
              testing::HasSubstr("its header counts \"-3\" of \"vertex\", expected a number"));
  EXPECT_THAT(said("ply\nformat binary_little_endian 1.0\nelement vertex 4\n" + corner + "end_header\n" + std::string(36, '\0')),
              testing::HasSubstr("4 of \"vertex\", the file has room for 3"));
  EXPECT_THAT(said(head + "element nothing 400\n" + end), testing::HasSubstr("400 of \"nothing\", which have no property"));
  EXPECT_THAT(said(head + "element\tvertex\t99999999\n" + corner + "element face 1\n" + faces + end),
              testing::HasSubstr("its header counts 99999999 of \"vertex\""));
  EXPECT_THAT(said(head + "element 99999999vertex 3\n" + corner + "element face 1\n" + faces + end),
              testing::HasSubstr("is damaged: its header has an element \"99999999vertex\", expected a name that begins with no digit"));
  EXPECT_EQ(said(head + "element\tvertex 3\n" + corner + "element face\t1\n" + faces + end), "read");
  EXPECT_THAT(said(head + "element vertex 3\n" + corner + faces + "end_header\n0 0 0.2147483647\n1 0 0\n0 1 0\n"),
              testing::HasSubstr("is damaged: a line of \"vertex\" ends before the count of a list"));
  EXPECT_THAT(said(head + "element vertex 3\n" + corner + "element face 1\n" + faces + "property list uchar float texcoord\n" + end),
              testing::HasSubstr("is damaged: a line of \"face\" ends before the count of a list"));
}

// If a list is longer than its line, Assimp fills it with zeros, and would take seconds to triangulate it.
TEST(AssetReader, a_face_with_more_corners_than_its_mesh_or_its_file_can_have_is_refused) {
  const WorldFiles files;
  const auto said = [&](const std::string& property, const std::string& value, const std::string& count, const std::string& comment = "") {
    const std::string head =
        "ply\nformat ascii 1.0\n" + comment + "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 2\n";
    const std::string lists = property + "property list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n";
    const std::string faces = value + "3 0 1 2\n" + value + count + " 0 1 2\n";
    const auto met = TriangleCache().triangles(
        MeshShape{files.write(value + count + (comment.empty() ? ".ply" : "c.ply"), head + lists + faces), "", false, {1, 1, 1}});
    return met ? std::string("read") : met.error().message;
  };
  for (const std::string count : {"3", "5", "20000"}) EXPECT_EQ(said("", "", count), "read");
  for (const std::string count : {"65536", "99999999"})
    EXPECT_THAT(said("", "", count), testing::HasSubstr("is damaged: a list of \"face\" counts " + count + " numbers, the file has "));
  // In a file of this size only the check of the mesh finds it.
  EXPECT_THAT(said("", "", "65536", "comment " + std::string(66000, 'x') + "\n"),
              testing::HasSubstr("is damaged: mesh 0 \"\": face 1 has 65537 corners, its mesh 3 vertices"));
  EXPECT_THAT(said("property int first\n", "0 ", "65536"), testing::HasSubstr("is damaged: a list of \"face\" counts 65536 numbers"));
}

TEST(AssetReader, formats_that_no_world_uses_are_refused_by_their_names) {
  const WorldFiles files;
  const auto met = TriangleCache().triangles(MeshShape{files.write("a.blend", "BLENDER"), "", false, {1, 1, 1}});
  ASSERT_FALSE(met);
  EXPECT_THAT(met.error().message, testing::HasSubstr("expected .dae, .stl, .obj, .ply, .gltf, .glb, .fbx, .bvh"));
}

TEST(AssetReader, a_deadline_that_is_over_costs_no_reader) {
  const WorldFiles files;
  const MeshShape shape{files.write("a.obj", obj(1)), "", false, {1, 1, 1}};
  {
    const ReadDeadline over(std::chrono::steady_clock::now());
    EXPECT_FALSE(TriangleCache().triangles(shape));
  }
  EXPECT_TRUE(TriangleCache().triangles(shape));
}

}  // namespace
}  // namespace sim
