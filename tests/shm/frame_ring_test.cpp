#include <gtest/gtest.h>
#include <algorithm>
#include <random>
#include <thread>

#include "shm/shm_support.h"
#include "shm/words.h"

namespace shm::test {
namespace {

bool publish(IfaceWriter& camera, std::uint8_t value) {
  auto data = camera.begin_frame();
  if (!data) return false;
  std::fill(data->begin(), data->end(), std::byte{value});
  camera.publish_frame(std::chrono::milliseconds(value), planar_pose(value, 0, 0, 0));
  return true;
}

bool is_all(const HeldFrame& frame, std::uint8_t value) {
  return std::all_of(frame.data().begin(), frame.data().end(), [value](std::byte b) { return b == std::byte{value}; });
}

struct CameraFixture : Fixture {
  std::unique_ptr<IfaceWriter> camera = make(camera_spec(IfaceType::camera, "eye", camera_info()));
};

TEST(FrameRing, a_frame_is_held_as_it_was_published) {
  CameraFixture f;
  auto reader = f.open(IfaceType::camera, "eye");
  EXPECT_FALSE(reader.hold());
  ASSERT_TRUE(reader.subscribe());
  EXPECT_FALSE(reader.hold());
  ASSERT_TRUE(publish(*f.camera, 7));
  auto frame = reader.hold();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->sequence(), 1U);
  EXPECT_EQ(frame->head().stamp.sim_time_ns, 7'000'000);
  EXPECT_EQ(frame->head().pose.x, 7);
  EXPECT_EQ(frame->head().width, 32U);
  EXPECT_EQ(frame->head().stride, 32U);
  EXPECT_EQ(frame->head().format, static_cast<std::uint32_t>(RTMSIM_FORMAT_MONO8));
  EXPECT_EQ(frame->data().size(), 256U);
  EXPECT_TRUE(is_all(*frame, 7));
}

TEST(FrameRing, the_writer_goes_on_while_a_frame_is_held_and_never_touches_it) {
  CameraFixture f;
  auto reader = f.open(IfaceType::camera, "eye");
  ASSERT_TRUE(reader.subscribe());
  ASSERT_TRUE(publish(*f.camera, 1));
  auto held = reader.hold();
  for (std::uint8_t n = 2; n < 50; ++n) ASSERT_TRUE(publish(*f.camera, n));
  EXPECT_TRUE(is_all(*held, 1));
  EXPECT_TRUE(is_all(*reader.hold(), 49));
  EXPECT_EQ(f.camera->dropped(), 0U);
}

TEST(FrameRing, frames_are_dropped_and_counted_while_all_slots_are_held) {
  CameraFixture f;
  auto reader = f.open(IfaceType::camera, "eye");
  ASSERT_TRUE(reader.subscribe());
  std::vector<HeldFrame> held;
  for (std::uint8_t n = 1; n <= 4; ++n) {
    ASSERT_TRUE(publish(*f.camera, n));
    held.push_back(std::move(*reader.hold()));
  }
  EXPECT_FALSE(reader.hold()) << "no more than four at a time";
  EXPECT_FALSE(publish(*f.camera, 5));
  EXPECT_FALSE(publish(*f.camera, 6));
  EXPECT_EQ(f.camera->dropped(), 2U);
  for (std::uint8_t n = 1; n <= 4; ++n) EXPECT_TRUE(is_all(held[n - 1], n));
  held.erase(held.begin());
  EXPECT_TRUE(publish(*f.camera, 7));
  EXPECT_EQ(reader.sequence(), 5U);
}

TEST(FrameRing, a_held_frame_outlives_its_iface_and_its_writer) {
  CameraFixture f;
  std::optional<HeldFrame> frame;
  {
    auto reader = f.open(IfaceType::camera, "eye");
    ASSERT_TRUE(reader.subscribe());
    ASSERT_TRUE(publish(*f.camera, 9));
    frame = reader.hold();
  }
  EXPECT_FALSE(f.camera->is_subscribed());
  for (std::uint8_t n = 10; n < 20; ++n) ASSERT_TRUE(publish(*f.camera, n));
  f.camera.reset();
  EXPECT_TRUE(is_all(*frame, 9));
}

TEST(FrameRing, a_frame_given_back_after_the_iface_frees_the_lease) {
  CameraFixture f;
  {
    std::optional<HeldFrame> frame;
    auto reader = f.open(IfaceType::camera, "eye");
    ASSERT_TRUE(reader.subscribe());
    ASSERT_TRUE(publish(*f.camera, 9));
    frame = reader.hold();
    reader.unsubscribe();
  }
  for (std::size_t i = 0; i < f.camera->segment().area(AreaIndex::leases).count; ++i) {
    EXPECT_EQ(load(f.camera->segment().as<Lease>(AreaIndex::leases, i).owner), 0U);
  }
}

TEST(FrameRing, readers_that_hold_and_let_go_at_random_never_see_a_torn_frame) {
  CameraFixture f;
  std::atomic<bool> is_over{false};
  std::atomic<int> frames{0};
  const auto read_all = [&](unsigned seed) {
    std::mt19937 random(seed);
    auto reader = f.open(IfaceType::camera, "eye");
    ASSERT_TRUE(reader.subscribe());
    std::vector<HeldFrame> held;
    while (!is_over) {
      if (auto frame = reader.hold()) held.push_back(std::move(*frame));
      for (const auto& frame : held) {
        ASSERT_TRUE(is_all(frame, static_cast<std::uint8_t>(frame.head().pose.x)));
        ++frames;
      }
      if (!held.empty() && random() % 2 == 0) held.erase(held.begin() + random() % held.size());
    }
  };
  std::thread a(read_all, 1), b(read_all, 2);
  for (int n = 0; n < 20000 || frames < 5000; ++n) publish(*f.camera, static_cast<std::uint8_t>(n % 251));
  is_over = true;
  a.join();
  b.join();
  EXPECT_TRUE(publish(*f.camera, 1));
}

TEST(FrameRing, a_wait_for_a_frame_ends_when_it_comes) {
  CameraFixture f;
  auto reader = f.open(IfaceType::camera, "eye");
  ASSERT_TRUE(reader.subscribe());
  std::thread publisher([&] { publish(*f.camera, 3); });
  EXPECT_EQ(reader.wait(0, 60s), Wait::fresh);
  publisher.join();
  EXPECT_TRUE(is_all(*reader.hold(), 3));
}

}  // namespace
}  // namespace shm::test
