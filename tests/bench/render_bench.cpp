// What pictures cost: cameras inside a running simulation beside a bare OSMesa loop that draws the same scene in the same run, pictures a
// second, what a camera leaves of real time, memory. Prints a table with the limits; the best of several rounds, for a busy machine.
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <random>
#include <stdexcept>

#include "bench/bare_gl.h"
#include "render/camera.h"
#include "server/simulation.h"
#include "shm/client.h"
#include "shm/server.h"
#include "support/scene_maker.h"
#include "support/usage.h"
#include "world/world_loader.h"

namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

// `is_least`: the limit is what the value must reach.
bool print(const std::string& what, double value, const char* unit, double limit, bool is_least, const std::string& note = {}) {
  const bool is_kept = is_least ? value >= limit : value <= limit;
  std::printf("%-62s %9.2f %-9s %s %8.2f  %-6s %s\n", what.c_str(), value, unit, is_least ? ">=" : "<=", limit, is_kept ? "ok" : "MISSED",
              note.c_str());
  std::fflush(stdout);
  return is_kept;
}

std::filesystem::path write_texture(const char* name, std::uint8_t r, std::uint8_t g, std::uint8_t b) {
  const auto file = std::filesystem::temp_directory_path() / ("render_bench_" + std::to_string(::getpid()) + "_" + name + ".png");
  std::mt19937 random(r);
  sim::Image image{512, 512, {}};
  for (int i = 0; i < 512 * 512; ++i) {
    const auto shade = static_cast<std::uint8_t>(random() % 60);
    const bool is_tile = (((i / 512) / 64) + ((i % 512) / 64)) % 2 == 0;
    for (const std::uint8_t c : {r, g, b}) image.rgba.push_back(static_cast<std::uint8_t>((is_tile ? c : c * 3 / 4) - shade / 2));
    image.rgba.push_back(255);
  }
  if (const auto written = sim::write_png(image, file); !written) throw std::runtime_error(written.error().message);
  return file;
}

struct Textures {
  std::filesystem::path wall = write_texture("wall", 200, 150, 110), grass = write_texture("grass", 110, 170, 80);
  ~Textures() {
    std::error_code error;
    std::filesystem::remove(wall, error);
    std::filesystem::remove(grass, error);
  }
};

constexpr int width = 320, height = 240;

sim::SensorDef camera_sensor(double rate, int w = width, int h = height) {
  sim::SensorDef sensor;
  sensor.name = "camera";
  sensor.kind = sim::SensorKind::camera;
  sensor.type = "camera";
  sensor.update_rate = rate;
  sim::CameraDef camera;
  camera.width = w;
  camera.height = h;
  sensor.data = sim::CameraSetDef{{camera}};
  return sensor;
}

// A textured ground, and textured boxes or spheres standing on it, all of them in view of a camera that turns a little from side to side.
sim::WorldDef make_world(int triangles, const Textures& textures, int movers, double rate, int w = width, int h = height) {
  sim::WorldDef world;
  world.physics.step = 0.001;
  world.lights.push_back(sim::test::sun({0.4, 0.3, -1}, {0.9F, 0.9F, 0.85F, 1}, true));
  sim::MaterialDef grass = sim::test::plain_material({1, 1, 1, 1});
  grass.texture = textures.grass.string();
  grass.texture_scale = {30, 30};
  world.models.push_back(sim::test::one_visual_model("ground", sim::PlaneShape{{0, 0, 1}, {60, 60}}, sim::test::at(0, 0, 0), grass));
  sim::MaterialDef wall = grass;
  wall.texture = textures.wall.string();
  wall.texture_scale = {1, 1};
  std::mt19937 random(4);
  std::uniform_real_distribution<double> unit(0, 1);
  const bool is_fine = triangles > 10000;
  const int count = is_fine ? triangles / 1296 + 1 : triangles / 12;
  for (int i = 0; i < count; ++i) {
    const double far = 3 + 14 * unit(random), side = (unit(random) - 0.5) * 0.8 * far, size = 0.4 + 0.8 * unit(random);
    const sim::GeometryDef shape =
        is_fine ? sim::GeometryDef(sim::SphereShape{0.6 * size}) : sim::GeometryDef(sim::BoxShape{{size, size, size}});
    world.models.push_back(
        sim::test::one_visual_model("thing" + std::to_string(i), shape, sim::test::at(far, side, 0.5 * size, far), wall, i >= movers));
    world.models.back().links[0].gravity = false;
  }
  sim::ModelDef eye;
  eye.name = "eye";
  eye.canonical_link = "link";
  eye.pose = sim::test::at(-1, 0, 2, 0, 0.2);
  eye.links.push_back({});
  eye.links[0].name = "link";
  eye.links[0].gravity = false;
  eye.links[0].sensors.push_back(camera_sensor(rate, w, h));
  world.models.push_back(eye);
  return world;
}

// A running world with somebody who watches its camera.
struct Rig {
  std::vector<std::string> notes, dropped;
  std::unique_ptr<shm::Server> server;
  std::unique_ptr<sim::Simulation> simulation;
  std::optional<shm::Iface> camera;
  sim::PartTimes times;
  sim::ModelId eye = 0;
  std::vector<sim::ModelId> movers;
  double angle = 0;

  Rig(sim::WorldDef def, const std::string& camera_name) {
    auto started = shm::Server::start({.server_id = 2000 + static_cast<std::uint32_t>(::getpid()) % 7000, .access = {}});
    if (!started) throw std::runtime_error(started.error().message);
    server = std::move(*started);
    auto made =
        sim::Simulation::create(std::make_shared<const sim::WorldDef>(std::move(def)), *server, {.seed = 1, .threads = 1}, notes, dropped);
    if (!made) throw std::runtime_error(made.error().message);
    simulation = std::move(*made);
    simulation->pictures().set_synchronous(true);
    auto iface = shm::Iface::open(server->id(), shm::IfaceType::camera, camera_name);
    if (!iface) throw std::runtime_error(iface.error().message);
    camera = std::move(*iface);
    if (auto subscribed = camera->subscribe(); !subscribed) throw std::runtime_error(subscribed.error().message);
    for (sim::ModelId id = 0; id < simulation->physics().model_slots(); ++id) {
      const auto& model = simulation->physics().def(id);
      if (model.name == "eye") eye = id;
      if (model.name.starts_with("thing") && !model.is_static) movers.push_back(id);
    }
    simulation->sense(times);
  }
  void step() {
    simulation->step(times);
    simulation->sense(times);
  }
  static Eigen::Isometry3d eye_pose(double at) { return sim::test::at(-1, 0, 2, 0.05 * std::sin(at), 0.2); }
  // A step in which the camera turns, and what moves moves.
  void move_and_step() {
    angle += 0.1;
    if (!simulation->set_pose(eye, eye_pose(angle))) throw std::runtime_error("the camera does not move");
    for (const auto id : movers) {
      Eigen::Isometry3d pose = simulation->physics().model_pose(id);
      pose.translation().x() += 0.02 * std::cos(angle);
      if (!simulation->set_pose(id, pose)) throw std::runtime_error("a model does not move");
    }
    step();
  }
};

// Seconds for one call, the best of several rounds.
double best_of(int rounds, int count, const std::function<void()>& work) {
  double best = 1e9;
  for (int round = 0; round < rounds; ++round) {
    const auto start = Clock::now();
    for (int i = 0; i < count; ++i) work();
    best = std::min(best, seconds_since(start) / count);
  }
  return best;
}

bool bench_scene(int triangles, const Textures& textures, double least, int rounds) {
  const std::string name = triangles >= 100000 ? "100 k triangles" : "1 k triangles";
  const int count = triangles >= 100000 ? 5 : 15;  // short rounds find the quiet moments of a busy machine
  Rig rig(make_world(triangles, textures, 0, 1000), "eye::camera");
  sim::Assets assets;
  const auto scene = sim::Scene::build(make_world(triangles, textures, 0, 1000), assets);
  bench::BareGl bare(*scene, scene->start_poses(), 1024);
  std::vector<std::uint8_t> rgba;
  double angle = 0;
  const auto bare_frame = [&] {
    angle += 0.1;
    sim::View view = sim::View::pinhole(Rig::eye_pose(angle), 1.047, width, height);
    bare.draw(view, rgba);
  };
  for (int i = 0; i < 20; ++i) rig.move_and_step(), bare_frame();
  double ours = 1e9, theirs = 1e9;
  // By turns, so that a busy moment meets both.
  for (int round = 0; round < rounds; ++round) {
    ours = std::min(ours, best_of(1, count, [&] { rig.move_and_step(); }));
    theirs = std::min(theirs, best_of(1, count, bare_frame));
  }
  if (std::getenv("RENDER_BENCH_PNG") != nullptr) {
    sim::Image image{width, height, rgba};
    (void)sim::write_png(image, std::string(std::getenv("RENDER_BENCH_PNG")) + "_bare.png");
    const auto frame = rig.camera->hold();
    for (std::size_t i = 0; frame && i < image.rgba.size() / 4; ++i) std::memcpy(&image.rgba[4 * i], &frame->data()[3 * i], 3);
    (void)sim::write_png(image, std::string(std::getenv("RENDER_BENCH_PNG")) + "_server.png");
  }
  char note[80];
  std::snprintf(note, sizeof note, "%.2f ms a step with its picture; bare %.2f ms", 1e3 * ours, 1e3 * theirs);
  bool is_kept = print("320x240, textured, shadows, " + name + ": inside the server", 1 / ours, "frames/s", least, true, note);
  is_kept &= print("  against a bare OSMesa loop", ours / theirs, "times", 1.2, false);
  return is_kept;
}

bool bench_movers(int triangles, const Textures& textures, double least, int rounds) {
  Rig rig(make_world(triangles, textures, 4, 1000), "eye::camera");
  for (int i = 0; i < 20; ++i) rig.move_and_step();
  const double ours = best_of(rounds, triangles >= 100000 ? 5 : 15, [&] { rig.move_and_step(); });
  return print("  with 4 moving things and their shadows", 1 / ours, "frames/s", least, true);
}

// Labels, and boxes with the image, of the same scene and view as the plain camera; an object for each model.
bool bench_labels(int triangles, const Textures& textures, int rounds) {
  const auto rig_of = [&](sim::SensorKind kind, const std::string& iface) {
    sim::WorldDef world = make_world(triangles, textures, 0, 1000);
    for (auto& model : world.models) {
      for (auto& link : model.links) {
        for (auto& visual : link.visuals) visual.label = model.name.starts_with("thing") ? 1 : 0;
        for (auto& sensor : link.sensors) sensor.kind = kind;
      }
    }
    return std::make_unique<Rig>(std::move(world), iface);
  };
  const auto time_of = [&](Rig& rig) {
    for (int i = 0; i < 10; ++i) rig.move_and_step();
    return best_of(rounds, triangles >= 100000 ? 5 : 15, [&] { rig.move_and_step(); });
  };
  double plain = 0, labels = 0, boxes = 0;
  {
    const auto rig = rig_of(sim::SensorKind::camera, "eye::camera");
    plain = time_of(*rig);
  }
  {
    const auto rig = rig_of(sim::SensorKind::segmentation_camera, "eye::camera::labels_map");
    labels = time_of(*rig);
  }
  {
    const auto rig = rig_of(sim::SensorKind::box_camera, "eye::camera");
    auto iface = shm::Iface::open(rig->server->id(), shm::IfaceType::boxes, "eye::camera");
    if (!iface || !iface->subscribe()) throw std::runtime_error("no boxes");
    boxes = time_of(*rig);
  }
  char note[80];
  std::snprintf(note, sizeof note, "%.2f, %.2f, %.2f ms", 1e3 * plain, 1e3 * labels, 1e3 * boxes);
  const std::string name = triangles >= 100000 ? "100 k triangles" : "1 k triangles";
  bool is_kept = print("320x240, " + name + ": labels against a plain image", labels / plain, "times", 1.3, false, note);
  is_kept &= print("  image with boxes against a plain image", boxes / plain, "times", 1.3, false);
  return is_kept;
}

sim::WorldDef load(const std::string& file) {
  auto loaded = sim::load_world(file, sim::ModelPath::from_environment({}, RTMSIM_WORLDS_DIR));
  if (!loaded) throw std::runtime_error(loaded.error().message);
  return std::move(loaded->world);
}

// A world of ours with its own camera: what is left of real time, and how many pictures it can make.
bool bench_farm(int rounds) {
  bool is_kept = true;
  {
    Rig rig(load(std::string(RTMSIM_WORLDS_DIR) + "/farm.sdf"), "helicopter::camera");
    for (int i = 0; i < 300; ++i) rig.step();
    const double step = best_of(rounds, 500, [&] { rig.step(); });
    is_kept = print("farm.sdf, 1 ms steps, its 320x240 camera at 30 Hz", 0.001 / step, "x real", 8, true);
  }
  sim::WorldDef def = load(std::string(RTMSIM_WORLDS_DIR) + "/farm.sdf");
  for (auto& model : def.models)
    for (auto& link : model.links)
      for (auto& sensor : link.sensors) sensor.update_rate = 1000;
  Rig rig(std::move(def), "helicopter::camera");
  for (int i = 0; i < 20; ++i) rig.step();
  const double step = best_of(10 * rounds, 15, [&] { rig.step(); });
  return print("farm.sdf, a picture each step", 1 / step, "frames/s", 300, true) && is_kept;
}

double resident_mib() {
  std::ifstream file("/proc/self/statm");
  double pages = 0, resident = 0;
  file >> pages >> resident;
  return resident * static_cast<double>(::sysconf(_SC_PAGESIZE)) / 1048576;
}

// The shared memory of the camera's iface against its frames.
bool bench_ring(const Rig& rig, double frame_bytes) {
  const std::string server = "-" + std::to_string(rig.server->id()) + ".camera.";
  double bytes = 0;
  for (const auto& entry : std::filesystem::directory_iterator("/dev/shm")) {
    if (entry.path().filename().string().find(server) != std::string::npos) bytes += static_cast<double>(entry.file_size());
  }
  constexpr double slots = 4;
  return print("shared memory of a camera, in rings of four frames", bytes / (slots * frame_bytes), "times", 1.1, false) && bytes > 0;
}

bool bench_memory(const Textures& textures, int frames) {
  bool is_kept = true;
  {
    // Small pictures, as it is their number that counts.
    Rig rig(make_world(120, textures, 4, 1000, 64, 48), "eye::camera");
    for (int i = 0; i < 2000; ++i) rig.move_and_step();
    const double before = resident_mib();
    for (int i = 0; i < frames / 10; ++i) rig.move_and_step();
    const double early = resident_mib();
    for (int i = frames / 10; i < frames; ++i) rig.move_and_step();
    const double after = resident_mib();
    char what[100], note[100];
    std::snprintf(what, sizeof what, "memory gained over %d frames", frames);
    std::snprintf(note, sizeof note, "resident: %.2f MiB after %d frames, %.2f MiB after %d", early, frames / 10, after, frames);
    is_kept = print(what, after - before, "MiB", 1, false, note);
  }
  Rig full(make_world(120, textures, 0, 1000), "eye::camera");
  return bench_ring(full, 3.0 * width * height) && is_kept;
}

}  // namespace

int main(int argc, char** argv) {
  ::test::answer_help(argc, argv,
                      "render_bench [--quick] [--only 1k|100k|labels|farm|memory]\nMeasures images of cameras beside a plain OSMesa loop.");
  bool is_quick = false;
  std::string only;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--quick") == 0) is_quick = true;
    if (std::strcmp(argv[i], "--only") == 0 && i + 1 < argc) only = argv[++i];
  }
  const int rounds = is_quick ? 10 : 60;
  try {
    const Textures textures;
    bool is_kept = true;
    if (only.empty() || only == "1k") {
      is_kept &= bench_scene(1000, textures, 300, rounds);
      is_kept &= bench_movers(1000, textures, 300, rounds);
    }
    if (only.empty() || only == "100k") {
      is_kept &= bench_scene(100000, textures, 80, rounds);
      is_kept &= bench_movers(100000, textures, 80, rounds);
    }
    if (only.empty() || only == "labels") {
      is_kept &= bench_labels(1000, textures, rounds);
      is_kept &= bench_labels(100000, textures, rounds / 3);
    }
    if (only.empty() || only == "farm") is_kept &= bench_farm(is_quick ? 3 : 10);
    if (only.empty() || only == "memory") is_kept &= bench_memory(textures, is_quick ? 10000 : 100000);
    return is_kept ? 0 : 1;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "render_bench: %s\n", e.what());
    return 1;
  }
}
