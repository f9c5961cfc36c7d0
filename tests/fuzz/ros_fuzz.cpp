// Definitions and samples of ROS 2 as a recording of somebody else may hold them: whatever comes is read or refused. Mutates good ones;
// prints its seed. ros_fuzz [--runs N] [--seed N]
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include "channels/ros_schema.h"
#include "recording/expression.h"
#include "recording/ros_text.h"
#include "ros/messages.h"
#include "support/usage.h"

namespace {

void mutate(std::string& octets, std::mt19937& random) {
  const auto below = [&](std::size_t end) { return end == 0 ? 0 : random() % end; };
  for (std::size_t i = below(6) + 1; i > 0; --i) {
    switch (below(4)) {
      case 0:
        if (!octets.empty()) octets[below(octets.size())] = static_cast<char>(random());
        break;
      case 1:
        octets.resize(below(octets.size() + 1));
        break;
      case 2:
        octets.insert(below(octets.size() + 1), octets.substr(below(octets.size() + 1), below(40)));
        break;
      default: {
        static constexpr std::uint32_t numbers[] = {0, 1, 0xff, 0xffff, 0x7fffffff, 0xffffffff};
        const std::uint32_t number = numbers[below(std::size(numbers))];
        if (octets.size() >= 4) std::memcpy(octets.data() + below(octets.size() - 3), &number, 4);
      }
    }
  }
}

struct Seed {
  std::string definition, sample;
};

template <class Message>
Seed seed_of(const Message& message) {
  const auto octets = ros::encode(message);
  return {channels::schema_of<Message>().text, {octets.begin(), octets.end()}};
}

}  // namespace

int main(int argc, char** argv) {
  ::test::answer_help(argc, argv, "ros_fuzz [--runs N] [--seed N]\nReads damaged ROS messages; it must not crash or hang.");
  std::uint64_t runs = 20000, seed = std::random_device()();
  for (int i = 1; i + 1 < argc; i += 2) {
    if (std::strcmp(argv[i], "--runs") == 0) runs = std::strtoull(argv[i + 1], nullptr, 10);
    if (std::strcmp(argv[i], "--seed") == 0) seed = std::strtoull(argv[i + 1], nullptr, 10);
  }
  std::printf("ros_fuzz --runs %llu --seed %llu\n", static_cast<unsigned long long>(runs), static_cast<unsigned long long>(seed));
  std::fflush(stdout);
  std::mt19937 random(static_cast<std::mt19937::result_type>(seed));
  const float ranges[] = {1, 2, 3};
  const std::vector<Seed> seeds = {
      seed_of(ros::TFMessage{{{{{1, 2}, "world"}, "robot", {}}}}),
      seed_of(ros::LaserScan{.header = {{1, 2}, "laser"}, .ranges = ranges, .intensities = ranges}),
      seed_of(ros::DiagnosticArray{{{1, 2}, "f"}, {{ros::Byte{1}, "laser", "late", "", {{"age", "2 s"}}}}}),
      seed_of(ros::MarkerArray{{ros::Marker{.ns = "a", .points = {{1, 2, 3}}}}}),
  };
  const std::string condition = "A0:out.data[2].x < 0.1 && (pose(m).yaw >= 1 || !(state(B) == Error))";
  std::uint64_t good = 0;
  for (std::uint64_t run = 0; run < runs; ++run) {
    Seed one = seeds[random() % seeds.size()];
    if (random() % 2 == 0) mutate(one.definition, random);
    mutate(one.sample, random);
    const auto definition = recorder::RosDefinition::parse(one.definition);
    if (definition && definition->decode(one.sample)) ++good;
    std::string text = condition;
    mutate(text, random);
    if (const auto expression = recorder::Expression::parse(text)) (void)expression->holds([](const auto&) { return std::optional(1.0); });
  }
  std::printf("%llu of %llu were read\n", static_cast<unsigned long long>(good), static_cast<unsigned long long>(runs));
  return 0;
}
