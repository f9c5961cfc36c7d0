// Messages for ports and for the gateway, and requests of services, as any participant of DDS can send them: whatever comes is read or
// refused. Mutates good ones; prints its seed. ros2_fuzz [--runs N] [--seed N]. A user's bound: 10^6 runs with the address sanitizer.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "mappings/geometry.h"
#include "mappings/numbers.h"
#include "mappings/sensors.h"
#include "ros/action_messages.h"
#include "ros/command_messages.h"
#include "ros/graph_messages.h"
#include "ros/parameter_services.h"
#include "ros/simulation_services.h"
#include "support/usage.h"

namespace {

using Bytes = std::vector<std::uint8_t>;

struct Entrance {
  Bytes good;
  std::function<bool(const Bytes&)> read;
};

Bytes bytes_of(const auto& message) {
  const auto octets = ros::encode(message);
  return {octets.begin(), octets.end()};
}

// Of the gateway: a command, a request, or the graph of a peer.
template <class Message>
Entrance message(const Message& good) {
  return {bytes_of(good), [](const Bytes& bytes) { return ros::decode<Message>(bytes).has_value(); }};
}

// Of a port: what was read is sent on.
template <class Mapping>
Entrance port(const typename Mapping::Message& good) {
  const auto stream = std::make_shared<ros2::MappedStream<Mapping>>();
  return {bytes_of(good), [stream](const Bytes& bytes) {
            typename Mapping::Data data{};
            stream->writeData(bytes.data(), bytes.size());
            return stream->deserialize(data) && stream->serialize(data);
          }};
}

void mutate(Bytes& bytes, std::mt19937& random) {
  const auto below = [&](std::size_t end) { return end == 0 ? 0 : random() % end; };
  for (std::size_t i = below(6) + 1; i > 0; --i) {
    switch (below(4)) {
      case 0:
        if (!bytes.empty()) bytes[below(bytes.size())] = static_cast<std::uint8_t>(random());
        break;
      case 1:
        bytes.resize(below(bytes.size() + 1));
        break;
      case 2: {
        const std::size_t begin = below(bytes.size() + 1), end = begin + below(bytes.size() + 1 - begin);
        const Bytes part(bytes.begin() + static_cast<std::ptrdiff_t>(begin), bytes.begin() + static_cast<std::ptrdiff_t>(end));
        bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(below(bytes.size() + 1)), part.begin(), part.end());
        break;
      }
      default: {
        static constexpr std::uint32_t numbers[] = {0, 1, 2, 0xff, 0xffff, 0x10000, 0x7fffffff, 0x80000000, 0xffffffff};
        const std::uint32_t number = numbers[below(std::size(numbers))];
        if (bytes.size() >= 4) std::memcpy(bytes.data() + below(bytes.size() - 3) / 4 * 4, &number, 4);
      }
    }
  }
}

std::vector<Entrance> entrances() {
  static const float ranges[] = {1, 2, 3};
  static const std::uint8_t octets[48] = {1, 2, 3};
  const ros::Header header{{1, 2}, "frame"};
  ros::Pose pose{{1, 2, 3}, {0, 0, 0, 1}};
  const std::vector<ros::PointField> fields = {{"x", 0}, {"y", 4}, {"z", 8}, {"rgb", 12}};
  const ros::PointCloud2 cloud{.header = header,
                               .height = 1,
                               .width = 3,
                               .point_fields = fields,
                               .point_step = 16,
                               .row_step = 48,
                               .data = octets,
                               .is_dense = true};
  const ros::JointState joints{.header = header, .names = {"a", "b"}, .position = {1, 2}, .velocity = {3, 4}, .effort = {5, 6}};
  const ros::Imu imu{.header = header};
  ros::ParticipantEntitiesInfo graph;
  graph.node_entities_info_seq.push_back(
      {ros::BoundedText<256>(std::string("/a")), ros::BoundedText<256>(std::string("n")), {{}}, {{}, {}}});
  ros::JointTrajectory path{.header = header, .joint_names = {"a"}};
  path.points.push_back({{1}, {2}, {}, {}, {1, 0}});
  return {
      port<ros2::RangesAndScan>({.header = header, .range_max = 8, .ranges = ranges, .intensities = ranges}),
      port<ros2::ImageAndImage>({.header = header, .height = 4, .width = 4, .encoding = "rgb8", .step = 12, .data = octets}),
      port<ros2::ImageAndCompressedImage>({header, "jpeg", octets}),
      port<ros2::PointsAndCloud>(cloud),
      port<ros2::CloudAndCloud>(cloud),
      port<ros2::ActuatorsAndJoints>(joints),
      port<ros2::NumbersAndJoints>(joints),
      port<ros2::GpsAndFix>({.header = header, .latitude = 1}),
      port<ros2::OrientationAndImu>(imu),
      port<ros2::PoseAndOdometry<RTC::TimedPoseVel3D>>({.header = header, .child_frame_id = "b"}),
      port<ros2::PoseAndPose<RTC::TimedPose2D>>({header, pose}),
      port<ros2::VelocityAndStampedTwist<RTC::TimedVelocity2D>>({header, {}}),
      port<ros2::NumberAndNumber<RTC::TimedShort, ros::Float64>>({1e9}),
      port<ros2::TextAndString>({"text"}),
      port<ros2::SequenceAndArray<RTC::TimedOctetSeq, ros::Float32MultiArray>>({{{{"d", 3, 3}}, 1}, {1, 2, 3}}),
      port<ros2::SequenceAndArray<RTC::TimedBooleanSeq, ros::UInt8MultiArray>>({{}, {1, 2, 3}}),
      message(path),
      message(ros::Float64MultiArray{{{{"d", 3, 3}}, 0}, {1, 2, 3}}),
      message(graph),
      message(ros::ListParametersRequest{{"a", "b"}, 1}),
      message(ros::GetParametersRequest{{"a", "b"}}),
      message(ros::SetParametersRequest{{{"a", {}}}}),
      message(ros::SpawnEntityRequest{"n", true, "u", "r", "s", {header, pose}}),
      message(ros::SpawnEntitiesRequest{{{"n", true, {"u", "r"}, "s", {header, pose}}, {}}}),
      message(ros::SimulateStepsSendGoalRequest{{{1, 2, 3}}, {10}}),
      message(ros::CancelGoalRequest{{{{1, 2, 3}}, {1, 2}}}),
      message(ros::SpawnEntityRequest2{"n", true, {"u", "r"}, "s", {header, pose}}),
      message(ros::SetEntityStateRequest{"n", {header, pose, {}, {}}}),
      message(ros::GetEntitiesRequest{{"a.*", {}, {{"t"}, 0}, {1, {{1, 2, 3}}}}}),
      message(ros::GetSpawnablesRequest{{"a"}}),
      message(ros::GetEntityBoundsRequest{"a"}),
      message(ros::StepSimulationRequest{3}),
  };
}

}  // namespace

int main(int argc, char** argv) {
  ::test::answer_help(argc, argv,
                      "ros2_fuzz [--runs N] [--seed N]\nReads damaged messages and requests of ROS 2; it must not crash or hang.");
  std::uint64_t runs = 20000, seed = std::random_device()();
  for (int i = 1; i + 1 < argc; i += 2) {
    if (std::strcmp(argv[i], "--runs") == 0) runs = std::strtoull(argv[i + 1], nullptr, 10);
    if (std::strcmp(argv[i], "--seed") == 0) seed = std::strtoull(argv[i + 1], nullptr, 10);
  }
  std::printf("ros2_fuzz --runs %llu --seed %llu\n", static_cast<unsigned long long>(runs), static_cast<unsigned long long>(seed));
  std::fflush(stdout);
  std::mt19937 random(static_cast<std::mt19937::result_type>(seed));
  const auto all = entrances();
  for (const auto& one : all) {
    if (!one.read(one.good)) return std::fprintf(stderr, "a good message is refused\n"), 1;
  }
  std::uint64_t good = 0;
  for (std::uint64_t run = 0; run < runs; ++run) {
    const Entrance& one = all[random() % all.size()];
    Bytes bytes = one.good;
    mutate(bytes, random);
    if (one.read(bytes)) ++good;
  }
  std::printf("%llu of %llu damaged messages could be read\n", static_cast<unsigned long long>(good),
              static_cast<unsigned long long>(runs));
  return 0;
}
