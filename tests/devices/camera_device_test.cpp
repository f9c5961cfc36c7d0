// Cameras of all kinds as their ifaces show them: formats, depth and clouds, pairs, clip planes, rate, noise, lenses, who pays for a
// picture, and that time, pose and picture of a frame belong together.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <map>

#include "devices/sensors/camera.h"
#include "render/camera.h"
#include "support/simulation_fixture.h"

namespace sim {
namespace {

using namespace test;
using shm::IfaceType;

MaterialDef glow(const Color& color) {
  MaterialDef material;
  material.diffuse = {0, 0, 0, 1};
  material.emissive = color;
  material.lighting = false;
  return material;
}

ModelDef seen(const std::string& name, const GeometryDef& geometry, const Eigen::Isometry3d& pose, const Color& color) {
  ModelDef model = fixed(name, geometry, pose);
  VisualDef visual;
  visual.name = "visual";
  visual.geometry = geometry;
  visual.material = glow(color);
  model.links[0].visuals.push_back(visual);
  model.links[0].collisions.clear();
  return model;
}

CameraDef camera_def(int width = 64, int height = 48) {
  CameraDef def;
  def.name = "camera";
  def.width = width;
  def.height = height;
  return def;
}

SensorDef sensor_of(SensorKind kind, std::vector<CameraDef> cameras, double rate = 10) {
  SensorDef sensor;
  sensor.name = "eye";
  sensor.kind = kind;
  sensor.update_rate = rate;
  sensor.data = CameraSetDef{std::move(cameras)};
  return sensor;
}

// A body without weight or shape that carries the sensor; it stands in the origin and looks along x.
ModelDef carrier(const SensorDef& sensor, const Eigen::Isometry3d& pose = Eigen::Isometry3d::Identity()) {
  ModelDef model = body("robot", SphereShape{0.01}, pose);
  model.links[0].gravity = false;
  model.links[0].collisions.clear();
  model.links[0].sensors.push_back(sensor);
  return model;
}

WorldDef dark(std::vector<ModelDef> models) {
  WorldDef world;
  world.scene.ambient = world.scene.background = {0, 0, 0, 1};
  world.physics.step = 0.01;
  world.models = std::move(models);
  return world;
}

// Pictures are finished when a step is.
struct Stage : SimulationFixture {
  explicit Stage(WorldDef world, std::uint64_t seed = 1) : SimulationFixture(std::move(world), seed) {
    simulation->pictures().set_synchronous(true);
  }
};

std::vector<std::uint8_t> bytes_of(const shm::HeldFrame& frame) {
  const auto* data = reinterpret_cast<const std::uint8_t*>(frame.data().data());
  return {data, data + frame.data().size()};
}
std::vector<float> floats_of(const shm::HeldFrame& frame) {
  std::vector<float> values(frame.data().size() / sizeof(float));
  std::memcpy(values.data(), frame.data().data(), values.size() * sizeof(float));
  return values;
}

std::vector<std::uint8_t> first_picture(const SensorDef& sensor, std::vector<ModelDef> models, std::uint64_t seed = 1) {
  models.insert(models.begin(), carrier(sensor));
  Stage f(dark(std::move(models)), seed);
  auto eye = f.open(IfaceType::camera, "robot::eye");
  f.run(0.01);
  const auto frame = eye.hold();
  return frame ? bytes_of(*frame) : std::vector<std::uint8_t>();
}

// An orange wall that fills the picture: sRGB 255 128 0, luminance 151.4.
const Color orange{1, 128 / 255.0F, 0, 1};
ModelDef orange_wall() { return seen("wall", BoxShape{{0.2, 40, 40}}, at(3, 0, 0), orange); }

struct FormatCase {
  const char* name;
  shm::Format format;
  std::uint32_t stride;
  std::vector<std::uint8_t> first_row, second_row;  // how they begin
};

TEST(CameraDevice, every_format_of_sdf_is_published_with_the_octets_that_its_page_says) {
  const std::vector<FormatCase> cases{
      {"R8G8B8", shm::Format::rgb8, 66, {255, 128, 0, 255, 128, 0}, {255, 128, 0}},
      {"B8G8R8", shm::Format::bgr8, 66, {0, 128, 255, 0, 128, 255}, {0, 128, 255}},
      {"RGBA_INT8", shm::Format::rgba8, 88, {255, 128, 0, 255, 255}, {255, 128, 0, 255}},
      {"BGRA_INT8", shm::Format::bgra8, 88, {0, 128, 255, 255, 0}, {0, 128, 255, 255}},
      {"L8", shm::Format::mono8, 22, {151, 151}, {151}},
      {"L_INT8", shm::Format::mono8, 22, {151, 151}, {151}},
      {"L16", shm::Format::mono16, 44, {0xF9, 0x97}, {0xF9, 0x97}},  // 151.38 * 257 = 38905
      {"BAYER_RGGB8", shm::Format::bayer_rggb8, 22, {255, 128, 255, 128}, {128, 0, 128, 0}},
      {"BAYER_BGGR8", shm::Format::bayer_bggr8, 22, {0, 128, 0, 128}, {128, 255, 128, 255}},
      {"BAYER_GBRG8", shm::Format::bayer_gbrg8, 22, {128, 0, 128, 0}, {255, 128, 255, 128}},
      {"BAYER_GRBG8", shm::Format::bayer_grbg8, 22, {128, 255, 128, 255}, {0, 128, 0, 128}},
  };
  for (const auto& c : cases) {
    CameraDef def = camera_def(22, 6);
    def.format = parse_pixel_format(c.name).value();
    Stage f(dark({carrier(sensor_of(SensorKind::camera, {def})), orange_wall()}));
    auto eye = f.open(IfaceType::camera, "robot::eye");
    EXPECT_EQ(eye.info<shm::CameraInfo>().format, static_cast<std::uint32_t>(c.format)) << c.name;
    EXPECT_EQ(eye.info<shm::CameraInfo>().stride, c.stride) << c.name;
    EXPECT_EQ(eye.info<shm::CameraInfo>().frame_size, c.stride * 6U) << c.name;
    f.run(0.01);
    const auto frame = eye.hold();
    ASSERT_TRUE(frame) << c.name;
    EXPECT_EQ(frame->head().format, static_cast<std::uint32_t>(c.format)) << c.name;
    const auto bytes = bytes_of(*frame);
    ASSERT_EQ(bytes.size(), c.stride * 6U) << c.name;
    for (std::size_t i = 0; i < c.first_row.size(); ++i) EXPECT_NEAR(bytes[i], c.first_row[i], 1) << c.name << " octet " << i;
    for (std::size_t i = 0; i < c.second_row.size(); ++i)
      EXPECT_NEAR(bytes[c.stride + i], c.second_row[i], 1) << c.name << " second row, octet " << i;
  }
}

TEST(CameraDevice, depth_is_float_whatever_the_format_says) {
  CameraDef def = camera_def();
  def.format = PixelFormat::mono8;
  Stage f(dark({carrier(sensor_of(SensorKind::depth_camera, {def})), orange_wall()}));
  auto eye = f.open(IfaceType::depth, "robot::eye");
  EXPECT_EQ(eye.info<shm::CameraInfo>().format, static_cast<std::uint32_t>(shm::Format::depth_float));
  f.run(0.01);
  for (const float d : floats_of(*eye.hold())) ASSERT_NEAR(d, 2.9, 0.003);
}

TEST(CameraDevice, an_rgbd_camera_sees_the_same_in_colour_depth_and_points) {
  // A ball in the left half, nothing behind it.
  const auto ball = seen("ball", SphereShape{0.5}, at(3, 0.6, 0.2), {0, 1, 0, 1});
  Stage f(dark({carrier(sensor_of(SensorKind::rgbd_camera, {camera_def(80, 60)})), ball}));
  auto color = f.open(IfaceType::camera, "robot::eye"), depth = f.open(IfaceType::depth, "robot::eye"),
       points = f.open(IfaceType::points, "robot::eye");
  f.run(0.01);
  const auto c = color.hold(), d = depth.hold(), p = points.hold();
  ASSERT_TRUE(c && d && p);
  EXPECT_EQ(c->head().stamp.sim_time_ns, d->head().stamp.sim_time_ns);
  EXPECT_EQ(c->head().stamp.sim_time_ns, p->head().stamp.sim_time_ns);
  const auto& info = points.info<shm::CameraInfo>();
  EXPECT_EQ(info.width, 80U);
  EXPECT_EQ(info.height, 60U);
  EXPECT_EQ(info.stride, 80U * 12U);
  const auto rgb = bytes_of(*c);
  const auto metres = floats_of(*d), cloud = floats_of(*p);
  ASSERT_EQ(cloud.size(), 80U * 60U * 3U);
  int hits = 0;
  for (std::size_t i = 0; i < metres.size(); ++i) {
    const bool is_green = rgb[3 * i + 1] > 250, is_edge = !is_green && rgb[3 * i + 1] > 5;
    if (is_edge) continue;
    ASSERT_EQ(std::isfinite(metres[i]), is_green) << i;
    ASSERT_EQ(std::isnan(cloud[3 * i]), !is_green) << i;
    ASSERT_EQ(std::isnan(cloud[3 * i + 2]), !is_green) << i;
    if (!is_green) continue;
    ++hits;
    ASSERT_EQ(cloud[3 * i], metres[i]);
    const double u = static_cast<double>(i % 80) + 0.5, v = static_cast<double>(i / 80) + 0.5;
    ASSERT_NEAR(cloud[3 * i + 1], (info.cx - u) / info.fx * metres[i], 1e-5);
    ASSERT_NEAR(cloud[3 * i + 2], (info.cy - v) / info.fy * metres[i], 1e-5);
    const double off = (Eigen::Vector3d(cloud[3 * i], cloud[3 * i + 1], cloud[3 * i + 2]) - Eigen::Vector3d(3, 0.6, 0.2)).norm();
    ASSERT_NEAR(off, 0.5, 0.02) << i;
  }
  EXPECT_GT(hits, 100);
}

double middle_column(const std::vector<std::uint8_t>& rgb, std::size_t width) {
  double sum = 0, weight = 0;
  for (std::size_t i = 0; i < rgb.size() / 3; ++i) {
    sum += rgb[3 * i] * (static_cast<double>(i % width) + 0.5);
    weight += rgb[3 * i];
  }
  return weight > 0 ? sum / weight : -1;
}
double middle_row(const std::vector<std::uint8_t>& rgb, std::size_t width) {
  double sum = 0, weight = 0;
  for (std::size_t i = 0; i < rgb.size() / 3; ++i) {
    sum += rgb[3 * i] * (static_cast<double>(i / width) + 0.5);
    weight += rgb[3 * i];
  }
  return weight > 0 ? sum / weight : -1;
}

TEST(CameraDevice, a_stereo_pair_sees_the_disparity_of_its_base_line) {
  CameraDef left = camera_def(320, 240), right = camera_def(320, 240);
  left.name = "left", right.name = "right";
  left.pose = at(0, 0.06, 0), right.pose = at(0, -0.06, 0);
  right.format = PixelFormat::bgr8;
  const auto marker = seen("marker", SphereShape{0.05}, at(2, 0.1, 0), {1, 1, 1, 1});
  Stage f(dark({carrier(sensor_of(SensorKind::multi_camera, {left, right})), marker}));
  auto one = f.open(IfaceType::camera, "robot::eye::left"), two = f.open(IfaceType::camera, "robot::eye::right");
  const auto &a = one.info<shm::CameraInfo>(), &b = two.info<shm::CameraInfo>();
  EXPECT_NEAR(a.pose.y - b.pose.y, 0.12, 1e-12);
  EXPECT_EQ(b.format, static_cast<std::uint32_t>(shm::Format::bgr8)) << "each camera has a format of its own";
  f.run(0.01);
  const auto l = one.hold(), r = two.hold();
  ASSERT_TRUE(l && r);
  EXPECT_EQ(l->head().stamp.sim_time_ns, r->head().stamp.sim_time_ns);
  EXPECT_NEAR(l->head().pose.y - r->head().pose.y, 0.12, 1e-9);
  const double disparity = middle_column(bytes_of(*l), 320) - middle_column(bytes_of(*r), 320);
  EXPECT_NEAR(disparity, a.fx * 0.12 / 2, 0.5);
}

TEST(CameraDevice, nothing_is_seen_beyond_the_clip_planes) {
  CameraDef def = camera_def(60, 20);
  def.near_clip = 1;
  def.far_clip = 5;
  const std::vector<ModelDef> walls{seen("near", BoxShape{{0.1, 0.3, 0.4}}, at(0.8, 0.25, 0), {1, 1, 1, 1}),
                                    seen("middle", BoxShape{{0.1, 0.3, 0.4}}, at(3, 0, 0), {1, 1, 1, 1}),
                                    seen("far", BoxShape{{0.1, 2, 4}}, at(6, -2, 0), {1, 1, 1, 1})};
  std::vector<ModelDef> models{carrier(sensor_of(SensorKind::rgbd_camera, {def}))};
  models.insert(models.end(), walls.begin(), walls.end());
  Stage f(dark(models));
  auto color = f.open(IfaceType::camera, "robot::eye"), depth = f.open(IfaceType::depth, "robot::eye");
  EXPECT_EQ(color.info<shm::CameraInfo>().near_clip, 1);
  EXPECT_EQ(color.info<shm::CameraInfo>().far_clip, 5);
  f.run(0.01);
  const auto rgb = bytes_of(*color.hold());
  const auto metres = floats_of(*depth.hold());
  const std::size_t row = 10 * 60;
  EXPECT_EQ(rgb[3 * (row + 14)], 0) << "nearer than the near plane";
  EXPECT_EQ(rgb[3 * (row + 30)], 255);
  EXPECT_EQ(rgb[3 * (row + 47)], 0) << "beyond the far plane";
  EXPECT_TRUE(std::isinf(metres[row + 14]));
  EXPECT_NEAR(metres[row + 30], 2.95, 0.003);
  EXPECT_TRUE(std::isinf(metres[row + 47]));
}

TEST(CameraDevice, frames_come_at_the_rate_of_simulated_time) {
  Stage f(dark({carrier(sensor_of(SensorKind::camera, {camera_def()}, 20)), orange_wall()}));
  auto eye = f.open(IfaceType::camera, "robot::eye");
  EXPECT_EQ(eye.info<shm::CameraInfo>().rate, 20);
  std::vector<std::int64_t> times;
  std::uint64_t last = 0;
  f.simulation->sense(f.times);
  for (int i = 0; i <= 100; ++i) {
    if (eye.sequence() != last) {
      last = eye.sequence();
      times.push_back(eye.hold()->head().stamp.sim_time_ns);
    }
    f.simulation->step(f.times);
    f.simulation->sense(f.times);
  }
  ASSERT_EQ(times.size(), 21U);
  for (std::size_t i = 0; i < times.size(); ++i) EXPECT_EQ(times[i], static_cast<std::int64_t>(i) * 50'000'000);
}

TEST(CameraDevice, noise_has_its_deviation_in_every_format_and_repeats_by_seed) {
  for (const auto format : {PixelFormat::rgb8, PixelFormat::bgr8, PixelFormat::mono8, PixelFormat::mono16, PixelFormat::bayer_rggb8}) {
    CameraDef def = camera_def(160, 120);
    def.format = format;
    def.noise.kind = NoiseDef::Kind::gaussian;
    def.noise.stddev = 0.04;
    const auto sensor = sensor_of(SensorKind::camera, {def});
    const auto grey_wall = seen("wall", BoxShape{{0.2, 40, 40}}, at(3, 0, 0), {128 / 255.0F, 128 / 255.0F, 128 / 255.0F, 1});
    const auto picture = first_picture(sensor, {grey_wall});
    EXPECT_EQ(picture, first_picture(sensor, {grey_wall}));
    EXPECT_NE(picture, first_picture(sensor, {grey_wall}, 2));
    const std::size_t size = format == PixelFormat::mono16 ? 2 : 1;
    double sum = 0, squares = 0;
    for (std::size_t i = 0; i < picture.size(); i += size) {
      const double value = size == 2 ? (picture[i] + 256.0 * picture[i + 1]) / 65535 : picture[i] / 255.0;
      sum += value, squares += value * value;
    }
    const double count = static_cast<double>(picture.size() / size), mean = sum / count;
    EXPECT_NEAR(mean, 128 / 255.0, 0.002) << static_cast<int>(format);
    EXPECT_NEAR(std::sqrt(squares / count - mean * mean), 0.04, 0.001) << static_cast<int>(format);
  }
}

TEST(CameraDevice, a_distorting_lens_says_so_in_its_info_and_its_points_lie_on_the_rays_that_it_sees) {
  CameraDef def = camera_def(80, 60);
  DistortionDef lens;
  lens.k1 = -0.2;
  lens.k2 = 0.03;
  lens.p1 = 0.002;
  lens.center = {0.52, 0.47};
  def.distortion = lens;
  Stage f(dark({carrier(sensor_of(SensorKind::depth_camera, {def})), seen("ball", SphereShape{1.5}, at(4, 0.5, 0.3), orange)}));
  auto eye = f.open(IfaceType::depth, "robot::eye"), cloud = f.open(IfaceType::points, "robot::eye");
  const auto& info = eye.info<shm::CameraInfo>();
  EXPECT_EQ(info.distortion[0], -0.2);
  EXPECT_EQ(info.distortion[1], 0.03);
  EXPECT_EQ(info.distortion[2], 0.002);
  EXPECT_NEAR(info.cx, 0.52 * 80, 1e-12);
  EXPECT_NEAR(info.cy, 0.47 * 60, 1e-12);
  f.run(0.01);
  const auto points = floats_of(*cloud.hold());
  int hits = 0;
  for (std::size_t i = 0; i < points.size(); i += 3) {
    if (std::isnan(points[i])) continue;
    ++hits;
    const Eigen::Vector3d p(points[i], points[i + 1], points[i + 2]);
    EXPECT_NEAR((p - Eigen::Vector3d(4, 0.5, 0.3)).norm(), 1.5, 0.06) << "point " << i / 3;
    // Bent by the lens, the tangents of the point are those of its pixel.
    const double x = -p.y() / p.x(), y = -p.z() / p.x(), r2 = x * x + y * y, radial = 1 + r2 * (lens.k1 + r2 * lens.k2);
    const double u = info.cx + info.fx * (x * radial + 2 * lens.p1 * x * y);
    const double v = info.cy + info.fy * (y * radial + lens.p1 * (r2 + 2 * y * y));
    EXPECT_NEAR(u, static_cast<double>(i / 3 % 80) + 0.5, 0.05);
    EXPECT_NEAR(v, static_cast<double>(i / 3 / 80) + 0.5, 0.05);
  }
  EXPECT_GT(hits, 500);
}

TEST(CameraDevice, only_who_subscribes_makes_it_draw) {
  Stage f(dark({carrier(sensor_of(SensorKind::rgbd_camera, {camera_def()})), orange_wall()}));
  auto color = shm::Iface::open(own_server_id(), IfaceType::camera, "robot::eye");
  auto depth = shm::Iface::open(own_server_id(), IfaceType::depth, "robot::eye");
  ASSERT_TRUE(color && depth);
  const auto* camera = dynamic_cast<const CameraPlaceSource*>(f.simulation->device("robot::eye"));
  ASSERT_NE(camera, nullptr);
  f.run(1);
  EXPECT_EQ(camera->pictures_drawn(), 0U) << "nobody looks";
  EXPECT_EQ(f.simulation->take_active_sensors(), 0U);
  ASSERT_TRUE(color->subscribe());
  f.run(1);
  EXPECT_GT(color->sequence(), 8U);
  EXPECT_EQ(depth->sequence(), 0U) << "nobody looks at the depth";
  EXPECT_EQ(camera->pictures_drawn(), color->sequence());
  color->unsubscribe();
  const auto before = camera->pictures_drawn();
  f.run(1);
  EXPECT_EQ(camera->pictures_drawn(), before);
}

TEST(CameraDevice, nobody_for_ten_seconds_gives_its_memory_back) {
  Stage f(dark({carrier(sensor_of(SensorKind::camera, {camera_def()})), orange_wall()}));
  const auto* camera = dynamic_cast<const CameraPlaceSource*>(f.simulation->device("robot::eye"));
  auto eye = shm::Iface::open(own_server_id(), IfaceType::camera, "robot::eye");
  ASSERT_TRUE(eye && camera != nullptr);
  EXPECT_FALSE(camera->holds_context());
  for (int round = 0; round < 2; ++round) {
    ASSERT_TRUE(eye->subscribe());
    const auto before = eye->sequence();
    f.run(12);
    EXPECT_TRUE(camera->holds_context());
    EXPECT_GT(eye->sequence(), before + 100);
    eye->unsubscribe();
    f.run(9);
    EXPECT_TRUE(camera->holds_context()) << "somebody may come back";
    f.run(2);
    for (int i = 0; i < 1'000'000 && camera->holds_context(); ++i) f.run(0.01);
    EXPECT_FALSE(camera->holds_context());
  }
}

Eigen::Isometry3d isometry(const shm::Pose& p) {
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  out.translation() = Eigen::Vector3d(p.x, p.y, p.z);
  out.linear() = Eigen::Quaterniond(p.qw, p.qx, p.qy, p.qz).toRotationMatrix();
  return out;
}

// A camera that moves and turns before a marker: by time the true pose of its model.
struct MovingCamera {
  Stage stage;
  shm::Iface eye;
  std::map<std::int64_t, Eigen::Isometry3d> truth;
  const Eigen::Vector3d marker{4, 0.5, 0.3};

  explicit MovingCamera(double rate)
      : stage(dark({carrier(sensor_of(SensorKind::camera, {camera_def(160, 120)}, rate)),
                    seen("marker", SphereShape{0.06}, at(4, 0.5, 0.3), {1, 1, 1, 1})})),
        eye(stage.open(IfaceType::camera, "robot::eye")) {
    EXPECT_TRUE(stage.simulation->physics().set_model_twist(0, {{0.6, 0.4, 0.1}, {0.05, 0.05, 0.25}}));
    note();
    stage.simulation->sense(stage.times);
  }
  void note() { truth[stage.simulation->time().count()] = stage.simulation->physics().model_pose(0); }
  void step() {
    stage.simulation->step(stage.times);
    note();
    stage.simulation->sense(stage.times);
  }
  // The frame shows the world and says the pose of its own time.
  void check(const shm::HeldFrame& frame) {
    const auto t = frame.head().stamp.sim_time_ns;
    ASSERT_TRUE(truth.contains(t)) << t;
    const Eigen::Isometry3d pose = isometry(frame.head().pose);
    EXPECT_LT((pose.translation() - truth[t].translation()).norm(), 1e-12) << t;
    EXPECT_LT((pose.linear() - truth[t].linear()).norm(), 1e-9) << t;
    const Eigen::Vector3d p = pose.inverse() * marker;
    const auto& info = eye.info<shm::CameraInfo>();
    const auto rgb = bytes_of(frame);
    EXPECT_NEAR(middle_column(rgb, 160), info.cx - info.fx * p.y() / p.x(), 0.5) << t;
    EXPECT_NEAR(middle_row(rgb, 160), info.cy - info.fy * p.z() / p.x(), 0.5) << t;
  }
};

TEST(CameraDevice, in_lock_step_the_frame_of_a_time_is_the_world_at_that_time) {
  MovingCamera m(20);
  for (int i = 0; i < 100; ++i) {
    m.step();
    const auto frame = m.eye.hold();
    ASSERT_TRUE(frame);
    // The newest one that was due is there as soon as the step is over.
    ASSERT_EQ(frame->head().stamp.sim_time_ns, (i + 1) / 5 * 50'000'000LL);
    if ((i + 1) % 5 == 0) m.check(*frame);
  }
}

TEST(CameraDevice, in_its_own_time_a_late_frame_still_shows_the_world_of_its_stamp) {
  MovingCamera m(0);
  m.stage.simulation->pictures().set_synchronous(false);
  std::uint64_t last = 0, checked = 0;
  for (int i = 0; i < 120; ++i) {
    m.step();  // while a picture is drawn, in a thread of its own
    // Now and then it may catch up; when it was done just before the step, nothing comes.
    if (i % 10 == 9) m.eye.wait(last, std::chrono::seconds(1));
    if (m.eye.sequence() == last) continue;
    const auto frame = m.eye.hold();
    ASSERT_TRUE(frame);
    last = frame->sequence();
    m.check(*frame);
    ++checked;
  }
  EXPECT_GT(checked, 5U);
}

}  // namespace
}  // namespace sim
