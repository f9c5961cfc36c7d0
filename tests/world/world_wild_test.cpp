// Worlds in the manner of those that people have: our own small imitations in tests/worlds, and the mistakes that are common in them.
#include <gmock/gmock.h>

#include "support/paths.h"
#include "support/world_files.h"
#include "world/iface_names.h"
#include "world/materials.h"
#include "world/plugin_kind.h"

namespace sim {
namespace {

using testing::HasSubstr;

LoadResult load_shipped(const std::string& file) {
  const std::filesystem::path root = paths::source_dir;
  base::Result<LoadResult> result = load_world(root / file, ModelPath({root / "worlds"}));
  if (result) return std::move(*result);
  ADD_FAILURE() << result.error().message;
  return {};
}

TEST(ShippedWorlds, load_without_a_finding) {
  for (const char* file :
       {"empty.sdf", "obstacle_course.sdf", "maze.sdf", "leader_follower.sdf", "hundred.sdf", "devices.sdf", "power.sdf"}) {
    const LoadResult result = load_shipped("worlds/" + std::string(file));
    EXPECT_TRUE(result.findings.empty()) << file << "\n" << all_findings(result);
    EXPECT_EQ(result.world.lights.size(), 1U) << file;
    EXPECT_NE(result.world.model("ground_plane"), nullptr) << file;
  }
}

TEST(ShippedWorlds, have_the_robots_that_they_promise) {
  const LoadResult course = load_shipped("worlds/obstacle_course.sdf");
  const ModelDef* robot = course.world.model("pioneer2dx");
  ASSERT_NE(robot, nullptr);
  EXPECT_EQ(robot->links.size(), 5U);
  double mass = 0;
  for (const LinkDef& link : robot->links) mass += link.mass;
  EXPECT_NEAR(mass, 9.16, 1e-9) << "9 kg and the laser";
  ASSERT_EQ(robot->plugins.size(), 1U);
  EXPECT_EQ(kind_of(robot->plugins[0]), PluginKind::differential_drive);
  EXPECT_EQ(iface_name(*robot, robot->plugins[0]), "pioneer2dx::position2d");
  EXPECT_EQ(robot->link("chassis")->sensors.size(), 16U);
  const SensorDef& laser = robot->link("laser_link")->sensors.at(0);
  EXPECT_EQ(iface_name(*robot, laser), "pioneer2dx::laser");
  EXPECT_EQ(std::get<RayDef>(laser.data).horizontal.samples, 682);
  const LoadResult maze = load_shipped("worlds/maze.sdf");
  for (const char* name : {"leader", "follower"}) {
    ASSERT_NE(maze.world.model(name), nullptr);
    EXPECT_EQ(std::get<RayDef>(maze.world.model(name)->link("laser_link")->sensors.at(0).data).horizontal.samples, 181);
  }
  const LoadResult hundred = load_shipped("worlds/hundred.sdf");
  EXPECT_EQ(std::count_if(hundred.world.models.begin(), hundred.world.models.end(),
                          [](const ModelDef& m) { return m.name.starts_with("pioneer_"); }),
            100);
}

TEST(WildWorlds, load_and_keep_everything) {
  const std::filesystem::path folder = std::filesystem::path(paths::source_dir) / "tests/worlds";
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    ++count;
    base::Result<LoadResult> result = load_world(entry.path(), ModelPath({std::filesystem::path(paths::source_dir) / "worlds"}));
    ASSERT_TRUE(result.ok()) << result.error().message;
    EXPECT_FALSE(result->dropped) << entry.path() << "\n" << all_findings(*result);
    EXPECT_FALSE(result->world.models.empty()) << entry.path();
  }
  EXPECT_GE(count, 8);
}

TEST(WildWorlds, a_comment_may_stand_before_the_declaration) {
  const WorldFiles files;
  const base::Result<LoadResult> result = files.load_text(
      "\n<!-- licence -->\n<?xml version='1.0'?>\n<sdf version='1.6'><world name='w'><model name='m'><link "
      "name='l'/></model></world></sdf>");
  ASSERT_TRUE(result.ok()) << result.error().message;
  EXPECT_EQ(result->world.models.size(), 1U);
}

TEST(WildWorlds, attributes_without_quotes_are_mended) {
  const WorldFiles files;
  const base::Result<LoadResult> result = files.load_text(
      "<sdf version=1.6>\n<world name='w'>\n<!-- a=b <c d=e> --><model name=m><link name=l/></model><model name='n'><link "
      "name='l'/></model></world></sdf>");
  ASSERT_TRUE(result.ok()) << result.error().message;
  ASSERT_EQ(result->world.models.size(), 2U);
  EXPECT_EQ(result->world.models[0].name, "m");
  EXPECT_EQ(result->world.models[0].source, "w.sdf:3");
  ASSERT_EQ(result->findings.size(), 1U) << all_findings(*result);
  EXPECT_EQ(result->findings[0].text(), "w.sdf:1: attribute values without quotes are corrected");
}

TEST(WildWorlds, newer_versions_are_read_as_the_newest_known) {
  const WorldFiles files;
  for (const char* version : {"1.10", "1.12"}) {
    const LoadResult result = files.load("<model name='m'><link name='l'/></model>", version);
    EXPECT_EQ(result.world.models.size(), 1U);
    ASSERT_EQ(result.findings.size(), 1U);
    EXPECT_EQ(result.findings[0].severity, Finding::Severity::note);
  }
}

TEST(WildWorlds, elements_that_only_name_topics_and_frames_of_messages_are_no_findings) {
  const WorldFiles files;
  const LoadResult result =
      files.load(model_of("<sensor name='s' type='camera'><gz_frame_id>l</gz_frame_id><topicName>t</topicName><robotNamespace/><camera>"
                          "<camera_info_topic>info</camera_info_topic><trigger_topic>now</trigger_topic></camera></sensor>"));
  EXPECT_EQ(result.world.models.at(0).links.at(0).sensors.size(), 1U);
  EXPECT_TRUE(result.findings.empty()) << all_findings(result);
}

TEST(WildWorlds, sensors_of_unknown_types_are_one_line_with_all_they_hold) {
  const WorldFiles files;
  const LoadResult result = files.load(model_of("<sensor name='s' type='geiger'><geiger><dose/></geiger></sensor>") +
                                       "<plugin name='gz::sim::systems::AirSpeed' filename='gz-sim-air-speed-system'/>");
  ASSERT_EQ(result.findings.size(), 1U) << all_findings(result);
  EXPECT_THAT(result.findings[0].text(), HasSubstr("w.sdf:3: sensors of type \"geiger\" are not simulated"));
}

TEST(WildWorlds, models_around_a_lost_one_go_with_it_in_one_line) {
  const WorldFiles files;
  const LoadResult result = files.load(
      "<model name='chair_1'><include><uri>model://chair</uri></include><pose>1 2 3 0 0 0</pose></model>\n"
      "<model name='desk'><link name='l'/><include><uri>model://lamp</uri></include></model>\n<model name='empty'/>");
  ASSERT_EQ(result.findings.size(), 3U) << all_findings(result);
  EXPECT_EQ(findings_with(result, "w.sdf:3: model \"model://chair\" is not found"), 1);
  EXPECT_EQ(findings_with(result, "w.sdf:4: model \"model://lamp\" is not found"), 1);
  EXPECT_EQ(findings_with(result, "w.sdf:5: model \"empty\" has no link"), 1);
  ASSERT_EQ(result.world.models.size(), 1U);
  EXPECT_EQ(result.world.models[0].name, "desk");
  EXPECT_TRUE(result.dropped);
}

TEST(WildWorlds, pointers_of_git_lfs_are_called_what_they_are) {
  const WorldFiles files;
  const std::string pointer = "version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 1\n";
  files.write("chair.dae", pointer);
  files.write("wood.png", pointer);
  files.write("lamp/model.sdf", pointer);
  const LoadResult result = files.load(
      model_of("<collision name='c'><geometry><mesh><uri>chair.dae</uri></mesh></geometry></collision>\n"
               "<visual name='v'><geometry><mesh><uri>chair.dae</uri></mesh></geometry></visual>\n"
               "<visual name='w'><geometry><box/></geometry><material><pbr><metal><albedo_map>wood.png</albedo_map></metal></pbr>"
               "</material></visual>") +
      "\n<include><uri>model://lamp</uri></include>");
  ASSERT_EQ(result.findings.size(), 4U) << all_findings(result);
  const std::string fault = "is a Git LFS pointer in place of the file (fetch it with: git lfs pull)";
  EXPECT_EQ(findings_with(result, "w.sdf:3: mesh file \"chair.dae\" of collision \"c\" of link \"l\" of model \"m\" " + fault), 1);
  EXPECT_EQ(findings_with(result, "w.sdf:4: mesh file \"chair.dae\" of visual \"v\" of link \"l\" of model \"m\" " + fault), 1);
  EXPECT_EQ(findings_with(result, "w.sdf:5: texture \"wood.png\" " + fault), 1);
  EXPECT_EQ(findings_with(result, "lamp/model.sdf: " + fault), 1);
  const LinkDef& link = result.world.models.at(0).links.at(0);
  EXPECT_TRUE(link.collisions.empty());
  EXPECT_EQ(link.visuals.size(), 2U);
}

TEST(WildWorlds, materials_that_gazebo_saved_by_default_are_no_findings) {
  const WorldFiles files;
  const LoadResult result = files.load(
      model_of("<visual name='v'><geometry><box/></geometry><material><script><uri>__default__</uri><name>Gazebo/Red</name></script>"
               "<shader type='pixel'><normal_map>__default__</normal_map></shader></material></visual>"));
  EXPECT_TRUE(result.findings.empty()) << all_findings(result);
  EXPECT_EQ(result.world.models.at(0).links.at(0).visuals.at(0).material->script, "Gazebo/Red");
}

TEST(WildWorlds, templates_are_called_what_they_are) {
  const WorldFiles files;
  const base::Result<LoadResult> result = files.load_text(
      "<sdf version='1.6'>\n<world name='w'>\n<% count = 3 %>\n<model name='m'><pose><%= count %> 0 0 0 0 0</pose></model></world></sdf>");
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().message, "w.sdf:3: is an ERB template (<% ... %>); run erb first");
}

TEST(WildWorlds, names_that_clash_are_numbered) {
  const WorldFiles files;
  const LoadResult result = files.load(
      "<model name='m'><link name='l'><collision name='c'><geometry><box/></geometry></collision><collision "
      "name='c'><geometry><box/></geometry></collision></link>"
      "<link name='l'/><link name='world'/><joint name='l' type='fixed'><parent>l</parent><child>world</child></joint></model>"
      "<model name='m'><link name='l'/></model><model name='a::b'><link name='l'/></model>");
  ASSERT_EQ(result.world.models.size(), 3U) << all_findings(result);
  const ModelDef& m = result.world.models[0];
  EXPECT_EQ(m.links.at(0).collisions.at(1).name, "c_1");
  EXPECT_EQ(m.links.at(1).name, "l_1");
  EXPECT_EQ(m.links.at(2).name, "world_link");
  EXPECT_EQ(m.joints.at(0).name, "l") << "a joint may be called like a link";
  EXPECT_EQ(m.joints.at(0).child, "world_link");
  EXPECT_EQ(result.world.models[1].name, "m_1");
  EXPECT_EQ(result.world.models[2].name, "a_b");
  EXPECT_FALSE(result.dropped);
}

TEST(WildWorlds, saved_states_place_their_models) {
  const WorldFiles files;
  const LoadResult result = files.load(
      "<model name='m'><pose>0 0 0 0 0 0</pose><link name='l'/></model><state world_name='w'><sim_time>12 0</sim_time><model "
      "name='m'><pose>7 8 9 0 0 0</pose>"
      "<link name='l'><pose>7 8 9 0 0 0</pose></link></model></state>",
      "1.6");
  EXPECT_EQ(result.world.models.at(0).pose.translation(), Eigen::Vector3d(7, 8, 9));
  EXPECT_TRUE(result.findings.empty()) << all_findings(result);
}

TEST(WildWorlds, joints_whose_child_is_the_world_move_the_other_way_round) {
  const WorldFiles files;
  for (const char* version : {"1.4", "1.6", "1.9"}) {
    const LoadResult result = files.load(
        "<model name='m'><pose>2 0 0 0 0 0</pose><link name='arm'><pose>0 0 1 0 0 0</pose></link><joint name='j' type='revolute'><pose>0 0 "
        "0.5 0 "
        "0 0</pose><parent>arm</parent><child>world</child><axis><xyz>0 1 0</xyz></axis></joint><joint name='k' "
        "type='prismatic'><parent>arm"
        "</parent><child>world</child><axis><xyz>0 0 1</xyz></axis></joint></model>",
        version);
    EXPECT_EQ(findings_with(result, "joint \"j\" of model \"m\" has the world as its child; parent and child are swapped, its place"), 1)
        << version;
    ASSERT_EQ(result.world.models.at(0).joints.size(), 2U) << version << all_findings(result);
    const JointDef& j = *result.world.models[0].joint("j");
    EXPECT_EQ(j.parent, "");
    EXPECT_EQ(j.child, "arm");
    EXPECT_TRUE(j.axes.at(0).xyz.isApprox(-Eigen::Vector3d::UnitY())) << version << j.axes[0].xyz.transpose();
    EXPECT_TRUE(j.pose_in_model.translation().isApprox(Eigen::Vector3d(0, 0, 0.5))) << version << j.pose_in_model.translation().transpose();
    EXPECT_TRUE(result.world.models[0].joint("k")->axes.at(0).xyz.isApprox(-Eigen::Vector3d::UnitZ())) << version;
  }
}

TEST(WildWorlds, imus_that_are_plugins_of_their_own_are_sensors) {
  const WorldFiles files;
  for (const char* file : {"libgazebo_ros_imu.so", "libhector_gazebo_ros_imu.so"}) {
    const std::string parameters =
        "<bodyName>l</bodyName><topicName>imu</topicName><updateRate>50.0</updateRate><gaussianNoise>0.01</gaussianNoise><xyzOffset>1 2 3"
        "</xyzOffset><rpyOffset>0 0 1.5707963</rpyOffset></plugin>";
    const LoadResult result = files.load("<model name='m'><link name='l'/><plugin name='the_imu' filename='" + std::string(file) + "'>" +
                                         parameters + "</model>");
    EXPECT_TRUE(result.findings.empty()) << all_findings(result);
    const auto& sensors = result.world.models.at(0).links.at(0).sensors;
    ASSERT_EQ(sensors.size(), 1U) << file;
    EXPECT_EQ(sensors[0].name, "the_imu");
    EXPECT_EQ(sensors[0].update_rate, 50);
    EXPECT_TRUE(sensors[0].pose.translation().isApprox(Eigen::Vector3d(1, 2, 3)));
    EXPECT_TRUE((sensors[0].pose.linear() * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d::UnitY(), 1e-6));
    EXPECT_EQ(std::get<ImuDef>(sensors[0].data).linear_acceleration[2].stddev, 0.01);
    const LoadResult bad = files.load("<model name='m'><link name='other'/><plugin name='the_imu' filename='" + std::string(file) + "'>" +
                                      parameters + "</model>");
    EXPECT_EQ(findings_with(bad, "names the link \"l\", which does not exist; there is no IMU"), 1) << all_findings(bad);
  }
}

TEST(WildWorlds, the_fluid_of_a_world_is_uniform_or_graded) {
  const WorldFiles files;
  const LoadResult uniform = files.load(
      "<plugin filename='gz-sim-buoyancy-system' "
      "name='gz::sim::systems::Buoyancy'><uniform_fluid_density>1025</uniform_fluid_density><enable>"
      "sub::body</enable></plugin>");
  EXPECT_TRUE(uniform.findings.empty()) << all_findings(uniform);
  ASSERT_TRUE(uniform.world.physics.fluid);
  EXPECT_EQ(uniform.world.physics.fluid->density, 1025);
  EXPECT_EQ(uniform.world.physics.fluid->models, std::vector<std::string>{"sub"});
  const LoadResult graded = files.load(
      "<plugin filename='gz-sim-buoyancy-system' name='gz::sim::systems::Buoyancy'><graded_buoyancy><default_density>1000</default_density>"
      "<density_change><above_depth>0</above_depth><density>1.125</density></density_change></graded_buoyancy></plugin>");
  ASSERT_TRUE(graded.world.physics.fluid);
  EXPECT_EQ(graded.world.physics.fluid->changes, (std::vector<std::pair<double, double>>{{0, 1.125}}));
  const LoadResult of_classic = files.load("<model name='m'><link name='l'/><plugin name='b' filename='libBuoyancyPlugin.so'/></model>");
  EXPECT_EQ(findings_with(of_classic, "libBuoyancyPlugin.so"), 1);
  EXPECT_FALSE(of_classic.world.physics.fluid);
}

TEST(WildWorlds, saved_states_bend_models_and_set_them_going) {
  const WorldFiles files;
  const LoadResult result = files.load(
      "<model name='m'><pose>1 0 0 0 0 0</pose><link name='a'/><link name='b'><pose>0 0 1 0 0 0</pose></link><model name='n'><link "
      "name='c'/>"
      "</model></model><state world_name='w'><model name='m'><pose>7 8 9 0 0 0</pose><link name='a'><pose>7 8 9 0 0 0</pose></link><link "
      "name='b'><pose>7 8 11 0 0 0</pose><velocity>1 2 3 4 5 6</velocity></link><link name='nowhere'><pose>0 0 0 0 0 0</pose></link><model "
      "name='n'><link name='c'><pose>7 9 9 0 0 0</pose><velocity>nan 0 0 0 0 0</velocity></link></model></model></state>",
      "1.6");
  EXPECT_TRUE(result.findings.empty()) << all_findings(result);
  const ModelDef& m = result.world.models.at(0);
  EXPECT_FALSE(m.link("a")->start_pose) << "where it would be anyway";
  ASSERT_TRUE(m.link("b")->start_pose);
  EXPECT_TRUE(m.link("b")->start_pose->translation().isApprox(Eigen::Vector3d(0, 0, 2)));
  EXPECT_EQ(m.link("b")->start_linear, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(m.link("b")->start_angular, Eigen::Vector3d(4, 5, 6));
  EXPECT_FALSE(m.link("n::c")->start_pose) << "a state with a number that is none";
}

TEST(WildWorlds, saved_states_add_take_away_and_move_what_was_included) {
  const WorldFiles files;
  files.write_model("cup", "<model name='cup'><link name='l'/></model>");
  const LoadResult result = files.load(
      "<include><uri>model://cup</uri></include><model name='gone'><link name='l'/></model><light name='lamp' type='point'/>"
      "<state world_name='w'><insertions><model name='new'><pose>1 0 0 0 0 0</pose><link name='l'/></model></insertions>"
      "<deletions><name>gone</name></deletions><model name='cup'><pose>0 0 3 0 0 0</pose></model>"
      "<model name='new'><pose>2 0 0 0 0 0</pose></model><light name='lamp'><pose>0 0 9 0 0 0</pose></light></state>",
      "1.6");
  EXPECT_TRUE(result.findings.empty()) << all_findings(result);
  ASSERT_EQ(result.world.models.size(), 2U);
  EXPECT_EQ(result.world.model("cup")->pose.translation(), Eigen::Vector3d(0, 0, 3));
  EXPECT_EQ(result.world.model("new")->pose.translation(), Eigen::Vector3d(2, 0, 0));
  EXPECT_EQ(result.world.lights.at(0).pose.translation(), Eigen::Vector3d(0, 0, 9));
}

TEST(WildWorlds, names_of_elements_in_camel_case_are_understood) {
  const WorldFiles files;
  const LoadResult result = files.load(model_of("<sensor name='s' type='imu'><updateRate>7</updateRate></sensor>"));
  EXPECT_EQ(result.world.models.at(0).links.at(0).sensors.at(0).update_rate, 7);
  EXPECT_EQ(findings_with(result, "<updateRate> in sensor \"s\" of link \"l\" of model \"m\" is taken as <update_rate>"), 1);
}

TEST(WildWorlds, reflections_of_visuals_count_where_collisions_say_nothing) {
  const WorldFiles files;
  const std::string box = "<geometry><box/></geometry>";
  const LoadResult result =
      files.load(model_of("<collision name='near'>" + box + "</collision><collision name='far'><pose>5 0 0 0 0 0</pose>" + box +
                          "</collision><visual name='v'><laser_retro>500</laser_retro>" + box +
                          "</visual><visual name='w'><pose>4 0 0 0 0 0</pose><laser_retro>20</laser_retro>" + box + "</visual>") +
                 model_of("<collision name='c'><laser_retro>3</laser_retro>" + box +
                              "</collision><visual name='v'><laser_retro>500</laser_retro>" + box + "</visual>",
                          "n"));
  const auto& collisions = result.world.model("m")->links.at(0).collisions;
  EXPECT_EQ(collisions.at(0).laser_retro, 500);
  EXPECT_EQ(collisions.at(1).laser_retro, 20);
  EXPECT_EQ(result.world.model("n")->links.at(0).collisions.at(0).laser_retro, 3);
}

TEST(WildWorlds, unknown_things_get_one_line_each) {
  const WorldFiles files;
  const LoadResult result = files.load(
      "<model name='m'><link name='l'><glitter>1</glitter></link>\n<plugin name='p' filename='libMagic.so'/>\n</model>\n<joint name='j' "
      "type='fixed'><parent>m</parent><child>n</child></joint>");
  EXPECT_EQ(result.world.models.size(), 1U);
  ASSERT_EQ(result.findings.size(), 3U) << all_findings(result);
  EXPECT_EQ(findings_with(result, "w.sdf:3: unknown element <glitter> in link \"l\" of model \"m\" is ignored"), 1) << all_findings(result);
  EXPECT_EQ(findings_with(result, "w.sdf:4: unknown plugin \"libMagic.so\""), 1) << all_findings(result);
  EXPECT_EQ(findings_with(result, "w.sdf:6: joint \"j\" joins models"), 1) << all_findings(result);
}

TEST(Materials, scripts_with_inheritance_and_textures_are_read) {
  const auto materials = parse_material_script(
      "// comment\nmaterial Base\n{\n technique\n {\n  pass main\n  {\n   ambient 0.1 0.2 0.3\n   diffuse 1 0 0 0.5\n   specular 0.5 0.5 "
      "0.5 1 12\n  }\n }\n}\n"
      "material \"My Wall\" : Base { technique { pass { diffuse 0 1 0\n lighting off\n cull_hardware none\n texture_unit { texture "
      "wall.png\n scale 0.5 0.25\n } } pass { diffuse 1 1 1 } } }\n");
  ASSERT_EQ(materials.size(), 2U);
  const MaterialDef& base_material = materials.at("Base");
  EXPECT_EQ(base_material.ambient, (Color{0.1F, 0.2F, 0.3F, 1}));
  EXPECT_EQ(base_material.diffuse, (Color{1, 0, 0, 0.5F}));
  EXPECT_EQ(base_material.shininess, 12);
  const MaterialDef& wall = materials.at("My Wall");
  EXPECT_EQ(wall.ambient, base_material.ambient);
  EXPECT_EQ(wall.diffuse, (Color{0, 1, 0, 1})) << "of the first pass";
  EXPECT_EQ(wall.texture, "wall.png");
  EXPECT_EQ(wall.texture_scale, Eigen::Vector2d(2, 4));
  EXPECT_FALSE(wall.lighting);
  EXPECT_TRUE(wall.double_sided);
}

TEST(Materials, inherit_from_later_ones_and_never_from_themselves) {
  std::map<std::string, std::string> faults;
  const auto materials = parse_material_script(
      "material Child : Parent { technique { pass { texture_unit { texture child.png\n } } } }\n"
      "material Parent { technique { pass { diffuse 0 0 1\n texture_unit { texture parent.png\n } } } }\n"
      "material A : B { technique { pass { diffuse 1 0 0\n } } }\nmaterial B : A { }\nmaterial Own : Own { }\n",
      &faults);
  EXPECT_EQ(materials.at("Child").diffuse, (Color{0, 0, 1, 1}));
  EXPECT_EQ(materials.at("Child").texture, "child.png");
  EXPECT_EQ(materials.at("A").diffuse, (Color{1, 0, 0, 1}));
  EXPECT_THAT(faults, testing::UnorderedElementsAre(testing::Pair("A", "inherits from itself through \"B\""),
                                                    testing::Pair("B", "inherits from itself through \"A\""),
                                                    testing::Pair("Own", "inherits from itself through \"Own\"")));
}

TEST(Materials, that_inherit_in_a_circle_are_told_once_when_used) {
  const WorldFiles files;
  files.write("a.material", "material A : A { technique { pass { diffuse 1 0 0\n } } }");
  const std::string visual =
      "<geometry><box/></geometry><material><script><uri>a.material</uri><name>A</name></script></material></visual>";
  const LoadResult result = files.load(model_of("<visual name='v'>" + visual + "<visual name='w'>" + visual));
  ASSERT_EQ(result.findings.size(), 1U) << all_findings(result);
  EXPECT_THAT(result.findings[0].text(), HasSubstr("material \"A\" inherits from itself"));
  EXPECT_EQ(result.world.models.at(0).links[0].visuals.at(1).material->diffuse, (Color{1, 0, 0, 1}));
}

TEST(Materials, of_visuals_come_from_scripts_built_in_colours_and_pbr) {
  const WorldFiles files;
  files.write("wall/materials/scripts/wall.material", "material Wall { technique { pass { texture_unit { texture wall.png\n } } } }");
  files.write("wall/materials/textures/wall.png", "x");
  files.write("albedo.png", "x");
  const auto visual = [](const std::string& name, const std::string& material) {
    return "<visual name='" + name + "'><geometry><box/></geometry><material>" + material + "</material></visual>";
  };
  const LoadResult result = files.load(model_of(
      visual("script",
             "<script><uri>model://wall/materials/scripts</uri><uri>model://wall/materials/textures</uri><name>Wall</name></script>") +
      visual("built_in", "<script><uri>file://media/materials/scripts/gazebo.material</uri><name>Gazebo/Red</name></script>") +
      visual("no_uri", "<script><name>Gazebo/Green</name></script>") +
      visual("no_name", "<script><uri>file://media/materials/scripts/gazebo.material</uri></script>") +
      visual("plain", "<diffuse>0.2 0.3 0.4 1</diffuse>") +
      visual("pbr", "<pbr><metal><albedo_map>albedo.png</albedo_map><roughness>0.2</roughness></metal></pbr>") +
      visual("unknown", "<script><name>Nothing/Known</name></script>") +
      visual("speaking", "<script><name>Kitchen/WoodFloor</name></script>")));
  ASSERT_EQ(result.world.models.size(), 1U);
  std::map<std::string, MaterialDef> found;
  for (const VisualDef& v : result.world.models[0].links[0].visuals) found[v.name] = v.material.value_or(MaterialDef{});
  ASSERT_EQ(found.size(), 8U) << all_findings(result);
  EXPECT_EQ(found["speaking"].diffuse, (Color{0x8c / 255.0F, 0x61 / 255.0F, 0x38 / 255.0F, 1}));
  EXPECT_THAT(found["script"].texture, testing::EndsWith("wall/materials/textures/wall.png"));
  EXPECT_EQ(found["built_in"].diffuse, (Color{1, 0, 0, 1}));
  EXPECT_EQ(found["no_uri"].diffuse, (Color{0, 1, 0, 1}));
  EXPECT_EQ(found["plain"].diffuse, (Color{0.2F, 0.3F, 0.4F, 1}));
  EXPECT_EQ(found["plain"].ambient, found["plain"].diffuse);
  EXPECT_TRUE(found["pbr"].has_pbr);
  EXPECT_THAT(found["pbr"].texture, testing::EndsWith("albedo.png"));
  EXPECT_FLOAT_EQ(found["pbr"].roughness, 0.2F);
  ASSERT_EQ(result.findings.size(), 2U) << all_findings(result);
  EXPECT_THAT(result.findings[0].text(), HasSubstr("material \"Nothing/Known\" is not known; grey is taken"));
  EXPECT_THAT(result.findings[1].text(), HasSubstr("material \"Kitchen/WoodFloor\" is not known; a plain colour is taken"));
}

TEST(Materials, shininess_of_a_material_is_read_though_the_library_is_older) {
  const WorldFiles files;
  const auto visual = [](const std::string& name, const std::string& shininess) {
    return "<visual name='" + name + "'><geometry><box/></geometry><material><specular>1 1 1 1</specular><shininess>" + shininess +
           "</shininess></material></visual>";
  };
  const LoadResult result = files.load(model_of(visual("good", "30") + visual("bad", "much")));
  ASSERT_EQ(result.world.models.at(0).links.at(0).visuals.size(), 2U);
  EXPECT_EQ(result.world.models[0].links[0].visuals[0].material.value().shininess, 30);
  EXPECT_EQ(result.world.models[0].links[0].visuals[1].material.value().shininess, 0);
  ASSERT_EQ(result.findings.size(), 1U) << all_findings(result);
  EXPECT_THAT(result.findings[0].text(), HasSubstr("must be a number, got \"much\""));
}

TEST(ModelPath, finds_what_uris_mean) {
  const WorldFiles files;
  files.write("models/box/meshes/a.dae", "x");
  const ModelPath path({files.folder()});
  const std::filesystem::path own = files.folder() / "models/box";
  for (const char* uri : {"model://box/meshes/a.dae", "model:///box/meshes/a.dae", "package://box/meshes/a.dae", "$(find box)/meshes/a.dae",
                          "meshes/a.dae", "file://meshes/a.dae",
                          "https://fuel.ignitionrobotics.org/1.0/someone/models/Box/2/files/meshes/a.dae", "model://box/meshes/%61.dae"}) {
    const auto found = path.find(uri, own);
    ASSERT_TRUE(found.has_value()) << uri;
    EXPECT_EQ(found->filename(), "a.dae");
  }
  for (const char* uri : {"", "model://", "model://nothing", "ftp://box/meshes/a.dae", "https://example.com/a.dae"})
    EXPECT_FALSE(path.find(uri, own)) << uri;
  EXPECT_TRUE(path.find("file://" + (own / "meshes/a.dae").string(), "/")) << "absolute";
}

// As `gz fuel download` leaves them: names in lower case, a folder for each version.
TEST(ModelPath, finds_what_gazebo_has_fetched) {
  const WorldFiles files;
  for (const char* version : {"2", "10"}) {
    files.write("fuel.gazebosim.org/openrobotics/models/coke can/" + std::string(version) + "/model.sdf", "x");
  }
  files.write("fuel.gazebosim.org/openrobotics/models/coke can/2/meshes/a.dae", "x");
  ModelPath path;
  path.add_fuel_cache(files.folder());
  const auto found = [&](const std::string& uri) { return path.find(uri, "/").value_or("").string(); };
  for (const std::string uri :
       {"https://fuel.gazebosim.org/1.0/OpenRobotics/models/Coke Can", "https://fuel.gazebosim.org/1.0/openrobotics/models/coke%20can/tip",
        "https://app.gazebosim.org/OpenRobotics/fuel/models/Coke Can", "fuel://fuel.gazebosim.org/openrobotics/models/coke can"}) {
    EXPECT_THAT(found(uri), testing::EndsWith("/coke can/10")) << uri;
  }
  EXPECT_THAT(found("https://fuel.gazebosim.org/1.0/OpenRobotics/models/Coke Can/2"), testing::EndsWith("/coke can/2"));
  EXPECT_THAT(found("https://fuel.gazebosim.org/1.0/OpenRobotics/models/Coke Can/2/files/meshes/a.dae"),
              testing::EndsWith("/2/meshes/a.dae"));
  EXPECT_EQ(found("https://fuel.gazebosim.org/1.0/somebody/models/Coke Can"), "");
  const auto said = [&](const std::string& uri) { return path.other_version(uri, found(uri)); };
  EXPECT_EQ(said("https://fuel.gazebosim.org/1.0/OpenRobotics/models/Coke Can/1"),
            "version 10 of it is taken instead of version 1, which is not here");
  EXPECT_NE(said("https://fuel.gazebosim.org/1.0/OpenRobotics/models/Coke Can/1/files/model.sdf"), "");
  for (const char* end : {"", "/2", "/10", "/tip", "/2/files/meshes/a.dae"})
    EXPECT_EQ(said("https://fuel.gazebosim.org/1.0/OpenRobotics/models/Coke Can" + std::string(end)), "") << end;
}

}  // namespace
}  // namespace sim
