#include "core/configuration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/text.h"
#include "support/lock_step.h"

namespace rt {
namespace {

using support::LockStep;
using support::TickAt;
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

TEST_F(ConfigurationTest, sets_and_their_memory_have_limits) {
  int added = 0;
  while (added < 10'000 && configuration.add({std::to_string(added), {}})) ++added;
  EXPECT_EQ(added, 4093) << "beside the three that it has";
  EXPECT_FALSE(configuration.set_values({"another", {{"gain", "1"}}}));
  EXPECT_TRUE(configuration.set_values({"7", {{"gain", "1"}}})) << "what is there may change";
  int taken = 0;
  while (taken < 1000 && configuration.set_values({"7", {{std::to_string(taken), std::string(1 << 20, 'x')}}})) ++taken;
  EXPECT_GT(taken, 50);
  EXPECT_LT(taken, 65);
  EXPECT_TRUE(configuration.set_values({"default", {{"gain", "3"}}}));
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

struct ConfigurationInLockStep : ConfigurationTest {
  ConfigurationInLockStep() {
    base::set_lock_step_clock(clock);
    tick(0);
  }
  ~ConfigurationInLockStep() override { base::set_lock_step_clock(nullptr); }
  // The gain that a tick of that time sees.
  int tick(int milliseconds) {
    clock->time = std::chrono::milliseconds(milliseconds);
    TickAt now(clock->time);
    const base::ScopedTick scope(now);
    configuration.update();
    return gain;
  }
  void set(const char* value) {
    configuration.set_values({"default", {{"gain", value}}});
    configuration.activate("default");
  }
  const std::shared_ptr<LockStep> clock = std::make_shared<LockStep>();
};

// Early and late phases of one tick take it at the same edge, whenever in between it came.
TEST_F(ConfigurationInLockStep, a_change_from_outside_is_for_later_ticks) {
  EXPECT_EQ(tick(10), 1);
  set("2");
  EXPECT_EQ(tick(10), 1);
  EXPECT_EQ(tick(20), 2);
  set("3");
  clock->time = std::chrono::milliseconds(30);
  set("4");
  EXPECT_EQ(tick(30), 3);
  EXPECT_EQ(configuration.set("default")->values.front().second, "4");
  EXPECT_EQ(tick(40), 4);
}

TEST_F(ConfigurationInLockStep, a_set_that_is_activated_at_a_later_time_waits_for_that) {
  configuration.set_values({"default", {{"gain", "2"}}});
  clock->time = std::chrono::milliseconds(10);
  configuration.activate("default");
  EXPECT_EQ(tick(10), 1);
  EXPECT_EQ(tick(20), 2);
}

TEST_F(ConfigurationInLockStep, a_change_by_the_tick_itself_counts_at_once) {
  set("2");
  TickAt now(clock->time);
  const base::ScopedTick scope(now);
  configuration.activate("fast");
  configuration.update();
  EXPECT_EQ(gain, 9);
}

TEST_F(ConfigurationInLockStep, a_change_in_a_tick_leaves_what_came_from_outside_for_the_next) {
  configuration.bind("offset", "0", [](const char*) { return true; });
  set("2");
  TickAt now(clock->time);
  {
    const base::ScopedTick scope(now);
    configuration.set_values({"default", {{"offset", "1"}}});
    configuration.activate("default");
    configuration.update();
  }
  EXPECT_EQ(gain, 1);
  EXPECT_EQ(tick(10), 2);
}

TEST_F(ConfigurationInLockStep, a_change_while_time_stands_still_is_for_the_next_tick_of_any_time) {
  clock->is_paused = true;
  set("2");
  clock->is_paused = false;
  EXPECT_EQ(tick(0), 2);
}

TEST_F(ConfigurationInLockStep, a_change_of_the_run_before_a_reset_does_not_wait_for_its_time) {
  clock->time = std::chrono::seconds(50);
  set("2");
  ++clock->runs;
  EXPECT_EQ(tick(0), 2);
}

TEST(Configuration, has_a_default_set_from_the_start) {
  Configuration configuration;
  EXPECT_TRUE(configuration.has("default"));
  EXPECT_TRUE(configuration.is_active());
}

}  // namespace
}  // namespace rt
