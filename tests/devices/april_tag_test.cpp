// The detector of AprilTags that Debian has finds the tags of worlds/devices.sdf in the picture of a camera, where the detector of marks
// says they are.
#include <apriltag/apriltag.h>
#include <apriltag/tag36h11.h>
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "support/devices_world.h"
#include "support/simulation_fixture.h"

namespace sim {
namespace {

using namespace test;

using Places = std::map<int, Eigen::Vector2d>;  // of the middles in the image [pixel], by id

Places found_in(const shm::HeldFrame& frame) {
  const auto& head = frame.head();
  std::vector<std::uint8_t> grey(std::size_t{head.width} * head.height);
  const auto* rgb = reinterpret_cast<const std::uint8_t*>(frame.data().data());
  for (std::size_t i = 0; i < grey.size(); ++i) grey[i] = static_cast<std::uint8_t>((rgb[3 * i] + 2 * rgb[3 * i + 1] + rgb[3 * i + 2]) / 4);
  image_u8_t image{static_cast<int>(head.width), static_cast<int>(head.height), static_cast<int>(head.width), grey.data()};
  apriltag_family_t* family = tag36h11_create();
  apriltag_detector_t* detector = apriltag_detector_create();
  apriltag_detector_add_family(detector, family);
  detector->quad_decimate = 1;
  zarray_t* detections = apriltag_detector_detect(detector, &image);
  Places places;
  for (int i = 0; i < zarray_size(detections); ++i) {
    apriltag_detection_t* one = nullptr;
    zarray_get(detections, i, &one);
    if (one->hamming == 0) places[one->id] = {one->c[0], one->c[1]};
  }
  apriltag_detections_destroy(detections);
  apriltag_detector_destroy(detector);
  tag36h11_destroy(family);
  return places;
}

TEST(AprilTag, is_found_in_the_picture_where_the_detector_of_marks_says_it_is) {
  SimulationFixture f(devices_world());
  f.simulation->pictures().set_synchronous(true);
  auto camera = f.open(shm::IfaceType::camera, "mast::camera");
  auto marks = f.open(shm::IfaceType::fiducial, "mast::marks");
  f.run(0.1);
  const auto frame = camera.hold();
  ASSERT_TRUE(frame && marks.read());
  const Places found = found_in(*frame);
  const auto& info = camera.info<shm::CameraInfo>();
  const auto* seen = reinterpret_cast<const shm::Mark*>(marks.sample_followers(0));
  std::set<int> seen_ids, found_ids;
  for (const auto& [id, place] : found) found_ids.insert(id);
  for (std::size_t i = 0; i < marks.filled(); ++i) {
    const auto& p = seen[i].pose;  // camera and detector are at the same place
    const int id = static_cast<int>(seen[i].id);
    seen_ids.insert(id);
    ASSERT_TRUE(found.contains(id)) << id;
    // The noise of the mark's place is 5 mm.
    EXPECT_NEAR(found.at(id).x(), info.cx - info.fx * p.y / p.x, 5) << id;
    EXPECT_NEAR(found.at(id).y(), info.cy - info.fy * p.z / p.x, 5) << id;
  }
  EXPECT_EQ(seen_ids, (std::set<int>{0, 1, 2}));
  EXPECT_EQ(found_ids, (std::set<int>{0, 1, 2}));
}

}  // namespace
}  // namespace sim
