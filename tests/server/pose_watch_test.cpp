// The two users of a pose watch: the file of sim-server --record, and the pose log that a client reads.
#include "server/pose_watch.h"

#include <gtest/gtest.h>
#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "server/memory_log.h"
#include "server/recorder.h"
#include "support/simulation_fixture.h"
#include "world/world_loader.h"

namespace sim {
namespace {

constexpr const char* falling_box = R"(<sdf version='1.9'><world name='w'>
  <model name='ground_plane'><static>true</static><link name='l'><collision name='c'><geometry><plane><normal>0 0 1</normal></plane></geometry></collision></link></model>
  <model name='box'><pose>0 0 0.4 0 0 0.3</pose><link name='l'><collision name='c'><geometry><box><size>0.2 0.2 0.2</size></box></geometry></collision></link></model>
</world></sdf>)";

struct FileLines final : shm::PoseLogSink {
  std::vector<std::string> lines;
  void pose(double time, const std::string& model, const shm::Pose& p) override {
    lines.push_back(fmt::format("{:.3f} {} {} {} {} {} {} {} {}", time, model, p.x, p.y, p.z, p.qw, p.qx, p.qy, p.qz));
  }
  void contact(double time, const std::string& model, const std::string& other) override {
    lines.push_back(fmt::format("contact {:.3f} {} {}", time, model, other));
  }
  void still(double time) override { lines.push_back(fmt::format("# {:.3f} nothing moves", time)); }
};

TEST(PoseWatch, a_client_reads_what_the_file_holds) {
  auto loaded = load_world_text(falling_box, "/", "w", ModelPath{});
  ASSERT_TRUE(loaded) << loaded.error().message;
  test::SimulationFixture f(std::move(loaded->world));
  const auto path = std::filesystem::path(testing::TempDir()) / ("pose-watch-" + std::to_string(getpid()));
  auto file = Recorder::open(path.string(), "w");
  ASSERT_TRUE(file);
  MemoryLog log;
  PoseWatch watch;
  const std::vector<PoseSink*> sinks{&*file, &log};
  watch.look(f.simulation->time(), f.simulation->physics(), sinks);
  for (int step = 0; step < 1000; ++step) {
    f.run(0.001);
    if (step == 700) f.simulation->remove(*f.simulation->physics().find("box"));
    watch.look(f.simulation->time(), f.simulation->physics(), sinks);
  }
  ASSERT_TRUE(file->finish());
  std::vector<std::string> written;
  std::ifstream in(path);
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with("# rtm-sim") && !line.starts_with("# time")) written.push_back(line);
  }
  std::filesystem::remove(path);
  FileLines read;
  ASSERT_TRUE(shm::PoseLogReader().read(*log.bytes().take(0), read));
  EXPECT_EQ(read.lines, written);
  EXPECT_EQ(written.size(), 12U) << "eleven moments and a contact";
}

}  // namespace
}  // namespace sim
