// What hostile, broken and merely wrong files do to the loader: one line each, the rest of the world is there.
#include <gmock/gmock.h>
#include <sys/stat.h>

#include "support/world_files.h"

namespace sim {
namespace {

using testing::HasSubstr;

std::string error_of(const std::string& text) {
  const WorldFiles files;
  const base::Result<LoadResult> result = files.load_text(text);
  return result ? "loaded" : result.error().message;
}

TEST(BadWorld, that_is_no_world_fails_with_one_line) {
  EXPECT_THAT(error_of(""), HasSubstr("is empty"));
  EXPECT_THAT(error_of("not xml at all"), HasSubstr("w.sdf:1: is not well-formed XML"));
  EXPECT_THAT(error_of("<sdf version='1.9'>\n<world name='w'>\n<model name='m'>"), HasSubstr("is not well-formed XML"));
  EXPECT_THAT(error_of("<sdf version='1.9'><world name='w'></sdf>"), HasSubstr("is not well-formed XML"));
  EXPECT_THAT(error_of("<sdf version='1.9'/>"), HasSubstr("a <world> or a <model> is expected"));
  EXPECT_THAT(error_of("<html><body/></html>"), HasSubstr("an <sdf> element is expected"));
  EXPECT_EQ(error_of(std::string("\0\0\0\0garbage", 11)), "w.sdf: is a binary file; SDFormat is text (XML)");
  EXPECT_EQ(error_of(std::string("PK\3\4\0<% %>", 10)), "w.sdf: is a binary file; SDFormat is text (XML)") << "no template";
  EXPECT_THAT(error_of("<sdf><% 3.times do %></sdf>"), HasSubstr("is an ERB template"));
  EXPECT_THAT(error_of("<!-- nothing -->"), HasSubstr("no document element"));
  const base::Result<LoadResult> missing = load_world("/nowhere/at/all.sdf", ModelPath{});
  ASSERT_FALSE(missing.ok());
  EXPECT_EQ(missing.error().message, "/nowhere/at/all.sdf: no such file");
  EXPECT_FALSE(load_world("/tmp", ModelPath{}).ok());
}

TEST(BadWorld, from_before_sdformat_is_called_what_it_is) {
  for (const char* text :
       {"<gazebo version='1.0'><world name='default'/></gazebo>", "<gazebo:world xmlns:gazebo='http://x'><params:foo/></gazebo:world>"}) {
    EXPECT_THAT(error_of(text), HasSubstr("before SDFormat")) << text;
  }
}

// One bad reference costs that reference; the other frames are where they were.
TEST(BadWorld, references_that_lead_nowhere_or_round_leave_the_others_alone) {
  const std::string good =
      "<frame name='good'><pose>5 0 0 0 0 0</pose></frame><model name='a'><pose relative_to='good'>1 0 0 0 0 0</pose><link "
      "name='l'/></model>";
  const std::string link = "<link name='l'/></model>";
  const std::pair<std::string, std::string> bad[] = {
      {"<frame name='b' attached_to='nosuch'/>", "attached to \"nosuch\", which does not exist"},
      {"<frame name='b'><pose relative_to='nosuch'/></frame>", "relative to \"nosuch\", which does not exist"},
      {"<frame name='b' attached_to='b'/>", "attached to \"b\", which leads back to it"},
      {"<frame name='b' attached_to='c'/><frame name='c' attached_to='d'/><frame name='d' attached_to='b'/>", "which leads back to it"},
      {"<frame name='b' attached_to='c'><pose relative_to='good'/></frame><frame name='c' attached_to='b'><pose "
       "relative_to='good'/></frame>",
       "which leads back"},
      {"<model name='b'><pose relative_to='nosuch'>2 0 0 0 0 0</pose>" + link,
       "model \"b\" stands relative to \"nosuch\", which does not exist"},
      {"<model name='b'><pose relative_to='c'/>" + link + "<model name='c'><pose relative_to='b'/>" + link, "which leads back to it"},
      {"<frame name='f' attached_to='b'/><model name='b'><pose relative_to='f'/>" + link, "which leads back to it"},
      {"<light name='b' type='point'><pose relative_to='nosuch'>0 0 3 0 0 0</pose></light>",
       "light \"b\" stands relative to \"nosuch\", which does not exist"},
      {"<model name='b'><frame name='g' attached_to='h'/><frame name='h' attached_to='g'/>" + link, "which leads back to it"},
      {"<model name='b'><link name='k'><pose relative_to='j'/></link><link name='l'/><joint name='j' "
       "type='fixed'><parent>l</parent><child>k</child></joint></model>",
       "link \"k\" of model \"b\" stands relative to \"j\", which leads back to it"},
  };
  const WorldFiles files;
  for (const auto& [text, message] : bad) {
    const LoadResult result = files.load(text + good);
    EXPECT_FALSE(result.dropped) << text;
    ASSERT_EQ(result.findings.size(), 1U) << text;
    EXPECT_THAT(result.findings[0].text(), HasSubstr(message)) << text;
    EXPECT_EQ(result.world.models.size(),
              1U + (text.find("<model name='b'") != std::string::npos) + (text.find("<model name='c'") != std::string::npos))
        << text;
    for (const ModelDef& model : result.world.models) {
      if (model.name == "a") {
        EXPECT_NEAR(model.pose.translation().x(), 6, 1e-12) << text;
      }
    }
  }
}

TEST(BadWorld, does_not_expand_entities) {
  std::string text = "<?xml version='1.0'?>\n<!DOCTYPE sdf [<!ENTITY a 'ha'>";
  for (char c = 'b'; c < 'z'; ++c) {
    text += "<!ENTITY " + std::string(1, c) + " '";
    for (int i = 0; i < 10; ++i) text += "&" + std::string(1, static_cast<char>(c - 1)) + ";";
    text += "'>";
  }
  const WorldFiles files;
  const base::Result<LoadResult> result =
      files.load_text(text + "]><sdf version='1.9'><world name='&y;'><model name='&y;'><link name='l'/></model></world></sdf>");
  ASSERT_TRUE(result.ok()) << result.error().message;
  EXPECT_EQ(result->world.models.at(0).name, "&y;");
  EXPECT_EQ(findings_with(*result, "w.sdf:2: entities"), 1);
}

TEST(BadWorld, refuses_absurd_sizes_of_names_depth_and_number) {
  const std::string giant(10 << 20, 'x');
  const WorldFiles files;
  const LoadResult named = files.load("<model name='" + giant + "'><link name='l'/></model><model name='ok'><link name='l'/></model>");
  EXPECT_EQ(named.world.models.size(), 1U);
  ASSERT_EQ(named.findings.size(), 1U);
  EXPECT_EQ(named.findings[0].text(), "w.sdf:3: name of a <model> has 10485760 characters, at most 200 expected; the element is left out");
  EXPECT_TRUE(named.dropped);
  const LoadResult element = files.load("<" + giant + "/>");
  EXPECT_EQ(element.findings.size(), 1U);
  EXPECT_LT(element.findings.at(0).text().size(), 200U);
  std::string deep;
  for (int i = 0; i < 100000; ++i) deep += "<a>";
  for (int i = 0; i < 100000; ++i) deep += "</a>";
  EXPECT_THAT(error_of("<sdf version='1.9'><world name='w'>" + deep + "</world></sdf>"), HasSubstr("nested deeper"));
  std::string many;
  for (int i = 0; i < 500000; ++i) many += "<a/>";
  EXPECT_THAT(error_of("<sdf version='1.9'><world name='w'>" + many + "</world></sdf>"), HasSubstr("more than 400000 elements"));
}

TEST(BadWorld, that_includes_itself_ends) {
  const WorldFiles files;
  files.write_model("a", "<model name='a'><link name='l'/><include><uri>model://b</uri></include></model>");
  files.write_model("b", "<model name='b'><link name='l'/><include><uri>model://a</uri></include></model>");
  const LoadResult result = files.load("<include><uri>model://a</uri></include>");
  ASSERT_EQ(result.world.models.size(), 1U);
  EXPECT_NE(result.world.models[0].link("b::l"), nullptr);
  EXPECT_EQ(findings_with(result, "includes itself"), 1) << all_findings(result);
  EXPECT_TRUE(result.dropped);
}

TEST(BadWorld, whose_includes_multiply_is_cut) {
  const WorldFiles files;
  files.write_model("m0", "<model name='m0'><link name='l'/></model>");
  for (int i = 1; i < 14; ++i) {
    std::string content = "<model name='m" + std::to_string(i) + "'><link name='l'/>";
    for (int j = 0; j < 10; ++j)
      content += "<include><uri>model://m" + std::to_string(i - 1) + "</uri><name>n" + std::to_string(j) + "</name></include>";
    files.write_model("m" + std::to_string(i), content + "</model>");
  }
  const LoadResult result = files.load("<include><uri>model://m13</uri></include><model name='ok'><link name='l'/></model>");
  EXPECT_TRUE(result.dropped);
  EXPECT_NE(result.world.model("ok"), nullptr);
  EXPECT_GE(findings_with(result, "elements with all it includes"), 1);
}

struct BadValue {
  std::string content;   // of a link
  std::string expected;  // in the one finding
};

TEST(BadWorld, bad_numbers_cost_the_object_they_stand_in_and_nothing_else) {
  const auto shape = [](const std::string& geometry) { return "<collision name='bad'><geometry>" + geometry + "</geometry></collision>"; };
  const std::vector<BadValue> cases{
      {shape("<box><size>1 -1 1</size></box>"),
       "<size> of collision \"bad\" of link \"l\" of model \"m\" must be three positive numbers, got \"1 -1 1\""},
      {shape("<box><size>1 1 0</size></box>"), "must be three positive numbers, got \"1 1 0\""},
      {shape("<box><size>nan 1 1</size></box>"), "got \"nan 1 1\""},
      {shape("<box><size>1 1 inf</size></box>"), "got \"1 1 inf\""},
      {shape("<box><size>1 1</size></box>"), "got \"1 1\""},
      {shape("<box><size>a b c</size></box>"), "got \"a b c\""},
      {shape("<sphere><radius>-1</radius></sphere>"),
       "<radius> of collision \"bad\" of link \"l\" of model \"m\" must be a positive number, got \"-1\""},
      {shape("<sphere><radius>1e308</radius></sphere>"), "got \"1e308\""},
      {shape("<cylinder><radius>1</radius><length>0</length></cylinder>"), "got \"0\""},
      {shape("<cone><radius>1</radius><length>-1</length></cone>"), "got \"-1\""},
      {shape("<capsule><radius>0</radius><length>1</length></capsule>"), "got \"0\""},
      {shape("<ellipsoid><radii>1 0 1</radii></ellipsoid>"), "got \"1 0 1\""},
      {shape("<plane><normal>0 0 0</normal></plane>"), "not all zero"},
      {shape("<mesh><uri>nothing.dae</uri></mesh>"),
       "mesh file \"nothing.dae\" of collision \"bad\" of link \"l\" of model \"m\" is not found"},
      {shape("<polyline><point>0 0</point><point>1 nan</point><point>1 1</point><height>1</height></polyline>"), "got \"1 nan\""},
      {"<collision name='bad'><pose>0 0 nan 0 0 0</pose><geometry><box/></geometry></collision>",
       "<pose> of collision \"bad\" of link \"l\" of model \"m\" must be six finite"},
      {"<visual name='bad'><pose>0 0 1e300 0 0 0</pose><geometry><box/></geometry></visual>", "got \"0 0 1e300 0 0 0\""},
      {"<sensor name='bad' type='ray'><ray><scan><horizontal><samples>-5</samples></horizontal></scan></ray></sensor>", "-5"},
      {"<sensor name='bad' type='ray'><ray><scan><horizontal><samples>100000000</samples></horizontal></scan></ray></sensor>",
       "from 1 to 4000000"},
      {"<sensor name='bad' type='ray'><ray><range><min>5</min><max>1</max></range></ray></sensor>", "above the smallest"},
      {"<sensor name='bad' type='ray'><ray><range><min>nan</min><max>1</max></range></ray></sensor>", "got \"nan\""},
      {"<sensor name='bad' type='camera'><camera><image><width>0</width><height>1</height></image></camera></sensor>", "got \"0\""},
      {"<sensor name='bad' type='camera'><camera><image><width>999999999</width><height>1</height></image></camera></sensor>",
       "from 1 to 16384"},
      {"<sensor name='bad' type='camera'><camera><image><width>12000</width><height>12000</height></image></camera></sensor>",
       "number of pixels of sensor \"bad\" of link \"l\" of model \"m\" must be at most 67108864, got 1.44e+08"},
      {"<sensor name='bad' type='camera'><camera><horizontal_fov>7</horizontal_fov></camera></sensor>", "field of view"},
      {"<sensor name='bad' type='camera'/>", "has no <camera>"},
      {"<sensor name='bad' type='geiger'/>", "sensors of type \"geiger\" are not simulated"},
      {"<sensor name='bad'/>", "has no attribute \"type\""},
      {"<light name='bad' type='laser'/>", "lights of type \"laser\" are not known"},
  };
  const WorldFiles files;
  for (const BadValue& bad : cases) {
    const LoadResult result = files.load(model_of(bad.content + "<collision name='good'><geometry><box/></geometry></collision>"));
    ASSERT_EQ(result.world.models.size(), 1U) << bad.content << "\n" << all_findings(result);
    const LinkDef& link = result.world.models[0].links.at(0);
    const bool is_polyline = bad.content.find("polyline") != std::string::npos;
    EXPECT_EQ(link.collisions.size(), 1U) << bad.content;
    EXPECT_TRUE(link.visuals.empty()) << bad.content;
    EXPECT_TRUE(link.sensors.empty() || !result.dropped) << bad.content;
    EXPECT_TRUE(link.lights.empty()) << bad.content;
    EXPECT_GE(findings_with(result, bad.expected), 1) << bad.content << "\n" << all_findings(result);
    EXPECT_LE(result.findings.size(), is_polyline ? 3U : 1U) << all_findings(result);
    EXPECT_EQ(findings_with(result, "w.sdf:3: "), static_cast<int>(result.findings.size()));
  }
}

TEST(BadWorld, a_bad_pose_costs_the_model) {
  const WorldFiles files;
  for (const char* bad : {"<model name='m'><pose>nan 0 0 0 0 0</pose><link name='l'/></model>",
                          "<model name='m'><link name='l'><pose>0 0 0 inf 0 0</pose></link></model>",
                          "<model name='m'><pose>0 0</pose><link name='l'/></model>", "<model name='m'/>"}) {
    const LoadResult result = files.load(std::string(bad) + "<model name='ok'><link name='l'/></model>");
    EXPECT_EQ(result.world.models.size(), 1U) << bad;
    EXPECT_EQ(result.findings.size(), 1U) << all_findings(result);
    EXPECT_TRUE(result.dropped);
  }
}

TEST(BadWorld, a_bad_pose_in_an_included_file_costs_that_model) {
  const WorldFiles files;
  files.write_model("bad", "<model name='bad'><pose>nan 0 0 0 0 0</pose><link name='l'/></model>");
  const LoadResult result = files.load(
      "<include><uri>model://bad</uri></include><include><uri>model://bad</uri></include><model name='ok'><link name='l'/></model>");
  EXPECT_EQ(result.world.models.size(), 1U);
  EXPECT_TRUE(result.dropped);
}

TEST(BadWorld, bad_masses_are_replaced_with_a_line) {
  const WorldFiles files;
  for (const char* mass : {"0", "-1", "nan", "inf", "1e308", "heavy"}) {
    const LoadResult result = files.load(model_of("<inertial><mass>" + std::string(mass) + "</mass></inertial>"));
    EXPECT_EQ(result.world.models.at(0).links.at(0).mass, 1) << mass;
    ASSERT_EQ(result.findings.size(), 1U) << mass << "\n" << all_findings(result);
    EXPECT_THAT(result.findings[0].text(), HasSubstr("w.sdf:3: ")) << mass;
    EXPECT_THAT(result.findings[0].text(), HasSubstr("mass")) << mass;
  }
}

TEST(BadWorld, joints_that_lead_nowhere_are_left_out) {
  const WorldFiles files;
  const std::string links = "<link name='a'/><link name='b'/>";
  for (const char* joint : {"<joint name='j' type='fixed'><parent>a</parent><child>nothing</child></joint>",
                            "<joint name='j' type='fixed'><parent>a</parent><child>a</child></joint>",
                            "<joint name='j' type='fixed'><parent>a</parent></joint>",
                            "<joint name='j' type='magic'><parent>a</parent><child>b</child></joint>",
                            "<joint name='j' type='revolute'><parent>a</parent><child>b</child><axis><xyz>0 0 0</xyz></axis></joint>",
                            "<joint name='j'><parent>a</parent><child>b</child></joint>"}) {
    const LoadResult result = files.load("<model name='m'>" + links + joint + "</model>");
    ASSERT_EQ(result.world.models.size(), 1U) << joint << "\n" << all_findings(result);
    EXPECT_TRUE(result.world.models[0].joints.empty()) << joint;
    EXPECT_EQ(result.world.models[0].links.size(), 2U);
    EXPECT_EQ(result.findings.size(), 1U) << all_findings(result);
    EXPECT_TRUE(result.dropped);
  }
}

TEST(BadWorld, physics_out_of_bounds_is_ignored) {
  const WorldFiles files;
  for (const char* step : {"0", "-1", "nan", "100", "1e-12"}) {
    const LoadResult result = files.load("<physics type='ode'><max_step_size>" + std::string(step) + "</max_step_size></physics>");
    EXPECT_EQ(result.world.physics.step, 0.001) << step;
    EXPECT_EQ(result.findings.size(), 1U) << all_findings(result);
  }
  const LoadResult gravity = files.load("<gravity>0 0 nan</gravity>");
  EXPECT_EQ(gravity.world.physics.gravity.z(), -9.8);
  EXPECT_EQ(gravity.findings.size(), 1U);
}

TEST(BadWorld, populations_and_roads_that_make_no_sense_are_left_out) {
  const WorldFiles files;
  const std::string model = "<model name='m'><link name='l'/></model>", box = "<box><size>1 1 1</size></box>";
  const auto population = [&](const std::string& content) { return "<population name='p'>" + content + "</population>"; };
  const auto of_kind = [](const std::string& kind) { return "<distribution><type>" + kind + "</type></distribution>"; };
  for (const std::string& bad :
       {population(model + box + "<model_count>2000000000</model_count>" + of_kind("random")),
        population(model + box + "<model_count>-5</model_count>" + of_kind("uniform")),
        population(model + "<model_count>5</model_count>" + of_kind("random")),
        population(model + box + "<model_count>5</model_count>" + of_kind("spiral")),
        population(box + "<model_count>5</model_count>" + of_kind("random")),
        population(model + box + "<distribution><type>grid</type><rows>100000</rows><cols>100000</cols></distribution>"),
        population(model + "<box><size>nan 1 1</size></box><model_count>5</model_count>" + of_kind("random")),
        population("<pose>0 0 inf 0 0 0</pose>" + model + box + "<model_count>5</model_count>" + of_kind("random")),
        std::string("<road name='r'><width>nan</width><point>0 0 0</point></road>"),
        std::string("<road name='r'><width>1</width><point>0 0 0</point><point>1 inf 0</point></road>"), std::string("<road name='r'/>")}) {
    const LoadResult result = files.load(bad + "<model name='ok'><link name='l'/></model>");
    EXPECT_EQ(result.world.models.size(), 1U) << bad;
    EXPECT_EQ(result.findings.size(), 1U) << bad << "\n" << all_findings(result);
    EXPECT_TRUE(result.dropped) << bad;
  }
}

TEST(BadWorld, texts_that_only_look_like_quotes_end) {
  const WorldFiles files;
  for (const char* text :
       {"<sdf version=\"", "<sdf version=\"\"", "<sdf a=\"\"b", "<sdf version=\xe2\x80\x9c", "<sdf version=\xe2\x80\x9c>", "</sdf></sdf>",
        "<sdf version='1.9'></sdf></", "<a b=''>", "<a b=\"\"\"\"/><", "<sdf =", "<sdf ==''=''>"}) {
    EXPECT_FALSE(files.load_text(text).ok()) << text;
  }
}

TEST(BadWorld, joints_with_absurd_numbers_are_mended_or_left_out) {
  const WorldFiles files;
  for (const char* content : {"<axis><xyz>0 0 1</xyz><initial_position>nan</initial_position></axis>",
                              "<axis><xyz>0 0 1</xyz><initial_position>1e300</initial_position></axis>"}) {
    const LoadResult result = files.load(
        "<model name='m'><link name='a'/><link name='b'/><joint name='j' "
        "type='revolute'><parent>a</parent><child>b</child>" +
            std::string(content) + "</joint></model>",
        "1.6");
    ASSERT_EQ(result.world.models.at(0).joints.size(), 1U);
    EXPECT_EQ(result.world.models[0].joints[0].axes[0].initial_position, 0);
    EXPECT_EQ(result.findings.size(), 1U) << all_findings(result);
  }
  const LoadResult screw = files.load(
      "<model name='m'><link name='a'/><link name='b'/><joint name='j' type='screw'><parent>a</parent><child>b</child><axis><xyz>0 0 "
      "1</xyz></axis><screw_thread_pitch>0</screw_thread_pitch></joint></model>");
  ASSERT_EQ(screw.world.models.at(0).joints.size(), 1U);
  EXPECT_EQ(screw.world.models[0].joints[0].thread_pitch, 0) << "a nut that only turns";
}

TEST(BadWorld, references_to_nothing_are_named) {
  const WorldFiles files;
  const LoadResult result = files.load(
      "<model name='a' canonical_link='nothing'><link name='l'><pose relative_to='nobody'>1 0 0 0 0 0</pose></link></model>\n"
      "<model name='b'><pose relative_to='nowhere'>1 0 0 0 0 0</pose><link name='l'/></model>\n"
      "<include><uri>model://nothing</uri></include>\n<include/>");
  EXPECT_EQ(result.world.models.size(), 2U) << all_findings(result);
  EXPECT_EQ(findings_with(result, "\"nothing\"") + findings_with(result, "model://nothing"), 2) << all_findings(result);
  EXPECT_EQ(findings_with(result, "nobody"), 1);
  EXPECT_GE(findings_with(result, "nowhere"), 1) << all_findings(result);
  EXPECT_EQ(findings_with(result, "no <uri>"), 1);
}

TEST(BadWorld, pipes_are_no_meshes) {
  const WorldFiles files;
  ASSERT_EQ(mkfifo((files.folder() / "pipe.dae").c_str(), 0600), 0);
  const LoadResult result = files.load(model_of("<collision name='c'><geometry><mesh><uri>pipe.dae</uri></mesh></geometry></collision>"));
  EXPECT_TRUE(result.dropped);
  EXPECT_EQ(findings_with(result, "\"pipe.dae\" of collision \"c\" of link \"l\" of model \"m\" is not found"), 1) << all_findings(result);
  EXPECT_TRUE(result.world.models.at(0).links[0].collisions.empty());
}

TEST(BadWorld, a_mesh_that_names_no_file_is_left_out) {
  const LoadResult result =
      WorldFiles().load(model_of("<collision name='c'><geometry><mesh><filename>a.dae</filename></mesh></geometry></collision>"));
  EXPECT_TRUE(result.dropped);
  EXPECT_EQ(findings_with(result, "has no <uri>; the collision is left out"), 1) << all_findings(result);
}

TEST(BadWorld, parallel_axes_of_a_joint_are_mended) {
  for (const std::string type : {"revolute2", "universal"}) {
    for (const std::string axis2 : {"", "<axis2/>", "<axis2><xyz>0 0 -1</xyz></axis2>", "<axis2><xyz>0.0005 0 1</xyz></axis2>"}) {
      const LoadResult result =
          WorldFiles().load("<model name='m'><link name='a'/><link name='b'/><joint name='j' type='" + type +
                            "'><parent>a</parent><child>b</child><axis><xyz>0 0 1</xyz></axis>" + axis2 + "</joint></model>");
      const JointDef& joint = result.world.models.at(0).joints.at(0);
      EXPECT_NEAR(joint.axes.at(0).xyz.dot(joint.axes.at(1).xyz), 0, 1e-9) << type << axis2;
      EXPECT_EQ(findings_with(result, "parallel axes"), 1) << all_findings(result);
    }
  }
}

TEST(BadWorld, impossible_numbers_of_drives_have_one_line_each_and_their_defaults) {
  const auto plugin = [](const std::string& file, const std::string& content) {
    return "<plugin filename='gz-sim-" + file + "-system' name='p'>" + content + "</plugin>";
  };
  struct Bad {
    const char *file, *element, *value, *expected;
  };
  for (const Bad& bad : {
           Bad{"diff-drive", "wheel_radius", "wide", "a number"},
           Bad{"diff-drive", "wheel_separation", "", "a number"},
           Bad{"diff-drive", "wheel_separation", "1e300", "a number within 1e9"},
           Bad{"lift-drag", "cp", "0 0 -1e10", "three numbers below 1e9"},
           Bad{"diff-drive", "max_linear_velocity", "-1", "a number of 0 or more"},
           Bad{"diff-drive", "max_wheel_torque", "0", "a positive number"},
           Bad{"ackermann-steering", "steering_limit", "-0.5", "a positive number"},
           Bad{"mecanum-drive", "wheelbase", "0.4 m", "a number"},
           Bad{"tracked-vehicle", "odom_publish_frequency", "often", "a number of 0 or more"},
           Bad{"velocity-control", "initial_linear", "1 0", "three numbers"},
           Bad{"thruster", "propeller_diameter", "0", "a positive number"},
           Bad{"thruster", "thrust_coefficient", "0", "a number other than 0"},
           Bad{"multicopter-motor-model", "motorConstant", "-8e-6", "a positive number"},
           Bad{"multicopter-motor-model", "maxRotVelocity", "nan", "a positive number"},
           Bad{"multicopter-control", "velocityGain", "1 1", "three numbers of 0 or more"},
           Bad{"lift-drag", "area", "0", "a positive number"},
           Bad{"odometry-publisher", "gaussian_noise", "-0.1", "a number of 0 or more"},
           Bad{"odometry-publisher", "dimensions", "7", "2 or 3"},
       }) {
    const std::string element = bad.element, value = bad.value;
    const LoadResult result =
        WorldFiles().load("<model name='m'><link name='l'/>" +
                          plugin(bad.file, "<" + element + ">" + value + "</" + element + "><topic>t</topic>") + "</model>");
    EXPECT_EQ(result.findings.size(), 1U) << bad.file << " " << element << all_findings(result);
    EXPECT_EQ(findings_with(result, "<" + element + "> of plugin \"p\" of model \"m\" must be " + bad.expected + ", got \"" + value +
                                        "\"; its default is taken"),
              1)
        << all_findings(result);
    const ParameterNode& kept = result.world.models.at(0).plugins.at(0).parameters;
    EXPECT_EQ(kept.child(element), nullptr);
    EXPECT_EQ(kept.text_of({"topic"}), "t");
  }
  const LoadResult nested = WorldFiles().load(
      "<model name='m'><link name='l'/>" +
      plugin("multicopter-control",
             "<rotorConfiguration><rotor><jointName>j</jointName><direction>0</direction></rotor></rotorConfiguration>") +
      plugin("tracked-vehicle", "<linear_velocity><min_velocity>-1</min_velocity><max_velocity>inf</max_velocity></linear_velocity>") +
      "</model>");
  EXPECT_EQ(nested.findings.size(), 1U) << all_findings(nested);
  EXPECT_EQ(findings_with(nested, "<direction> of plugin \"p\" of model \"m\" must be 1 or -1, got \"0\""), 1) << all_findings(nested);
}

TEST(BadWorld, plugins_in_the_wrong_place_have_one_line_each) {
  const std::string box = "<model name='m'><link name='l'/>", drive = "<plugin filename='gz-sim-diff-drive-system' name='p'/>",
                    water =
                        "<plugin filename='gz-sim-buoyancy-system' name='p'><uniform_fluid_density>1000</uniform_fluid_density></plugin>",
                    push = "<plugin filename='gz-sim-apply-link-wrench-system' name='p'/>",
                    wheels = "<plugin filename='gz-sim-wheel-slip-system' name='p'>";
  const std::string slip =
      "<wheel link_name='l'><slip_compliance_lateral>1</slip_compliance_lateral><wheel_normal_force>N</wheel_normal_force>"
      "<wheel_radius>0.1</wheel_radius></wheel>";
  const auto slip_of = [&](const std::string& force) { return std::string(slip).replace(slip.find(">N<") + 1, 1, force); };
  for (const auto& [content, expected] : {
           std::pair{drive + box + "</model>", "plugin \"p\" means a model, but stands in the world; it is ignored"},
           std::pair{box + water + "</model>", "plugin \"p\" of model \"m\" means the world, but stands in a model; it is ignored"},
           std::pair{box + push + "</model>", "plugin \"p\" of model \"m\" means the world, but stands in a model; it is ignored"},
           std::pair{std::string("<plugin filename='gz-sim-buoyancy-system' name='p'><graded_buoyancy><density_change><density>1</density>"
                                 "</density_change></graded_buoyancy></plugin>"),
                     "plugin \"p\": a <density_change> needs a number <above_depth>; it is left out"},
           std::pair{water + water, "plugin \"p\" is the second one that fills the world; the last one counts"},
           std::pair{"<plugin filename='gz-sim-apply-link-wrench-system' name='p'><persistent><entity_name>m</entity_name>"
                     "<force>1e8 0 0</force></persistent></plugin>" +
                         box + "</model>",
                     "<force> of plugin \"p\" must be three numbers below 1e7, got \"1e8 0 0\"; its default is taken"},
           std::pair{box + wheels + "</plugin></model>", "plugin \"p\" of model \"m\" needs a <wheel>; it does nothing"},
           std::pair{box + wheels + slip_of("heavy") + "</plugin></model>",
                     "plugin \"p\" of model \"m\": wheel \"l\" needs a positive wheel_normal_force, got \"heavy\"; it does not slip"},
           std::pair{box + wheels + slip_of("8") + slip_of("9") + "</plugin></model>",
                     "plugin \"p\" of model \"m\": wheel \"l\" slips already; it is left out"},
       }) {
    const LoadResult result = WorldFiles().load(content);
    EXPECT_EQ(result.findings.size(), 1U) << content << all_findings(result);
    EXPECT_EQ(findings_with(result, expected), 1) << expected << all_findings(result);
  }
}

TEST(BadWorld, a_flood_of_findings_is_cut) {
  const WorldFiles files;
  std::string content;
  for (int i = 0; i < 1500; ++i) content += "<nonsense" + std::to_string(i) + "/>\n";
  const LoadResult result = files.load(content);
  EXPECT_EQ(result.findings.size(), 501U);
  EXPECT_THAT(result.findings.back().text(), HasSubstr("1000 more findings"));
}

}  // namespace
}  // namespace sim
