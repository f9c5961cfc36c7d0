#include "world/world_loader.h"

#include <gmock/gmock.h>

#include <numbers>

#include "base/base64.h"
#include "support/world_files.h"
#include "world/iface_names.h"
#include "world/plugin_kind.h"

namespace sim {
namespace {

constexpr double pi = std::numbers::pi;

template <class Shape>
Shape shape_of(const std::string& geometry) {
  const WorldFiles files;
  files.write("a.dae", "x");
  files.write("h.png", base::from_base64("iVBORw0KGgoAAAANSUhEUgAAAAIAAAACCAAAAABX3VL4AAAADElEQVR42mNg+A+EAAYAAf+tLDclAAAAAElFTkSuQmCC"));
  const LoadResult result = files.load(model_of("<collision name='c'><geometry>" + geometry + "</geometry></collision>"));
  EXPECT_FALSE(result.dropped) << all_findings(result);
  if (result.world.models.size() != 1 || result.world.models[0].links[0].collisions.size() != 1) {
    ADD_FAILURE() << "no collision for " << geometry;
    return {};
  }
  const GeometryDef& built = result.world.models[0].links[0].collisions[0].geometry;
  EXPECT_TRUE(std::holds_alternative<Shape>(built)) << kind_of(built);
  return std::holds_alternative<Shape>(built) ? std::get<Shape>(built) : Shape{};
}

TEST(WorldGeometry, every_kind_is_read) {
  EXPECT_EQ(shape_of<BoxShape>("<box><size>1 2 3</size></box>").size, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(shape_of<SphereShape>("<sphere><radius>0.5</radius></sphere>").radius, 0.5);
  const auto cylinder = shape_of<CylinderShape>("<cylinder><radius>0.5</radius><length>2</length></cylinder>");
  EXPECT_EQ(cylinder.radius, 0.5);
  EXPECT_EQ(cylinder.length, 2);
  const auto capsule = shape_of<CapsuleShape>("<capsule><radius>0.25</radius><length>3</length></capsule>");
  EXPECT_EQ(capsule.radius, 0.25);
  EXPECT_EQ(capsule.length, 3);
  const auto cone = shape_of<ConeShape>("<cone><radius>0.25</radius><length>3</length></cone>");
  EXPECT_EQ(cone.radius, 0.25);
  EXPECT_EQ(cone.length, 3);
  EXPECT_EQ(shape_of<EllipsoidShape>("<ellipsoid><radii>1 2 3</radii></ellipsoid>").radii, Eigen::Vector3d(1, 2, 3));
  const auto plane = shape_of<PlaneShape>("<plane><normal>0 0 2</normal><size>5 6</size></plane>");
  EXPECT_EQ(plane.normal, Eigen::Vector3d(0, 0, 1));
  EXPECT_EQ(plane.size, Eigen::Vector2d(5, 6));
  const auto mesh =
      shape_of<MeshShape>("<mesh><uri>a.dae</uri><scale>1 2 -3</scale><submesh><name>part</name><center>true</center></submesh></mesh>");
  EXPECT_EQ(std::filesystem::path(mesh.path).filename(), "a.dae");
  EXPECT_TRUE(std::filesystem::path(mesh.path).is_absolute());
  EXPECT_EQ(mesh.scale, Eigen::Vector3d(1, 2, -3));
  EXPECT_EQ(mesh.submesh, "part");
  EXPECT_TRUE(mesh.center_submesh);
  const auto map = shape_of<HeightmapShape>(
      "<heightmap><uri>h.png</uri><size>10 10 2</size><pos>1 2 "
      "3</pos><texture><size>4</size><diffuse>h.png</diffuse><normal>h.png</normal></texture>"
      "<texture><diffuse>h.png</diffuse><normal>h.png</normal></texture><blend><min_height>1</min_height><fade_dist>2</fade_dist></blend></"
      "heightmap>");
  EXPECT_EQ(map.size, Eigen::Vector3d(10, 10, 2));
  EXPECT_EQ(map.position, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(map.textures.size(), 2U);
  EXPECT_EQ(map.blends.size(), 1U);
  const auto polyline = shape_of<PolylineShape>(
      "<polyline><point>0 0</point><point>1 0</point><point>1 1</point><point>0 0</point><height>2</height></polyline>");
  ASSERT_EQ(polyline.outlines.size(), 1U);
  EXPECT_EQ(polyline.outlines[0].size(), 3U) << "the closing point is not repeated";
  EXPECT_EQ(polyline.height, 2);
}

TEST(WorldGeometry, surfaces_are_read) {
  const WorldFiles files;
  const LoadResult result =
      files.load(model_of("<collision "
                          "name='c'><laser_retro>7</laser_retro><geometry><box/></geometry><surface><friction><ode><mu>-1</mu><mu2>0.5</"
                          "mu2><fdir1>0 2 0</fdir1>"
                          "<slip1>0.1</slip1></ode></friction><bounce><restitution_coefficient>0.5</"
                          "restitution_coefficient><threshold>0.01</threshold></bounce><contact>"
                          "<collide_bitmask>0x02</collide_bitmask><ode><kp>1e5</kp><kd>10</kd><max_vel>0.2</max_vel><min_depth>0.001</"
                          "min_depth></ode></contact></surface></collision>"));
  const CollisionDef& collision = result.world.models.at(0).links.at(0).collisions.at(0);
  EXPECT_EQ(collision.surface.mu, infinite) << "-1 means that it never slips";
  EXPECT_EQ(collision.surface.mu2, 0.5);
  EXPECT_EQ(collision.surface.friction_direction, Eigen::Vector3d(0, 1, 0));
  EXPECT_EQ(collision.surface.slip1, 0.1);
  EXPECT_EQ(collision.surface.restitution, 0.5);
  EXPECT_EQ(collision.surface.bounce_threshold, 0.01);
  EXPECT_EQ(collision.surface.kp, 1e5);
  EXPECT_EQ(collision.surface.kd, 10);
  EXPECT_EQ(collision.surface.max_vel, 0.2);
  EXPECT_EQ(collision.surface.min_depth, 0.001);
  EXPECT_EQ(collision.surface.collide_bitmask, 2);
  EXPECT_EQ(collision.laser_retro, 7);
  EXPECT_TRUE(result.findings.empty()) << all_findings(result);
}

TEST(WorldJoints, every_kind_is_read) {
  const WorldFiles files;
  std::string model = "<model name='m'><link name='a'/>";
  int i = 0;
  for (const char* kind : {"fixed", "revolute", "continuous", "prismatic", "ball", "universal", "revolute2", "screw", "gearbox"}) {
    const std::string n = std::to_string(i++);
    model += "<link name='l" + n + "'/><joint name='" + kind + "' type='" + kind + "'><parent>a</parent><child>l" + n +
             "</child><axis><xyz>0 1 0</xyz></axis><axis2><xyz>1 0 "
             "0</xyz></axis2><gearbox_ratio>3</gearbox_ratio><gearbox_reference_body>a</gearbox_reference_body></joint>";
  }
  const LoadResult result = files.load(model + "</model>");
  ASSERT_EQ(result.world.models.size(), 1U) << all_findings(result);
  const ModelDef& m = result.world.models[0];
  ASSERT_EQ(m.joints.size(), 9U) << all_findings(result);
  EXPECT_EQ(m.joint("fixed")->axes.size(), 0U);
  EXPECT_EQ(m.joint("revolute")->axes.size(), 1U);
  EXPECT_EQ(m.joint("revolute")->axes[0].xyz, Eigen::Vector3d(0, 1, 0));
  EXPECT_EQ(m.joint("continuous")->kind, JointDef::Kind::continuous);
  EXPECT_EQ(m.joint("prismatic")->kind, JointDef::Kind::prismatic);
  EXPECT_EQ(m.joint("ball")->axes.size(), 0U);
  EXPECT_EQ(m.joint("universal")->axes.size(), 2U);
  EXPECT_EQ(m.joint("revolute2")->axes[1].xyz, Eigen::Vector3d(1, 0, 0));
  EXPECT_EQ(m.joint("screw")->axes.size(), 1U);
  EXPECT_EQ(m.joint("gearbox")->gearbox_ratio, 3);
  EXPECT_EQ(m.joint("gearbox")->gearbox_reference, "a");
}

TEST(WorldJoints, limits_dynamics_and_frames_are_read) {
  const WorldFiles files;
  const LoadResult result = files.load(
      "<model name='m'><pose>5 0 0 0 0 0</pose><link name='a'><pose>0 0 1 0 0 0</pose></link><link name='b'><pose>1 0 1 0 0 "
      "1.5707963267948966</pose></link>"
      "<joint name='j' type='revolute'><pose>0 0.5 0 0 0 0</pose><parent>a</parent><child>b</child><axis><xyz expressed_in='__model__'>0 1 "
      "0</xyz>"
      "<limit><lower>-1</lower><upper>2</upper><effort>3</effort><velocity>-1</velocity></limit><dynamics><damping>0.1</"
      "damping><friction>0.2</friction>"
      "<spring_reference>0.3</spring_reference><spring_stiffness>0.4</spring_stiffness></dynamics></axis></joint></model>");
  const JointDef& joint = result.world.models.at(0).joints.at(0);
  EXPECT_EQ(joint.parent, "a");
  EXPECT_EQ(joint.child, "b");
  // The joint stands half a metre along b's y, which is the model's -x.
  EXPECT_TRUE(joint.pose_in_model.translation().isApprox(Eigen::Vector3d(0.5, 0, 1))) << joint.pose_in_model.translation();
  EXPECT_TRUE(joint.pose_in_child.translation().isApprox(Eigen::Vector3d(0, 0.5, 0)));
  EXPECT_TRUE(joint.axes[0].xyz.isApprox(Eigen::Vector3d(1, 0, 0))) << "the model's y is the joint's x";
  EXPECT_EQ(joint.axes[0].lower, -1);
  EXPECT_EQ(joint.axes[0].upper, 2);
  EXPECT_EQ(joint.axes[0].effort, 3);
  EXPECT_EQ(joint.axes[0].velocity, infinite) << "negative means none";
  EXPECT_EQ(joint.axes[0].damping, 0.1);
  EXPECT_EQ(joint.axes[0].friction, 0.2);
  EXPECT_EQ(joint.axes[0].spring_reference, 0.3);
  EXPECT_EQ(joint.axes[0].spring_stiffness, 0.4);
}

TEST(World, physics_scene_and_place_are_read) {
  const WorldFiles files;
  const LoadResult result = files.load(
      "<physics "
      "type='ode'><max_step_size>0.005</max_step_size><real_time_factor>2</real_time_factor><ode><solver><type>quick</type><iters>30</"
      "iters></solver>"
      "<constraints><erp>0.3</erp></constraints></ode></physics><gravity>0 0 -1.6</gravity><scene><ambient>0.1 0.2 0.3 "
      "1</ambient><background>0 0 1 1</background>"
      "<shadows>false</shadows><sky/><fog><type>linear</type><start>2</start></fog></scene><spherical_coordinates><latitude_deg>36.1</"
      "latitude_deg>"
      "<longitude_deg>140.1</longitude_deg><elevation>25</elevation><heading_deg>180</heading_deg></spherical_coordinates>"
      "<light name='lamp' type='spot'><pose>1 2 3 0 0 0</pose><diffuse>1 0 0 1</diffuse><spot><outer_angle>1</outer_angle></spot></light>");
  const WorldDef& world = result.world;
  EXPECT_EQ(world.name, "w");
  EXPECT_EQ(world.physics.step, 0.005);
  EXPECT_EQ(world.physics.real_time_factor, 2);
  EXPECT_EQ(world.physics.solver, PhysicsDef::Solver::iterative);
  EXPECT_EQ(world.physics.iterations, 30);
  EXPECT_EQ(world.physics.erp, 0.3);
  EXPECT_EQ(world.physics.gravity.z(), -1.6);
  EXPECT_EQ(world.scene.background, (Color{0, 0, 1, 1}));
  EXPECT_FALSE(world.scene.shadows);
  EXPECT_TRUE(world.scene.sky.has_value());
  EXPECT_EQ(world.scene.fog->start, 2);
  EXPECT_EQ(world.spherical.latitude, 36.1);
  EXPECT_NEAR(world.spherical.heading, pi, 1e-12);
  ASSERT_EQ(world.lights.size(), 1U);
  EXPECT_EQ(world.lights[0].kind, LightDef::Kind::spot);
  EXPECT_EQ(world.lights[0].pose.translation(), Eigen::Vector3d(1, 2, 3));
  EXPECT_TRUE(result.findings.empty()) << all_findings(result);
}

TEST(World, old_versions_are_translated) {
  const WorldFiles files;
  // In 1.4 gravity stood in the physics, and joint axes were meant in the model's frame.
  const LoadResult result = files.load(
      "<physics type='ode'><gravity>0 0 -5</gravity><max_step_size>0.002</max_step_size></physics>\n"
      "<model name='m'><link name='a'/><link name='b'><pose>0 0 0 0 0 1.5707963267948966</pose></link>\n"
      "<joint name='j' type='revolute'><parent>a</parent><child>b</child><axis><xyz>0 1 0</xyz></axis></joint>\n"
      "<model_without_meaning/></model>",
      "1.4");
  EXPECT_EQ(result.world.physics.gravity.z(), -5);
  EXPECT_EQ(result.world.physics.step, 0.002);
  EXPECT_TRUE(result.world.models.at(0).joints.at(0).axes.at(0).xyz.isApprox(Eigen::Vector3d(1, 0, 0)));
  ASSERT_EQ(result.findings.size(), 1U) << all_findings(result);
  EXPECT_EQ(result.findings[0].text(), "w.sdf:6: unknown element <model_without_meaning> in model \"m\" is ignored")
      << "lines survive the translation";
}

TEST(World, actors_are_read) {
  const WorldFiles files;
  files.write("cow.obj", "x");
  const LoadResult result = files.load(
      "<actor "
      "name='cow'><skin><filename>cow.obj</filename><scale>2</scale></skin><script><loop>true</loop><delay_start>1</"
      "delay_start><auto_start>true</auto_start>"
      "<trajectory id='0' type='walk'><waypoint><time>0</time><pose>0 0 0 0 0 0</pose></waypoint><waypoint><time>4</time><pose>4 0 0 0 0 "
      "1</pose></waypoint>"
      "</trajectory></script></actor>");
  const ActorDef& actor = result.world.actors.at(0);
  EXPECT_EQ(actor.name, "cow");
  EXPECT_EQ(std::filesystem::path(actor.skin).filename(), "cow.obj");
  EXPECT_EQ(actor.skin_scale, 2);
  EXPECT_EQ(actor.delay_start, 1);
  EXPECT_EQ(actor.trajectories.at(0).waypoints.at(1).time, 4);
  EXPECT_EQ(actor.trajectories.at(0).waypoints.at(1).pose.translation().x(), 4);
  EXPECT_TRUE(result.findings.empty()) << all_findings(result);
}

TEST(World, plugins_keep_their_parameters_in_order) {
  const WorldFiles files;
  const LoadResult result = files.load(
      "\n<model name='m'><link name='l'/><plugin name='drive' "
      "filename='libDiffDrivePlugin.so'><leftJoint>a</leftJoint><rightJoint>b</rightJoint>"
      "<wheelSeparation>0.3</wheelSeparation><on>true</on><deep x='1'><deeper>2</deeper></deep></plugin></model>");
  const PluginDef& plugin = result.world.models.at(0).plugins.at(0);
  EXPECT_EQ(plugin.source, "w.sdf:4");
  EXPECT_EQ(plugin.parameters.text_of({"left_joint", "leftJoint"}), "a");
  EXPECT_EQ(plugin.parameters.number_of({"wheel_separation", "wheelSeparation"}), 0.3);
  EXPECT_EQ(plugin.parameters.bool_of({"on"}), true);
  EXPECT_EQ(plugin.parameters.child("deep")->attribute("x"), "1");
  EXPECT_EQ(plugin.parameters.child("deep")->children.at(0).text, "2");
  EXPECT_EQ(plugin.parameters.children.at(1).name, "rightJoint");
  EXPECT_EQ(iface_own_name(plugin), "drive");
  EXPECT_EQ(kind_of(plugin), PluginKind::differential_drive);
}

TEST(WorldPlugins, are_known_under_the_names_of_all_simulators) {
  for (const char* name :
       {"libDiffDrivePlugin.so", "libgazebo_ros_diff_drive.so", "gz-sim-diff-drive-system", "ignition-gazebo-diff-drive-system",
        "ignition-gazebo6-diff-drive-system", "libgz-sim8-diff-drive-system.so", "libignition-gazebo-diff-drive-system.so"}) {
    EXPECT_EQ(kind_of_plugin(name, "x"), PluginKind::differential_drive) << name;
  }
  for (const char* name : {"libSkidSteerDrivePlugin.so", "libgazebo_ros_skid_steer_drive.so"})
    EXPECT_EQ(kind_of_plugin(name, "x"), PluginKind::skid_steer_drive) << name;
  for (const char* name : {"gz-sim-velocity-control-system", "libgazebo_ros_planar_move.so"})
    EXPECT_EQ(kind_of_plugin(name, "x"), PluginKind::velocity_control) << name;
  EXPECT_EQ(kind_of_plugin("gz-sim-trajectory-follower-system", "x"), PluginKind::trajectory_follower);
  EXPECT_EQ(kind_of_plugin("rtmsim-omni-drive", "OmniDrive"), PluginKind::omni_drive);
  EXPECT_EQ(kind_of_plugin("something", "gz::sim::systems::DiffDrive"), PluginKind::differential_drive);
  for (const char* name :
       {"gz-sim-physics-system", "ignition-gazebo-scene-broadcaster-system", "libgazebo_ros_laser.so", "gz-sim-imu-system"}) {
    EXPECT_EQ(kind_of_plugin(name, "x"), PluginKind::implied) << name;
  }
  for (const char* name : {"gz-sim-ackermann-steering-system", "libgazebo_ros_ackermann_drive.so"})
    EXPECT_EQ(kind_of_plugin(name, "x"), PluginKind::car_drive) << name;
  EXPECT_EQ(kind_of_plugin("libSimpleTrackedVehiclePlugin.so", "x"), PluginKind::tracked_vehicle);
  EXPECT_EQ(kind_of_plugin("gz-sim-tracked-vehicle-system", "x"), PluginKind::tracked_vehicle);
  EXPECT_EQ(kind_of_plugin("gz-sim-track-controller-system", "x"), PluginKind::track_controller);
  EXPECT_EQ(kind_of_plugin("libgazebo_ros_tricycle_drive.so", "x"), PluginKind::tricycle_drive);
  EXPECT_EQ(kind_of_plugin("ignition-gazebo-mecanum-drive-system", "x"), PluginKind::mecanum_drive);
  EXPECT_EQ(kind_of_plugin("libWheelSlipPlugin.so", "x"), PluginKind::wheel_slip);
  EXPECT_EQ(kind_of_plugin("gz-sim-odometry-publisher-system", "x"), PluginKind::odometry_publisher);
  EXPECT_EQ(kind_of_plugin("libgazebo_ros_joint_state_publisher.so", "x"), PluginKind::joint_state_publisher);
  for (const char* name : {"libRayPlugin.so", "libgazebo_ros_velodyne_gpu_laser.so", "libgazebo_ros_block_laser.so"})
    EXPECT_EQ(kind_of_plugin(name, "x"), PluginKind::implied) << name;
  for (const char* name : {"gz-sim-multicopter-motor-model-system", "libignition-gazebo-multicopter-motor-model-system.so",
                           "librotors_gazebo_motor_model.so", "libgazebo_motor_model.so"})
    EXPECT_EQ(kind_of_plugin(name, "x"), PluginKind::rotor) << name;
  EXPECT_EQ(kind_of_plugin("libignition-gazebo-multicopter-control-system.so", "x"), PluginKind::multicopter_control);
  for (const char* name : {"ignition-gazebo-lift-drag-system", "libLiftDragPlugin.so"})
    EXPECT_EQ(kind_of_plugin(name, "x"), PluginKind::lift_drag) << name;
  for (const char* name : {"gz-sim-thruster-system", "ignition-gazebo-thruster-system"})
    EXPECT_EQ(kind_of_plugin(name, "x"), PluginKind::thruster) << name;
  EXPECT_EQ(kind_of_plugin("gz-sim-hydrodynamics-system", "x"), PluginKind::hydrodynamics);
  EXPECT_EQ(kind_of_plugin("libgazebo_ros_p3d.so", "truth"), PluginKind::implied);
  EXPECT_EQ(kind_of_plugin("gz-sim-lighter_than_air_dynamics-system", "x"), PluginKind::lighter_than_air);
  EXPECT_EQ(kind_of_plugin("gz-sim-advanced-lift-drag-system", "x"), PluginKind::advanced_lift_drag);
  EXPECT_EQ(kind_of_plugin("ignition-gazebo-buoyancy-engine-system", "x"), PluginKind::buoyancy_engine);
  EXPECT_EQ(kind_of_plugin("libSimpleHydrodynamics.so", "vrx::SimpleHydrodynamics"), PluginKind::hydrodynamics);
  EXPECT_EQ(kind_of_plugin("libSurface.so", "vrx::Surface"), PluginKind::floating_hull);
  EXPECT_EQ(kind_of_plugin("gz-sim-apply-joint-force-system", "x"), PluginKind::joint_force);
  EXPECT_EQ(kind_of_plugin("gz-sim-apply-link-wrench-system", "x"), PluginKind::link_wrench);
  EXPECT_EQ(kind_of_plugin("libMyOwn.so", "diff_drive"), PluginKind::unknown);
}

TEST(WorldIncludes, name_pose_and_static_of_the_include_win) {
  const WorldFiles files;
  files.write_model("crate", "<model name='crate'><pose>9 9 9 0 0 0</pose><link name='l'/></model>");
  const LoadResult result = files.load(
      "<include><uri>model://crate</uri></include>\n<include><uri>model://crate</uri><name>c</name><pose>1 2 3 0 0 "
      "0</pose><static>true</static></include>\n"
      "<include><uri>model:///crate</uri></include>\n<include><uri>https://fuel.gazebosim.org/1.0/open/models/Crate</uri><name>f</name></"
      "include>");
  ASSERT_EQ(result.world.models.size(), 4U) << all_findings(result);
  EXPECT_EQ(result.world.models[0].name, "crate");
  EXPECT_EQ(result.world.models[0].pose.translation(), Eigen::Vector3d(9, 9, 9));
  EXPECT_FALSE(result.world.models[0].is_static);
  EXPECT_EQ(result.world.models[1].name, "c");
  EXPECT_EQ(result.world.models[1].pose.translation(), Eigen::Vector3d(1, 2, 3));
  EXPECT_TRUE(result.world.models[1].is_static);
  EXPECT_EQ(result.world.models[1].source, "w.sdf:4");
  EXPECT_EQ(result.world.models[2].name, "crate_1") << "a name that is taken gets a number";
  EXPECT_EQ(result.world.models[3].name, "f");
  EXPECT_EQ(findings_with(result, "crate_1"), 1);
}

TEST(WorldIncludes, the_newest_version_that_is_known_is_taken) {
  const WorldFiles files;
  files.write("m/model.config",
              "<model><sdf version='1.4'>old.sdf</sdf><sdf version='1.6'>new.sdf</sdf><sdf version='2.0'>future.sdf</sdf></model>");
  for (const char* name : {"old", "new", "future"}) {
    files.write("m/" + std::string(name) + ".sdf",
                "<sdf version='1.4'><model name='" + std::string(name) + "'><link name='l'/></model></sdf>");
  }
  EXPECT_EQ(files.load("<include><uri>model://m</uri></include>").world.models.at(0).name, "new");
}

TEST(WorldIncludes, models_nest_and_their_names_are_scoped) {
  const WorldFiles files;
  files.write_model("hand",
                    "<model name='hand'><link name='palm'><sensor name='touch' type='contact'/></link><plugin name='grip' "
                    "filename='gz-sim-physics-system'/></model>");
  files.write_model(
      "arm",
      "<model name='arm'><link name='upper'/><include><uri>model://hand</uri><name>left</name><pose>0 1 0 0 0 0</pose></include>"
      "<joint name='wrist' type='fixed'><parent>upper</parent><child>left::palm</child></joint></model>");
  const LoadResult result = files.load("<include><uri>model://arm</uri><pose>10 0 0 0 0 0</pose></include>");
  ASSERT_EQ(result.world.models.size(), 1U) << all_findings(result);
  const ModelDef& arm = result.world.models[0];
  ASSERT_NE(arm.link("left::palm"), nullptr);
  EXPECT_EQ(arm.link("left::palm")->pose.translation(), Eigen::Vector3d(0, 1, 0));
  EXPECT_EQ(arm.canonical_link, "upper");
  EXPECT_EQ(arm.joint("wrist")->child, "left::palm");
  EXPECT_EQ(arm.plugins.at(0).scope, "left");
  const SensorDef& sensor = arm.link("left::palm")->sensors.at(0);
  EXPECT_EQ(iface_name(arm, sensor), "arm::left::touch");
}

TEST(WorldIncludes, an_older_model_in_a_newer_one_keeps_its_meaning) {
  const WorldFiles files;
  files.write("old/model.sdf",
              "<sdf version='1.4'><model name='old'><link name='a'/><link name='b'><pose>0 0 0 0 0 1.5707963267948966</pose></link><joint "
              "name='j' type='revolute'>"
              "<parent>a</parent><child>b</child><axis><xyz>0 1 0</xyz></axis></joint></model></sdf>");
  files.write_model("new", "<model name='new'><link name='l'/><include><uri>model://old</uri></include></model>");
  const LoadResult result = files.load("<include><uri>model://new</uri></include>");
  ASSERT_NE(result.world.models.at(0).joint("old::j"), nullptr) << all_findings(result);
  EXPECT_TRUE(result.world.models[0].joint("old::j")->axes[0].xyz.isApprox(Eigen::Vector3d(1, 0, 0)));
}

TEST(WorldIncludes, merged_models_have_no_scope) {
  const WorldFiles files;
  files.write_model("laser",
                    "<model name='laser'><link name='head'><pose>0 0 0.5 0 0 0</pose><sensor name='scan' type='imu'/></link></model>");
  const LoadResult result = files.load(
      "<model name='robot'><pose>1 0 0 0 0 0</pose><link name='base'><pose>0 0 1 0 0 0</pose></link><include "
      "merge='true'><uri>model://laser</uri>"
      "<pose relative_to='base'>1 0 0 0 0 0</pose></include><joint name='j' "
      "type='fixed'><parent>base</parent><child>head</child></joint></model>");
  const ModelDef& robot = result.world.models.at(0);
  ASSERT_NE(robot.link("head"), nullptr) << all_findings(result);
  EXPECT_TRUE(robot.link("head")->pose.translation().isApprox(Eigen::Vector3d(1, 0, 1.5))) << robot.link("head")->pose.translation();
  EXPECT_EQ(robot.joint("j")->child, "head");
  EXPECT_TRUE(result.findings.empty()) << all_findings(result);
}

TEST(WorldFrames, poses_may_be_relative_to_frames_links_and_models) {
  const WorldFiles files;
  const LoadResult result = files.load(
      "<frame name='table'><pose>0 0 1 0 0 0</pose></frame>"
      "<model name='cup'><pose relative_to='table'>0.1 0 0 0 0 0</pose><link name='l'/></model>"
      "<model name='spoon'><pose relative_to='cup'>0.1 0 0 0 0 0</pose><link name='l'><visual name='v'><pose relative_to='tip'>0 0 1 0 0 "
      "0</pose><geometry><box/></geometry>"
      "</visual></link><frame name='tip' attached_to='l'><pose>1 0 0 0 0 0</pose></frame></model>"
      "<light name='lamp' type='point'><pose relative_to='table'>0 0 1 0 0 0</pose></light>");
  ASSERT_EQ(result.world.models.size(), 2U) << all_findings(result);
  EXPECT_TRUE(result.world.model("cup")->pose.translation().isApprox(Eigen::Vector3d(0.1, 0, 1)));
  EXPECT_TRUE(result.world.model("spoon")->pose.translation().isApprox(Eigen::Vector3d(0.2, 0, 1)));
  EXPECT_TRUE(result.world.model("spoon")->links[0].visuals[0].pose.translation().isApprox(Eigen::Vector3d(1, 0, 1)));
  EXPECT_TRUE(result.world.lights.at(0).pose.translation().isApprox(Eigen::Vector3d(0, 0, 2)));
}

TEST(WorldFrames, sensors_in_joints_may_be_relative_to_frames) {
  const WorldFiles files;
  const LoadResult result = files.load(
      "<model name='m'><link name='base'/><link name='arm'><pose>3 0 0 0 0 0</pose></link><frame name='f'><pose>1 1 1 0 0 0</pose></frame>"
      "<joint name='j' type='fixed'><pose>-1 0 0 0 0 0</pose><parent>base</parent><child>arm</child>"
      "<sensor name='s' type='force_torque'><pose relative_to='f'>0 1 0 0 0 0</pose></sensor></joint>"
      "<joint name='w' type='fixed'><parent>base</parent><child>world</child></joint></model>");
  const JointDef& joint = result.world.models.at(0).joints.at(0);
  EXPECT_TRUE(joint.pose_in_model.translation().isApprox(Eigen::Vector3d(2, 0, 0), 1e-12));
  EXPECT_TRUE(joint.sensors.at(0).pose.translation().isApprox(Eigen::Vector3d(-1, 2, 1), 1e-12)) << all_findings(result);
}

TEST(WorldFrames, a_placement_frame_is_what_stands_at_the_pose) {
  const WorldFiles files;
  files.write_model("lamp", "<model name='lamp'><link name='l'/><frame name='foot'><pose>0 0 -1 0 0 0</pose></frame></model>");
  const LoadResult result =
      files.load("<include><uri>model://lamp</uri><placement_frame>foot</placement_frame><pose>5 0 0 0 0 0</pose></include>");
  EXPECT_TRUE(result.world.models.at(0).pose.translation().isApprox(Eigen::Vector3d(5, 0, 1))) << all_findings(result);
}

TEST(WorldFrames, angles_may_be_degrees_or_quaternions) {
  const WorldFiles files;
  const LoadResult result = files.load(
      "<model name='a'><pose degrees='true'>0 0 0 0 0 90</pose><link name='l'/></model>"
      "<model name='b'><pose rotation_format='quat_xyzw'>0 0 0 0 0 0.70710678 0.70710678</pose><link name='l'/></model>");
  for (const ModelDef& model : result.world.models)
    EXPECT_TRUE((model.pose * Eigen::Vector3d(1, 0, 0)).isApprox(Eigen::Vector3d(0, 1, 0), 1e-6)) << model.name;
}

TEST(WorldLoading, equal_models_are_told_apart_by_name_and_pose_only) {
  const WorldFiles files;
  std::string content;
  for (int i = 0; i < 50; ++i) {
    content += "<model name='b" + std::to_string(i) + "'><pose>" + std::to_string(i) +
               " 0 0 0 0 0</pose><link name='l'><collision name='c'><geometry><box><size>1 1 " + std::to_string(i % 2 + 1) +
               "</size></box></geometry></collision></link></model>\n";
  }
  const LoadResult result = files.load(content);
  ASSERT_EQ(result.world.models.size(), 50U);
  for (std::size_t i = 0; i < 50; ++i) {
    const ModelDef& model = result.world.models[i];
    EXPECT_EQ(model.name, "b" + std::to_string(i));
    EXPECT_EQ(model.pose.translation().x(), static_cast<double>(i));
    EXPECT_EQ(std::get<BoxShape>(model.links[0].collisions[0].geometry).size.z(), static_cast<double>(i % 2 + 1));
    EXPECT_EQ(model.source, "w.sdf:" + std::to_string(i + 3));
  }
}

}  // namespace
}  // namespace sim
