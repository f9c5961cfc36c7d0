#include "shm/control.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <vector>

namespace shm {
namespace {

TEST(Control, poses_are_made_of_three_four_or_six_numbers) {
  EXPECT_EQ(pose_of(std::vector<double>{1, 2, 0})->y, 2);
  EXPECT_EQ(pose_of(std::vector<double>{1, 2, 3, 0})->z, 3);
  EXPECT_NEAR(yaw_of(*pose_of(std::vector<double>{1, 2, 3, 0, 0, 0.5})), 0.5, 1e-12);
  EXPECT_FALSE(pose_of(std::vector<double>{1, 2}));
  EXPECT_TRUE(set_pose_request("m", std::vector<double>{1, 2, 0})->is_planar);
  EXPECT_FALSE(set_pose_request("m", std::vector<double>{1, 2, 3, 0})->is_planar);
}

TEST(Control, what_is_spawned_is_a_text_a_file_or_a_name_of_the_model_path) {
  const auto file = std::filesystem::path(testing::TempDir()) / ("control-" + std::to_string(getpid()) + ".sdf");
  std::ofstream(file) << "<sdf/>";
  EXPECT_FALSE(spawn_request("<sdf/>", false)->is_path);
  EXPECT_EQ(spawn_request("model://cow", true)->sdf, "model://cow");
  EXPECT_EQ(spawn_request("cow-that-is-no-file", false)->sdf, "model://cow-that-is-no-file");
  EXPECT_EQ(spawn_request(file.string(), false)->sdf, file.string());
  const auto for_shared = spawn_request(file.string(), true);
  EXPECT_EQ(for_shared->sdf, "<sdf/>");
  EXPECT_FALSE(for_shared->is_path);
  std::filesystem::remove(file);
  const auto missing = spawn_request(file.string(), false);
  ASSERT_FALSE(missing);
  EXPECT_NE(missing.error().message.find("no such file"), std::string::npos);
}

TEST(Control, a_refusal_is_an_error_that_names_the_request) {
  Reply reply;
  reply.status = RequestStatus::not_found;
  reply.message = "no model or link nobody";
  const auto refused = without_refusal(GetPoseRequest{"nobody"}, reply);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message, "get-pose: no model or link nobody");
}

TEST(Control, pictures_are_PNG) {
  EXPECT_EQ(picture_name_problem("a/b.PNG"), "");
  EXPECT_EQ(picture_name_problem("plain"), "");
  EXPECT_EQ(picture_name_problem("a.jpg"), "pictures are PNG; expected a name that ends in .png, got \"a.jpg\"");
}

}  // namespace
}  // namespace shm
