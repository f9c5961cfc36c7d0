// Sensors of worlds, and what their ifaces are called.
#include <gmock/gmock.h>

#include "support/world_files.h"
#include "world/iface_names.h"

namespace sim {
namespace {

using testing::HasSubstr;

SensorDef sensor_of(const std::string& type, const std::string& content) {
  const WorldFiles files;
  const LoadResult result = files.load(model_of("<collision name='c'><geometry><box/></geometry></collision><sensor name='s' type='" +
                                                type + "'><pose>1 2 3 0 0 0</pose><update_rate>5</update_rate>" + content + "</sensor>"));
  EXPECT_TRUE(result.findings.empty()) << all_findings(result);
  if (result.world.models.empty() || result.world.models[0].links[0].sensors.empty()) {
    ADD_FAILURE() << "no sensor of type " << type;
    return {};
  }
  const SensorDef& sensor = result.world.models[0].links[0].sensors[0];
  EXPECT_EQ(sensor.update_rate, 5);
  EXPECT_EQ(sensor.pose.translation(), Eigen::Vector3d(1, 2, 3));
  return sensor;
}

TEST(WorldSensors, range_finders_are_read_under_all_their_names) {
  for (const char* type : {"ray", "gpu_ray", "lidar", "gpu_lidar"}) {
    for (const char* element : {"ray", "lidar"}) {
      const std::string e = element;
      const SensorDef sensor = sensor_of(
          type,
          "<" + e +
              "><scan><horizontal><samples>181</samples><resolution>1</resolution><min_angle>-1.5</min_angle><max_angle>1.5</max_angle>"
              "</horizontal><vertical><samples>4</samples><min_angle>-0.1</min_angle><max_angle>0.1</max_angle></vertical></scan>"
              "<range><min>0.1</min><max>30</max><resolution>0.01</resolution></range><noise "
              "type='gaussian'><stddev>0.02</stddev></noise></" +
              e + ">");
      EXPECT_EQ(sensor.kind, SensorKind::ray);
      const auto& ray = std::get<RayDef>(sensor.data);
      EXPECT_EQ(ray.horizontal.samples, 181);
      EXPECT_EQ(ray.horizontal.min_angle, -1.5);
      EXPECT_EQ(ray.vertical.samples, 4);
      EXPECT_EQ(ray.range_max, 30);
      EXPECT_EQ(ray.range_resolution, 0.01);
      EXPECT_EQ(ray.noise.kind, NoiseDef::Kind::gaussian);
      EXPECT_EQ(ray.noise.stddev, 0.02);
    }
  }
}

TEST(WorldSensors, cameras_are_read) {
  const std::string camera =
      "<camera name='eye'><pose>0 0 1 0 0 "
      "0</pose><horizontal_fov>1.2</horizontal_fov><image><width>640</width><height>480</height><format>L8</format></image>"
      "<clip><near>0.2</near><far>50</far></clip><noise><type>gaussian</type><stddev>0.01</stddev></noise><distortion><k1>0.1</k1></"
      "distortion></camera>";
  for (const auto& [type, kind] : {std::pair{"camera", SensorKind::camera},
                                   {"depth", SensorKind::depth_camera},
                                   {"depth_camera", SensorKind::depth_camera},
                                   {"rgbd_camera", SensorKind::rgbd_camera},
                                   {"multicamera", SensorKind::multi_camera}}) {
    const SensorDef sensor = sensor_of(type, camera);
    EXPECT_EQ(sensor.kind, kind);
    const CameraDef& eye = std::get<CameraSetDef>(sensor.data).cameras.at(0);
    EXPECT_EQ(eye.name, "eye");
    EXPECT_EQ(eye.width, 640);
    EXPECT_EQ(eye.height, 480);
    EXPECT_EQ(eye.format, PixelFormat::mono8);
    EXPECT_EQ(eye.horizontal_fov, 1.2);
    EXPECT_EQ(eye.far_clip, 50);
    EXPECT_EQ(eye.noise.stddev, 0.01);
    EXPECT_EQ(eye.distortion->k1, 0.1);
    EXPECT_EQ(eye.pose.translation().z(), 1);
  }
  EXPECT_EQ(std::get<CameraSetDef>(sensor_of("multicamera", camera + "<camera name='other'/>").data).cameras.size(), 2U);
}

TEST(WorldSensors, formats_of_images_are_known_by_all_their_names_and_others_are_said_once) {
  const auto load = [](const std::string& type, const std::string& format) {
    return WorldFiles().load("<model name='m'><link name='l'><sensor name='s' type='" + type + "'><camera><image><format>" + format +
                             "</format></image></camera></sensor></link></model>");
  };
  const auto format_of = [](const LoadResult& result) {
    return std::get<CameraSetDef>(result.world.models.at(0).links.at(0).sensors.at(0).data).cameras.at(0).format;
  };
  for (const auto& [name, format] : {std::pair{"R8G8B8", PixelFormat::rgb8},
                                     {"RGB_INT8", PixelFormat::rgb8},
                                     {"B8G8R8", PixelFormat::bgr8},
                                     {"BGR_INT8", PixelFormat::bgr8},
                                     {"L8", PixelFormat::mono8},
                                     {"L_INT8", PixelFormat::mono8},
                                     {"L16", PixelFormat::mono16},
                                     {"L_INT16", PixelFormat::mono16},
                                     {"RGBA_INT8", PixelFormat::rgba8},
                                     {"BGRA_INT8", PixelFormat::bgra8},
                                     {"BAYER_RGGB8", PixelFormat::bayer_rggb8},
                                     {"BAYER_BGGR8", PixelFormat::bayer_bggr8},
                                     {"BAYER_GBRG8", PixelFormat::bayer_gbrg8},
                                     {"BAYER_GRBG8", PixelFormat::bayer_grbg8}}) {
    const auto result = load("camera", name);
    EXPECT_EQ(format_of(result), format) << name;
    EXPECT_TRUE(result.findings.empty()) << name;
  }
  EXPECT_TRUE(load("depth_camera", "R_FLOAT32").findings.empty());
  for (const char* name : {"R_FLOAT32", "YUV422", "RGB_INT32"}) {
    const auto result = load("camera", name);
    EXPECT_EQ(format_of(result), PixelFormat::rgb8);
    ASSERT_EQ(result.findings.size(), 1U) << name;
    EXPECT_NE(result.findings[0].text().find(name), std::string::npos) << result.findings[0].text();
    EXPECT_NE(result.findings[0].text().find("R8G8B8 is taken"), std::string::npos) << result.findings[0].text();
  }
}

TEST(WorldSensors, the_other_kinds_are_read) {
  EXPECT_EQ(std::get<ContactDef>(sensor_of("contact", "<contact><collision>m::l::c</collision></contact>").data).collisions,
            std::vector<std::string>{"c"});
  const auto imu = std::get<ImuDef>(
      sensor_of("imu", "<imu><angular_velocity><z><noise type='gaussian'><stddev>0.1</stddev></noise></z></angular_velocity></imu>").data);
  EXPECT_EQ(imu.angular_velocity[2].stddev, 0.1);
  EXPECT_EQ(imu.angular_velocity[0].kind, NoiseDef::Kind::none);
  for (const char* type : {"gps", "navsat"}) {
    const auto gps = std::get<GpsDef>(
        sensor_of(type,
                  "<" + std::string(type) +
                      "><position_sensing><horizontal><noise type='gaussian'><stddev>2</stddev></noise></horizontal></position_sensing></" +
                      std::string(type) + ">")
            .data);
    EXPECT_EQ(gps.horizontal_position.stddev, 2);
  }
  const auto sonar = std::get<SonarDef>(sensor_of("sonar", "<sonar><min>0.1</min><max>5</max><radius>0.6</radius></sonar>").data);
  EXPECT_EQ(sonar.range_max, 5);
  EXPECT_EQ(sonar.radius, 0.6);
  EXPECT_EQ(sensor_of("altimeter", "").kind, SensorKind::altimeter);
  EXPECT_EQ(sensor_of("magnetometer", "").kind, SensorKind::magnetometer);
  EXPECT_EQ(sensor_of("air_pressure", "").kind, SensorKind::air_pressure);
}

TEST(WorldSensors, force_torque_stands_in_a_joint) {
  const WorldFiles files;
  const LoadResult result = files.load(
      "<model name='m'><link name='a'/><link name='b'/><joint name='j' type='fixed'><parent>a</parent><child>b</child><sensor name='ft' "
      "type='force_torque'>"
      "<force_torque><frame>sensor</frame></force_torque></sensor></joint></model>");
  const SensorDef& sensor = result.world.models.at(0).joints.at(0).sensors.at(0);
  EXPECT_EQ(std::get<ForceTorqueDef>(sensor.data).joint, "j");
  EXPECT_EQ(std::get<ForceTorqueDef>(sensor.data).frame, ForceTorqueDef::Frame::sensor);
}

// Names of the ifaces of all sensors in order.
std::vector<std::string> ifaces_of(const ModelDef& model) {
  std::vector<std::string> names;
  for (const LinkDef& link : model.links) {
    for (const SensorDef& sensor : link.sensors) names.push_back(iface_name(model, sensor));
  }
  return names;
}

TEST(IfaceNames, sensors_of_one_name_in_different_links_are_told_apart) {
  const std::string imu = "<sensor name='s' type='imu'/>";
  const LoadResult result = WorldFiles().load("<model name='m'><link name='a'>" + imu + "</link><link name='b'>" + imu +
                                              "<sensor name='t' type='imu'/></link><link name='c'>" + imu +
                                              "</link><link name='d'><sensor name='s' type='gps'/></link></model>");
  EXPECT_THAT(ifaces_of(result.world.models.at(0)), testing::ElementsAre("m::s", "m::s_1", "m::t", "m::s_2", "m::s"))
      << "of another type, the name is free";
  EXPECT_FALSE(result.dropped);
  EXPECT_EQ(findings_with(result, "\"s_1\""), 1) << all_findings(result);
  EXPECT_EQ(findings_with(result, "\"s_2\""), 1) << all_findings(result);
}

TEST(IfaceNames, hold_no_slash_whatever_models_sensors_and_plugins_are_called) {
  const LoadResult result = WorldFiles().load(
      "<model name='a/b'><link name='l'><sensor name='/scan/front' type='imu'/></link>"
      "<plugin name='base/drive' filename='libgazebo_ros_diff_drive.so'/></model><model name='a_b'><link name='l'/></model>");
  const ModelDef& model = result.world.models.at(0);
  EXPECT_EQ(model.name, "a_b");
  EXPECT_EQ(result.world.models.at(1).name, "a_b_1");
  EXPECT_EQ(iface_name(model, model.links[0].sensors[0]), "a_b::_scan_front");
  EXPECT_EQ(iface_name(model, model.plugins.at(0)), "a_b::base_drive");
  EXPECT_FALSE(result.dropped);
}

TEST(IfaceNames, of_deep_models_are_cut_to_what_fits) {
  const std::string part(60, 'n');
  std::string text = "<link name='l'><sensor name='laser' type='imu'/></link><link name='k'><sensor name='" + std::string(190, 'x') +
                     "' type='imu'/></link>";
  for (int i = 0; i < 5; ++i) text = "<model name='" + part + std::to_string(i) + "'>" + text + "</model>";
  const LoadResult result = WorldFiles().load(text);
  const std::vector<std::string> names = ifaces_of(result.world.models.at(0));
  EXPECT_EQ(names.at(0), part + "4::laser");
  EXPECT_EQ(names.at(1), part + "4::" + std::string(120, 'x'));
}

TEST(IfaceNames, a_ring_of_sonars_has_one) {
  const std::string sonar = "type='sonar'/>";
  const LoadResult result = WorldFiles().load("<model name='m'><link name='a'><sensor name='sonar_1' " + sonar + "<sensor name='Sonar2' " +
                                              sonar + "<sensor name='echo' " + sonar + "</link></model>");
  EXPECT_THAT(ifaces_of(result.world.models.at(0)), testing::ElementsAre("m::sonar", "m::sonar", "m::echo"));
  EXPECT_TRUE(result.findings.empty()) << all_findings(result);
}

}  // namespace
}  // namespace sim
