#include <gmock/gmock.h>

#include "support/world_files.h"
#include "world/world_loader.h"

namespace sim {
namespace {

using testing::HasSubstr;

TEST(WorldSpawn, takes_text_files_folders_and_addresses) {
  const WorldFiles files;
  files.write_model("crate", "<model name='crate'><link name='l'/></model>");
  const ModelPath path({files.folder()});
  const Eigen::Isometry3d pose(Eigen::Translation3d(1, 2, 3));
  for (const std::string& what :
       {std::string("model://crate"), (files.folder() / "crate").string(), (files.folder() / "crate/model.sdf").string(),
        std::string(" <sdf version='1.6'><model name='crate'><link name='l'/></model></sdf>")}) {
    base::Result<LoadedModel> loaded = load_model(what, "mine", pose, path);
    ASSERT_TRUE(loaded.ok()) << what << ": " << loaded.error().message;
    EXPECT_EQ(loaded->model.name, "mine");
    EXPECT_EQ(loaded->model.pose.translation(), Eigen::Vector3d(1, 2, 3));
    EXPECT_EQ(loaded->model.links.size(), 1U);
  }
  EXPECT_THAT(load_model("model://nothing", "x", pose, path).error().message, HasSubstr("not found"));
  EXPECT_FALSE(load_model("<sdf version='1.9'/>", "x", pose, path).ok());
  EXPECT_FALSE(load_model("<sdf version='1.9'><model name='empty'/></sdf>", "x", pose, path).ok());
  EXPECT_FALSE(load_model("", "x", pose, path).ok());
  Eigen::Isometry3d bad = pose;
  bad.translation().x() = std::nan("");
  EXPECT_FALSE(load_model("model://crate", "x", bad, path).ok());
}

TEST(WorldSpawn, the_models_of_the_path_are_listed_once_and_sorted) {
  const WorldFiles files, others;
  for (const char* name : {"crate", "barrel"}) files.write_model(name, "<model name='m'><link name='l'/></model>");
  others.write_model("crate", "<model name='m'><link name='l'/></model>");
  std::filesystem::create_directories(others.folder() / "models" / "deep");
  std::ofstream(others.folder() / "models" / "deep" / "model.sdf") << "<sdf version='1.6'/>";
  std::filesystem::create_directories(others.folder() / "no_model");
  const ModelPath path({files.folder(), others.folder(), "/nowhere/at/all"});
  EXPECT_THAT(path.models(), testing::ElementsAre("barrel", "crate", "deep"));
  const WorldFiles hidden;
  hidden.write_model("hidden", "<model name='m'><link name='l'/></model>");
  std::filesystem::create_directory_symlink(hidden.folder() / "hidden", others.folder() / "outside");
  std::filesystem::create_directory_symlink(files.folder() / "crate", others.folder() / "inside");
  EXPECT_THAT(path.models(), testing::ElementsAre("barrel", "crate", "deep", "inside", "outside"));
  EXPECT_THAT(path.confined().models(), testing::ElementsAre("barrel", "crate", "deep", "inside")) << "what is elsewhere is not for all";
  EXPECT_THAT(ModelPath{}.models(), testing::IsEmpty());
}

TEST(WorldSpawn, a_link_to_a_file_with_another_extension_keeps_its_name) {
  const WorldFiles files, others;
  files.write("store/0123abcd", "v 0 0 0\n");
  files.write("meshes/plain.obj", "v 0 0 0\n");
  const auto meshes = std::filesystem::canonical(files.folder() / "meshes");
  std::filesystem::create_symlink("../store/0123abcd", meshes / "box.obj");
  std::filesystem::create_symlink("plain.obj", meshes / "same.obj");
  std::filesystem::create_symlink(others.write("0123abcd", "v 0 0 0\n"), meshes / "outside.obj");
  for (const ModelPath& path : {ModelPath({files.folder()}), ModelPath({files.folder()}).confined()}) {
    EXPECT_EQ(path.find("meshes/box.obj", {}), meshes / "box.obj");
    EXPECT_EQ(path.find("meshes/same.obj", {}), meshes / "plain.obj");
  }
  EXPECT_TRUE(ModelPath({files.folder()}).find("meshes/outside.obj", {}));
  EXPECT_FALSE(ModelPath({files.folder()}).confined().find("meshes/outside.obj", {}));
}

TEST(WorldSpawn, takes_urdf) {
  base::Result<LoadedModel> loaded = load_model(
      "<robot name='cart'><link name='base'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' "
      "iyz='0'/></inertial><collision><geometry>"
      "<box size='1 2 3'/></geometry></collision></link><link name='wheel'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' "
      "ixy='0' ixz='0' iyz='0'/></inertial>"
      "</link><joint name='axle' type='continuous'><parent link='base'/><child link='wheel'/><origin xyz='0 1 0'/><axis xyz='0 1 "
      "0'/></joint></robot>",
      "", std::nullopt, ModelPath{});
  ASSERT_TRUE(loaded.ok()) << loaded.error().message;
  EXPECT_EQ(loaded->model.name, "cart");
  EXPECT_EQ(loaded->model.links.size(), 2U);
  EXPECT_EQ(loaded->model.joint("axle")->pose_in_model.translation(), Eigen::Vector3d(0, 1, 0));
  EXPECT_EQ(std::get<BoxShape>(loaded->model.link("base")->collisions.at(0).geometry).size, Eigen::Vector3d(1, 2, 3));
}

}  // namespace
}  // namespace sim
