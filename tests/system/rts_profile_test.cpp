#include "system/profile/rts_profile.h"
#include "support/paths.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace tools {
namespace {

std::string golden(const std::string& name) { return std::string(paths::source_dir) + "/tests/golden/" + name; }

void expect_same(const SavedSystem& a, const SavedSystem& b) {
  EXPECT_EQ(to_xml(a), to_xml(b));
  EXPECT_EQ(a.components.size(), b.components.size());
  EXPECT_EQ(a.connectors.size(), b.connectors.size());
}

TEST(RtsProfile, a_system_saved_by_rtcryo_is_read) {
  const auto system = read_system(golden("rtsprofile_cpp.xml"));
  ASSERT_TRUE(system.ok()) << system.error().message;
  ASSERT_EQ(system->components.size(), 4u);
  EXPECT_EQ(system->components[0].id, "RTC:AIST:example:ConsoleOut:2.0.0");
  EXPECT_EQ(system->components[0].path_uri, "127.0.0.1:2898/ConsoleOut0.rtc");
  EXPECT_EQ(system->components[0].contexts.at(0).rate, "100.0");
  const auto data =
      std::find_if(system->connectors.begin(), system->connectors.end(), [](const auto& connector) { return connector.is_data; });
  ASSERT_NE(data, system->connectors.end());
  EXPECT_EQ(data->id, "smokeid1");
  EXPECT_EQ(data->subscription_type, "new");
  EXPECT_EQ(data->source.port_name, "SeqOut0.Long");
  EXPECT_EQ(data->target.path_uri, "127.0.0.1:2898/ConsoleOut0.rtc");
  EXPECT_TRUE(std::any_of(system->connectors.begin(), system->connectors.end(), [](const auto& connector) { return !connector.is_data; }));
}

TEST(RtsProfile, xml_and_yaml_keep_everything) {
  for (const auto name : {"rtsprofile_cpp.xml", "rtsprofile_python.xml", "rtsprofile_hidden_sets.xml", "rtsprofile_hidden_sets.yaml"}) {
    auto system = read_system(golden(name));
    ASSERT_TRUE(system.ok()) << system.error().message;
    system->components[0].place = {40, -7, 120, 66, "right"};
    system->start_up = {{"SeqOut0", "127.0.0.1:2898/SeqOut0.rtc", "RTC:AIST:example:SeqOut:2.0.0", "0", 2}};
    const auto xml = parse_xml(to_xml(*system), "copy.xml");
    ASSERT_TRUE(xml.ok()) << xml.error().message;
    expect_same(*system, *xml);
    const auto yaml = parse_yaml(to_yaml(*system), "copy.yaml");
    ASSERT_TRUE(yaml.ok()) << yaml.error().message;
    expect_same(*system, *yaml);
  }
}

TEST(RtsProfile, places_of_boxes_are_read_and_written) {
  auto system = read_system(golden("rtsprofile_cpp.xml"));
  ASSERT_TRUE(system.ok()) << system.error().message;
  EXPECT_FALSE(system->components[0].place.is_placed());
  system->components[0].place = {40, -7, 120, 66, "right"};
  for (const auto& copy : {parse_xml(to_xml(*system), "copy.xml"), parse_yaml(to_yaml(*system), "copy.yaml")}) {
    ASSERT_TRUE(copy.ok()) << copy.error().message;
    const auto& [x, y, width, height, direction] = copy->components[0].place;
    EXPECT_EQ(std::vector({x, y, width, height}), (std::vector{40, -7, 120, 66}));
    EXPECT_EQ(direction, "right");
    EXPECT_FALSE(copy->components[1].place.is_placed());
  }
  EXPECT_NE(to_xml(*system).find(
                R"(<rtsExt:Location rtsExt:x="40" rtsExt:y="-7" rtsExt:height="66" rtsExt:width="120" rtsExt:direction="right")"),
            std::string::npos);
}

TEST(RtsProfile, yaml_that_python_wrote_is_read) {
  const auto system = parse_yaml(R"(rtsProfile:
  id: 'RTSystem:a:b:1'
  creationDate: {year: 2008, month: 5, day: 6, hour: 13, minute: 49, second: 53}
  components:
  - {id: 'RTC:a:b:c:1', instanceName: C0, pathUri: localhost/C0.rtc, isRequired: true, dataPorts: [{name: out, 'rtsExt::visible': true}],
     'rtsExt::properties': [{name: IOR, value: x}]}
)",
                                 "a.yaml");
  ASSERT_TRUE(system.ok()) << system.error().message;
  EXPECT_EQ(system->creation_date, "2008-05-06T13:49:53");
  ASSERT_EQ(system->components.size(), 1u);
  EXPECT_EQ(system->components[0].data_ports.at(0).name, "out");
  EXPECT_EQ(system->components[0].properties, (NamedValues{{"IOR", "x"}}));
}

TEST(RtsProfile, broken_files_are_refused_with_their_line) {
  const auto expect_error = [](const base::Result<SavedSystem>& system, const char* word) {
    ASSERT_FALSE(system.ok());
    EXPECT_NE(system.error().message.find(word), std::string::npos) << system.error().message;
  };
  expect_error(parse_xml("<a>\n<b>\n</a>", "f.xml"), "f.xml:3");
  expect_error(parse_xml("<a/>", "f.xml"), "RtsProfile");
  expect_error(parse_xml("<rts:RtsProfile rts:version=\"9\"/>", "f.xml"), "9");
  expect_error(parse_yaml("a: [", "f.yaml"), "f.yaml:");
  expect_error(parse_yaml("a: 1", "f.yaml"), "rtsProfile");
  expect_error(read_system("/proc/nowhere.xml"), "nowhere");
}

}  // namespace
}  // namespace tools
