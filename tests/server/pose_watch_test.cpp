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

TEST(PoseWatch, a_client_reads_the_joints_that_it_has_named_and_no_others) {
  auto loaded = load_world_text(R"(<sdf version='1.9'><world name='w'><model name='arm'><link name='base'/>
    <link name='upper'><pose>0 0 1 0 0 0</pose></link><link name='lower'><pose>0 0 1 0 0 0</pose></link>
    <joint name='foot' type='fixed'><parent>world</parent><child>base</child></joint>
    <joint name='shoulder' type='revolute'><parent>base</parent><child>upper</child><axis><xyz>0 0 1</xyz><initial_position>0.5</initial_position></axis></joint>
    <joint name='elbow' type='revolute'><parent>upper</parent><child>lower</child><axis><xyz>0 0 1</xyz></axis></joint></model></world></sdf>)",
                                "/", "w", ModelPath{});
  ASSERT_TRUE(loaded) << loaded.error().message;
  test::SimulationFixture f(std::move(loaded->world));
  struct Joints final : shm::PoseLogSink {
    std::vector<std::string> lines;
    void pose(double, const std::string&, const shm::Pose&) override {}
    void contact(double, const std::string&, const std::string&) override {}
    void still(double) override {}
    void joint(double time, const std::string& model, const std::string& joint, double position) override {
      lines.push_back(fmt::format("{:.1f} {}::{} {:.3f}", time, model, joint, position));
    }
  } read;
  MemoryLog log;
  log.watch_joints({"arm::shoulder", "arm::foot", "nobody::elbow"});
  PoseWatch watch;
  for (int step = 0; step <= 200; ++step) {
    watch.look(f.simulation->time(), f.simulation->physics(), {&log});
    f.run(0.001);
  }
  ASSERT_TRUE(shm::PoseLogReader().read(*log.bytes().take(0), read));
  EXPECT_EQ(read.lines, (std::vector<std::string>{"0.0 arm::shoulder 0.500", "0.1 arm::shoulder 0.500", "0.2 arm::shoulder 0.500"}));
}

}  // namespace
}  // namespace sim
