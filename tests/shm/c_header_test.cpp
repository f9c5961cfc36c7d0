#include <gtest/gtest.h>

#include <thread>

#include "shm/request_board.h"
#include "shm/shm_support.h"

extern "C" int run_c_client(std::uint32_t server);

namespace shm::test {
namespace {

TEST(CHeader, a_client_in_c_lists_reads_waits_holds_commands_and_asks) {
  Fixture f;
  auto simulation = f.make(simulation_spec(simulation_info()));
  auto laser = f.make(iface_spec(IfaceType::laser, "robot::laser", laser_info()));
  auto camera = f.make(camera_spec(IfaceType::camera, "eye", camera_info()));
  auto base = f.make(iface_spec(IfaceType::position2d, "base", Position2dInfo{}));
  laser->ranges()[7] = 3.5F;
  laser->publish(1s);
  const auto data = *camera->begin_frame();
  std::fill(data.begin(), data.end(), std::byte{42});
  camera->publish_frame(1s, identity_pose);
  RequestBoard board(*simulation, *f.server);
  std::atomic<bool> is_over{false};
  double last_turn = 0;
  std::thread server([&] {
    while (!is_over) {
      board.wait(std::chrono::steady_clock::now() + 100ms);
      Command command{};
      if (base->poll_command(command) == CommandChange::fresh) last_turn = command.values[2];
      for (const auto& asked : board.poll()) {
        Reply reply;
        reply.steps = static_cast<std::uint64_t>(std::get<StepRequest>(asked.request).steps);
        reply.text = "done";
        board.reply(asked.ticket, reply);
      }
    }
  });
  EXPECT_EQ(run_c_client(f.id), 0) << "the line of tests/shm/c_client.c that failed";
  is_over = true;
  board.wake();
  server.join();
  EXPECT_EQ(last_turn, -0.5);
}

}  // namespace
}  // namespace shm::test
