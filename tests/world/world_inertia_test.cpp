#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "support/world_files.h"
#include "world/world_loader.h"

namespace sim {
namespace {

TEST(WorldInertia, is_turned_into_the_link_and_checked) {
  const WorldFiles files;
  const LoadResult result =
      files.load(model_of("<inertial><pose>1 2 3 0 0 "
                          "1.5707963267948966</pose><mass>4</mass><inertia><ixx>1</ixx><iyy>2</iyy><izz>2.5</izz></inertia></inertial>"));
  const LinkDef& link = result.world.models.at(0).links.at(0);
  EXPECT_EQ(link.mass, 4);
  EXPECT_EQ(link.center_of_mass, Eigen::Vector3d(1, 2, 3));
  EXPECT_TRUE(link.inertia.isApprox(Eigen::Vector3d(2, 1, 2.5).asDiagonal().toDenseMatrix(), 1e-9)) << link.inertia;
  EXPECT_TRUE(result.findings.empty());
}

TEST(WorldInertia, impossible_ones_are_mended_with_a_line) {
  const WorldFiles files;
  for (const char* moments : {"<ixx>0</ixx><iyy>0</iyy><izz>0</izz>", "<ixx>-1</ixx><iyy>1</iyy><izz>1</izz>",
                              "<ixx>1</ixx><iyy>1</iyy><izz>10</izz>", "<ixx>nan</ixx><iyy>1</iyy><izz>1</izz>",
                              "<ixx>1</ixx><iyy>1</iyy><izz>1</izz><ixy>5</ixy>", "<ixx>1e-12</ixx><iyy>1e-12</iyy><izz>1e-12</izz>"}) {
    const LoadResult result = files.load(model_of("<inertial><mass>1</mass><inertia>" + std::string(moments) + "</inertia></inertial>"));
    ASSERT_EQ(result.world.models.size(), 1U) << moments;
    const Eigen::Matrix3d inertia = result.world.models[0].links[0].inertia;
    EXPECT_GT(inertia.eigenvalues().real().minCoeff(), 0.9e-9) << moments;
    EXPECT_TRUE(inertia.allFinite());
    EXPECT_GE(findings_with(result, "w.sdf:3: "), 1) << moments << "\n" << all_findings(result);
    EXPECT_FALSE(result.dropped);
  }
}

const std::string only_mass = "<inertial><mass>2</mass></inertial>";

std::string collision_of(const std::string& geometry, const std::string& pose = "0 0 0 0 0 0", const std::string& name = "c") {
  return "<collision name='" + name + "'><pose>" + pose + "</pose><geometry>" + geometry + "</geometry></collision>";
}

// Of the first link of the first model.
Eigen::Matrix3d inertia_of(const LoadResult& result) { return result.world.models.at(0).links.at(0).inertia; }

// Principal moments of a link of 2 kg that says no more, in the order of the link's axes.
void expect_moments(const WorldFiles& files, const std::string& collisions, const Eigen::Vector3d& moments) {
  const LoadResult result = files.load(model_of(only_mass + collisions));
  EXPECT_TRUE(inertia_of(result).isApprox(moments.asDiagonal().toDenseMatrix(), 1e-9)) << collisions << "\n"
                                                                                       << inertia_of(result) << "\n"
                                                                                       << all_findings(result);
  EXPECT_EQ(result.world.models[0].links[0].mass, 2);
  EXPECT_EQ(result.world.models[0].links[0].center_of_mass, Eigen::Vector3d::Zero());
}

TEST(WorldInertia, of_a_wheel_without_inertial_is_that_of_its_shape) {
  const WorldFiles files;
  const std::string wheel =
      "<link name='wheel'><collision name='c'><geometry><cylinder><radius>0.1</radius><length>0.02</length></cylinder>"
      "</geometry></collision></link><joint name='j' type='revolute'><parent>base</parent><child>wheel</child><axis>";
  const auto inertia = [&](const std::string& limit) {
    const LoadResult result = files.load("<model name='m'><link name='base'/>" + wheel + limit + "</axis></joint></model>");
    EXPECT_EQ(result.world.models.at(0).links.at(0).inertia, Eigen::Matrix3d::Identity());
    EXPECT_EQ(findings_with(result, "has no <inertial>; 1 kg and the inertia of its collisions are taken"), limit.empty() ? 1 : 0);
    return result.world.models.at(0).links.at(1).inertia;
  };
  EXPECT_TRUE(inertia("").isApprox(Eigen::Vector3d(0.03 + 0.0004, 0.03 + 0.0004, 0.06).asDiagonal().toDenseMatrix() / 12, 1e-9));
  EXPECT_EQ(inertia("<limit><lower>-1</lower><upper>1</upper></limit>"), Eigen::Matrix3d::Identity()) << "an arm";
}

TEST(WorldInertia, is_that_of_the_shapes_where_only_a_mass_is_given) {
  const WorldFiles files;
  expect_moments(files, collision_of("<box><size>1 2 3</size></box>"), Eigen::Vector3d(13, 10, 5) / 6);
  expect_moments(files, collision_of("<box><size>1 2 3</size></box>", "0 0 0 1.5707963267948966 0 0"), Eigen::Vector3d(13, 5, 10) / 6);
  expect_moments(files, collision_of("<sphere><radius>0.5</radius></sphere>"), Eigen::Vector3d::Constant(0.2));
  expect_moments(files, collision_of("<cylinder><radius>0.1</radius><length>0.6</length></cylinder>"), Eigen::Vector3d(0.065, 0.065, 0.01));
  expect_moments(files, collision_of("<ellipsoid><radii>1 2 3</radii></ellipsoid>"), 0.4 * Eigen::Vector3d(13, 10, 5));
  expect_moments(files, collision_of("<capsule><radius>0.5</radius><length>1</length></capsule>"), Eigen::Vector3d(0.605, 0.605, 0.23));
  // Around the middle of the shapes, wherever that is.
  const std::string cube = "<box><size>0.1 0.1 0.1</size></box>";
  expect_moments(files, collision_of(cube, "5 1 0 0 0 0") + collision_of(cube, "5 -1 0 0 0 0", "d"),
                 Eigen::Vector3d(2 + 1.0 / 300, 1.0 / 300, 2 + 1.0 / 300));
  // What has no end or no file counts for nothing.
  expect_moments(files, collision_of("<plane/>", "0 0 0 0 0 0", "d") + collision_of("<sphere><radius>0.5</radius></sphere>"),
                 Eigen::Vector3d::Constant(0.2));
  expect_moments(files, collision_of("<plane/>"), Eigen::Vector3d::Ones());
}

TEST(WorldInertia, is_that_of_the_box_around_a_mesh_where_only_a_mass_is_given) {
  const WorldFiles files;
  files.write("wedge.obj", "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
  files.write("sheet.obj", "v 0 0 5\nv 3 0 5\nv 3 3 5\nv 0 3 5\nf 1 2 3\nf 1 3 4\n");
  files.write("bad.obj", "nothing");
  expect_moments(files, collision_of("<mesh><uri>wedge.obj</uri></mesh>"), Eigen::Vector3d(13, 10, 5) / 6);
  expect_moments(files, collision_of("<mesh><uri>wedge.obj</uri><scale>1 -1 2</scale></mesh>"), Eigen::Vector3d(40, 37, 5) / 6);
  const double thin = 0.003 * 0.003;
  expect_moments(files, collision_of("<mesh><uri>sheet.obj</uri></mesh>"), Eigen::Vector3d(9 + thin, 9 + thin, 18) / 6);
  expect_moments(files, collision_of("<mesh><uri>bad.obj</uri></mesh>"), Eigen::Vector3d::Ones());
}

TEST(WorldInertia, of_shapes_is_told_in_one_note_for_each_model) {
  const WorldFiles files;
  const std::string ball = collision_of("<sphere><radius>0.5</radius></sphere>");
  const auto link = [&](const std::string& name, const std::string& content) { return "<link name='" + name + "'>" + content + "</link>"; };
  for (const char* version : {"1.4", "1.6", "1.9"}) {
    const LoadResult result =
        files.load("<model name='one'>" + link("l", only_mass + ball) + "</model>\n<model name='three'>" + link("a", only_mass + ball) +
                       link("b", only_mass + ball) + link("c", only_mass) + link("d", ball) + link("e", only_mass + ball) + "</model>",
                   version);
    EXPECT_FALSE(result.dropped);
    ASSERT_EQ(result.findings.size(), 2U) << all_findings(result);
    for (const Finding& finding : result.findings) EXPECT_EQ(finding.severity, Finding::Severity::note);
    EXPECT_EQ(result.findings[0].text(),
              "w.sdf:3: <inertial> of link \"l\" of model \"one\" has a mass and no <inertia>; that of its collisions is taken");
    EXPECT_EQ(result.findings[1].text(),
              "w.sdf:4: <inertial> of link \"a\" of model \"three\" has a mass and no <inertia>; that of its collisions is taken, and so "
              "for 2 other links of the model");
    const ModelDef& three = result.world.models.at(1);
    for (const char* name : {"a", "b", "e"}) EXPECT_NEAR(three.link(name)->inertia(0, 0), 0.2, 1e-12) << name;
  }
}

TEST(WorldInertia, stays_what_the_format_says_where_it_is_given_or_nothing_can_be_weighed) {
  const WorldFiles files;
  const std::string ball = collision_of("<sphere><radius>0.5</radius></sphere>");
  for (const std::string& content :
       {only_mass, ball, "<inertial><pose>0 0 1 0 0 0</pose></inertial>" + ball, "<inertial><mass>2</mass><inertia/></inertial>" + ball,
        "<inertial><mass>2</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia></inertial>" + ball}) {
    const LoadResult result = files.load(model_of(content));
    EXPECT_EQ(inertia_of(result), Eigen::Matrix3d::Identity()) << content;
    EXPECT_EQ(findings_with(result, "inertia"), 0) << content << "\n" << all_findings(result);
  }
  const LoadResult fixed = files.load("<model name='m'><static>true</static><link name='l'>" + only_mass + ball + "</link></model>");
  EXPECT_TRUE(fixed.findings.empty()) << all_findings(fixed);
}

}  // namespace
}  // namespace sim
