#include "core/configuration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/text.h"

namespace rt {
namespace {

using testing::ElementsAre;

Configuration::Assign to_int(int& variable) {
  return [&variable](const char* text) {
    const auto number = base::parse_integer(text);
    if (number) variable = static_cast<int>(*number);
    return number.has_value();
  };
}

struct ConfigurationTest : testing::Test {
  ConfigurationTest() {
    configuration.load({"default", {{"gain", "1"}}});
    configuration.load({"fast", {{"gain", "9"}}});
    configuration.load({"__widget__", {{"gain", "spin"}}});
    configuration.bind("gain", "5", to_int(gain));
  }
  Configuration configuration;
  int gain = 0;
};

TEST_F(ConfigurationTest, a_bound_variable_takes_the_value_of_the_active_set_at_once) { EXPECT_EQ(gain, 1); }

TEST_F(ConfigurationTest, a_bound_variable_without_a_value_takes_its_default) {
  int offset = 0;
  configuration.bind("offset", "7", to_int(offset));
  EXPECT_EQ(offset, 7);
}

TEST_F(ConfigurationTest, a_name_is_bound_once) {
  int other = 0;
  EXPECT_FALSE(configuration.bind("gain", "2", to_int(other)));
  EXPECT_EQ(other, 0);
}

TEST_F(ConfigurationTest, values_are_assigned_when_the_set_is_activated_and_updated) {
  ASSERT_TRUE(configuration.set_values({"default", {{"gain", "2"}}}));
  EXPECT_FALSE(configuration.is_active());
  EXPECT_FALSE(configuration.update());
  EXPECT_EQ(gain, 1);
  ASSERT_TRUE(configuration.activate("default"));
  EXPECT_EQ(gain, 1);
  const auto update = configuration.update();
  ASSERT_TRUE(update);
  EXPECT_EQ(update->set, "default");
  EXPECT_THAT(update->parameters, ElementsAre("gain"));
  EXPECT_EQ(gain, 2);
  EXPECT_FALSE(configuration.update()) << "nothing has changed since";
}

TEST_F(ConfigurationTest, another_set_can_be_active) {
  ASSERT_TRUE(configuration.activate("fast"));
  configuration.update();
  EXPECT_EQ(gain, 9);
  EXPECT_EQ(configuration.active_id(), "fast");
}

TEST_F(ConfigurationTest, what_cannot_be_converted_gives_the_default_and_stays_as_text) {
  configuration.set_values({"default", {{"gain", "much"}}});
  configuration.activate("default");
  configuration.update();
  EXPECT_EQ(gain, 5);
  EXPECT_THAT(configuration.set("default")->values, ElementsAre(std::pair("gain", "much")));
}

TEST_F(ConfigurationTest, descriptions_and_unknown_sets_cannot_be_active) {
  EXPECT_FALSE(configuration.activate("__widget__"));
  EXPECT_FALSE(configuration.activate("slow"));
  EXPECT_FALSE(configuration.activate(""));
  EXPECT_EQ(configuration.active_id(), "default");
}

TEST_F(ConfigurationTest, values_are_merged_and_keep_their_order) {
  configuration.set_values({"fast", {{"z", "1"}, {"gain", "8"}, {"a", "2"}}});
  EXPECT_THAT(configuration.set("fast")->values, ElementsAre(std::pair("gain", "8"), std::pair("z", "1"), std::pair("a", "2")));
  EXPECT_FALSE(configuration.set_values({"", {}}));
}

TEST_F(ConfigurationTest, values_of_an_unknown_set_make_it) {
  EXPECT_TRUE(configuration.set_values({"slow", {{"gain", "0.25"}}}));
  EXPECT_TRUE(configuration.activate("slow"));
  EXPECT_EQ(configuration.active_id(), "slow");
  EXPECT_TRUE(configuration.activate("default"));
  EXPECT_TRUE(configuration.remove("slow"));
}

TEST_F(ConfigurationTest, only_added_sets_that_are_not_active_can_be_removed) {
  EXPECT_FALSE(configuration.remove("fast"));
  EXPECT_FALSE(configuration.add({"fast", {}}));
  EXPECT_FALSE(configuration.add({"", {}}));
  ASSERT_TRUE(configuration.add({"slow", {{"gain", "0"}}}));
  configuration.activate("slow");
  EXPECT_FALSE(configuration.remove("slow"));
  configuration.activate("default");
  EXPECT_TRUE(configuration.remove("slow"));
  EXPECT_FALSE(configuration.has("slow"));
}

TEST(Configuration, has_a_default_set_from_the_start) {
  Configuration configuration;
  EXPECT_TRUE(configuration.has("default"));
  EXPECT_TRUE(configuration.is_active());
}

}  // namespace
}  // namespace rt
