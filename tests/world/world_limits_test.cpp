// Files that are large or repeat themselves: loaded in a time that grows with them, or refused with the limit that they break. Where a cost
// is quadratic these tests reach their watchdog.
#include <gmock/gmock.h>

#include "support/memory_limit.h"
#include "support/world_files.h"

namespace sim {
namespace {

using testing::HasSubstr;

std::string repeated(int count, const std::function<std::string(int)>& part) {
  std::string text;
  for (int i = 0; i < count; ++i) text += part(i);
  return text;
}

TEST(LargeFiles, with_too_many_attributes_on_an_element_are_refused) {
  const std::string attributes = repeated(100000, [](int i) { return " a" + std::to_string(i) + "='1'"; });
  for (const char* version : {"1.4", "1.9"}) {
    const auto result = WorldFiles().load_text("<sdf version='" + std::string(version) + "'><world name='w'>\n<model name='m'" +
                                               attributes + "/></world></sdf>");
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().message, "w.sdf:2: model \"m\" has more than 1000 attributes");
  }
}

TEST(LargeFiles, with_one_name_for_everything_are_numbered) {
  const WorldFiles files;
  files.write_model("box", "<model name='box'><static>1</static><link name='l'/></model>");
  const LoadResult models = files.load(repeated(20000, [](int) { return "<include><uri>model://box</uri></include>"; }));
  ASSERT_EQ(models.world.models.size(), 20000U);
  EXPECT_EQ(models.world.models.back().name, "box_19999");
  const LoadResult visuals =
      files.load(model_of(repeated(20000, [](int) { return "<visual name='v'><geometry><box/></geometry></visual>"; })));
  EXPECT_EQ(visuals.world.models.at(0).links.at(0).visuals.back().name, "v_19999");
  const LoadResult sensors =
      files.load("<model name='m'>" +
                 repeated(200,
                          [](int i) {
                            return "<link name='l" + std::to_string(i) + "'>" +
                                   repeated(100, [](int k) { return "<sensor name='s" + std::to_string(k) + "' type='imu'/>"; }) +
                                   "</link>";
                          }) +
                 "</model>");
  ASSERT_EQ(sensors.world.models.size(), 1U) << all_findings(sensors);
  EXPECT_EQ(sensors.world.models[0].links.back().sensors.back().iface, "s99_199");
}

TEST(LargeFiles, with_a_model_of_too_many_frames_lose_the_model_alone) {
  const LoadResult result =
      WorldFiles().load("<model name='big'>" + repeated(5001, [](int i) { return "<link name='l" + std::to_string(i) + "'/>"; }) +
                        "</model><model name='small'><link name='l'/></model>");
  EXPECT_EQ(result.world.models.size(), 1U);
  EXPECT_EQ(findings_with(result, "model \"big\" has more than 5000 links, joints, frames and nested models in all and is left out"), 1)
      << all_findings(result);
}

TEST(LargeFiles, that_become_too_large_by_what_they_include_are_refused) {
  const WorldFiles files;
  const std::string links = repeated(4000, [](int i) { return "<link name='l" + std::to_string(i) + "'/>"; });
  files.write_model("fat", "<model name='fat'><static>1</static>" + links + "</model>");
  const auto world_of = [](int count, const std::string& part) {
    return "<sdf version='1.9'><world name='w'>" + repeated(count, [&](int) { return part; }) + "</world></sdf>";
  };
  const std::string included = "<include><uri>model://fat</uri></include>";
  const std::string spread = "<population name='p'><model name='m'><static>1</static>" + links +
                             "</model><model_count>10000</model_count><distribution><type>random</type></distribution>"
                             "<box><size>1 1 1</size></box></population>";
  const std::string line = "w.sdf: the world has more than 10000000 elements with all it includes";
  for (const std::string& text : {world_of(2600, included), world_of(1, spread)}) {
    const auto result = files.load_text(text);
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().message, line);
  }
  EXPECT_EQ(files.load(repeated(100, [&](int) { return included; })).world.models.size(), 100U);
}

TEST(LargeFiles, with_many_saved_places_are_loaded) {
  const auto models = repeated(10000, [](int i) { return "<model name='m" + std::to_string(i) + "'><link name='l'/></model>"; });
  const auto places = repeated(10000, [](int i) {
    const std::string pose = "<pose>" + std::to_string(i) + " 0 0 0 0 0</pose>";
    return "<model name='m" + std::to_string(i) + "'>" + pose + "<link name='l'>" + pose + "</link></model>";
  });
  const LoadResult result = WorldFiles().load(models + "<state world_name='w'>" + places + "</state>");
  ASSERT_EQ(result.world.models.size(), 10000U);
  EXPECT_EQ(result.world.models.back().pose.translation().x(), 9999);
}

TEST(LargeFiles, with_a_long_road_are_loaded) {
  const LoadResult result =
      WorldFiles().load("<road name='r'><width>2</width><material><diffuse>1 0 0 1</diffuse></material>" +
                        repeated(50000, [](int i) { return "<point>" + std::to_string(i) + " 0 0</point>"; }) + "</road>");
  ASSERT_EQ(result.world.models.size(), 1U);
  EXPECT_EQ(result.world.models[0].links.at(0).visuals.size(), 99999U);
}

TEST(LargeFiles, that_the_memory_does_not_hold_are_named) {
  if (!test::MemoryLimit::is_kept) GTEST_SKIP() << "sanitizers need the memory";
  const WorldFiles files;
  const std::string text = "<sdf version='1.9'><world name='w'><!--" + std::string(48U << 20U, 'x') + "--></world></sdf>";
  const test::MemoryLimit limit(16U << 20U);
  const auto result = files.load_text(text);
  ASSERT_FALSE(result);
  EXPECT_THAT(result.error().message, testing::StartsWith("w.sdf: "));
  EXPECT_THAT(result.error().message, HasSubstr("memory"));
}

}  // namespace
}  // namespace sim
