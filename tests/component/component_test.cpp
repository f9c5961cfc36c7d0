// Components in this process: callbacks and their threads, failures, end, listeners.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rtm/SystemLogger.h>

#include "support/component_fixture.h"
#include "support/lock_step.h"
#include "support/orb_environment.h"

namespace {

using support::ComponentTest;
using support::first_context;
using support::Owned;
using testing::ElementsAre;
using testing::HasSubstr;

TEST_F(ComponentTest, is_initialized_once) {
  EXPECT_EQ(probe->exit(), RTC::PRECONDITION_NOT_MET);
  EXPECT_EQ(probe->initialize(), RTC::RTC_OK);
  EXPECT_EQ(probe->initialize(), RTC::PRECONDITION_NOT_MET);
  RTC::ExecutionContextList_var contexts = probe->get_owned_contexts();
  EXPECT_EQ(contexts->length(), 1u);
  EXPECT_THAT(probe->trace(), ElementsAre("onInitialize", "onStartup"));
  EXPECT_EQ(probe->finalize(), RTC::PRECONDITION_NOT_MET);
}

TEST_F(ComponentTest, runs_callbacks_on_the_threads_that_authors_expect) {
  probe->initialize();
  probe->setExecutionRate(0, 200);
  probe->activate(0);
  ASSERT_TRUE(probe->wait_for("onStateUpdate"));
  probe->deactivate(0);
  const auto here = std::this_thread::get_id();
  const auto there = probe->thread_of("onExecute");
  EXPECT_NE(there, here);
  for (const char* name : {"onInitialize", "onStartup", "onRateChanged"}) EXPECT_EQ(probe->thread_of(name), here) << name;
  for (const char* name : {"onActivated", "onStateUpdate", "onDeactivated"}) EXPECT_EQ(probe->thread_of(name), there) << name;
}

TEST_F(ComponentTest, exit_deactivates_finalizes_and_shuts_down) {
  probe->initialize();
  probe->activate(0);
  ASSERT_TRUE(probe->wait_for("onStateUpdate"));
  EXPECT_EQ(probe->exit(), RTC::RTC_OK);
  EXPECT_THAT(probe->trace(), ElementsAre("onInitialize", "onStartup", "onActivated", "onExecute", "onStateUpdate", "onDeactivated",
                                          "onFinalize", "onShutdown"));
  EXPECT_EQ(probe->exit(), RTC::PRECONDITION_NOT_MET);
}

TEST_F(ComponentTest, exit_in_error_resets_first) {
  probe->initialize();
  set("fail", "onExecute");
  probe->activate(0);
  ASSERT_TRUE(probe->wait_for("onError"));
  EXPECT_EQ(state(), RTC::ERROR_STATE);
  EXPECT_EQ(probe->exit(), RTC::RTC_OK);
  EXPECT_THAT(probe->trace(), ElementsAre("onInitialize", "onStartup", "onActivated", "onExecute", "onDeactivated", "onAborting", "onError",
                                          "onReset", "onFinalize", "onShutdown"));
}

TEST_F(ComponentTest, may_exit_from_inside_a_callback) {
  probe->initialize();
  RTC::ReturnCode_t code = RTC::RTC_ERROR;
  probe->during = [&](const std::string& callback) {
    if (callback == "onExecute" && probe->count("onExecute") == 1) code = probe->exit();
  };
  probe->activate(0);
  ASSERT_TRUE(probe->wait_for("onShutdown"));
  EXPECT_EQ(code, RTC::RTC_OK);
}

TEST_F(ComponentTest, may_deactivate_itself_from_inside_a_callback) {
  probe->initialize();
  probe->during = [&](const std::string& callback) {
    if (callback == "onExecute") {
      EXPECT_EQ(probe->deactivate(0), RTC::RTC_OK);
    }
  };
  probe->activate(0);
  ASSERT_TRUE(probe->wait_for("onDeactivated"));
}

TEST_F(ComponentTest, what_a_callback_throws_becomes_the_error_state_and_one_log_line) {
  for (const char* how : {"exception", "other"}) {
    std::mutex mutex;
    std::vector<std::string> lines;
    const std::string name = std::string("Thrower_") + how;
    Owned<> thrower(nullptr, name);
    const auto sink = RTC::addLogSink(RTC::Logger::RTL_ERROR, [&](const RTC::LogRecord& record) {
      std::lock_guard lock(mutex);
      if (record.name == name) lines.emplace_back(record.message);
    });
    thrower->initialize();
    thrower->how = how;
    thrower->fail = "onExecute";
    thrower->activate(0);
    ASSERT_TRUE(thrower->wait_for("onError"));
    RTC::removeLogSink(sink);
    std::lock_guard lock(mutex);
    EXPECT_THAT(lines, ElementsAre(HasSubstr("onExecute threw")));
  }
}

TEST_F(ComponentTest, failing_initialization_leaves_nothing_behind) {
  probe->during = [](const std::string& callback) {
    if (callback == "onInitialize") throw std::runtime_error("no");
  };
  EXPECT_EQ(probe->initialize(), RTC::RTC_ERROR);
  RTC::ExecutionContextList_var contexts = probe->get_owned_contexts();
  EXPECT_EQ(contexts->length(), 0u);
  EXPECT_EQ(probe->exit(), RTC::PRECONDITION_NOT_MET);
}

TEST_F(ComponentTest, failing_activation_is_answered_with_precondition_not_met) {
  probe->initialize();
  set("fail", "onActivated");
  EXPECT_EQ(probe->activate(0), RTC::PRECONDITION_NOT_MET);
  EXPECT_EQ(state(), RTC::ERROR_STATE);
  set("fail", "onReset");
  ASSERT_TRUE(probe->wait_for("onError", probe->count("onError") + 2));
  EXPECT_EQ(probe->reset(0), RTC::PRECONDITION_NOT_MET);
  EXPECT_EQ(state(), RTC::ERROR_STATE);
  set("fail", "");
  ASSERT_TRUE(probe->wait_for("onError", probe->count("onError") + 2));
  EXPECT_EQ(probe->reset(0), RTC::RTC_OK);
  EXPECT_EQ(state(), RTC::INACTIVE_STATE);
}

TEST_F(ComponentTest, a_transition_that_takes_too_long_is_an_error_and_happens_later) {
  probe->getProperties()["exec_cxt.activation_timeout"] = "0.001";
  probe->initialize();
  std::mutex mutex;
  std::condition_variable condition;
  bool go = false;
  probe->during = [&](const std::string& callback) {
    std::unique_lock lock(mutex);
    if (callback == "onActivated") condition.wait(lock, [&] { return go; });
  };
  EXPECT_EQ(probe->activate(0), RTC::RTC_ERROR);
  {
    std::lock_guard lock(mutex);
    go = true;
  }
  condition.notify_all();
  EXPECT_TRUE(probe->wait_for("onExecute"));
  EXPECT_EQ(state(), RTC::ACTIVE_STATE);
  // The callbacks use what lives in this function only.
  EXPECT_EQ(probe->deactivate(0), RTC::RTC_OK);
  probe->during = {};
}

TEST_F(ComponentTest, takes_configuration_values_on_activation) {
  probe->initialize();
  EXPECT_EQ(probe->gain, 1.5);
  set("gain", "4");
  EXPECT_EQ(probe->gain, 1.5) << "not before";
  double seen = 0;
  probe->during = [&](const std::string& callback) {
    if (callback == "onActivated") seen = probe->gain;
  };
  probe->activate(0);
  ASSERT_TRUE(probe->wait_for("onStateUpdate"));
  EXPECT_EQ(seen, 4);
  probe->deactivate(0);
}

// Whoever sets them, in whatever process: here the tick of another component of the same process.
TEST_F(ComponentTest, takes_parameters_that_come_during_a_tick_in_lock_step_at_the_next_edge) {
  const auto clock = std::make_shared<support::LockStep>();
  base::set_lock_step_clock(clock);
  probe->initialize();
  const auto execute = [&](std::chrono::nanoseconds time) {
    support::TickAt tick(clock->time = time);
    const base::ScopedTick scope(tick);
    probe->on_execute(0);
    const double during = probe->gain;
    probe->on_state_update(0);
    EXPECT_EQ(probe->gain, during) << "after the callbacks";
    return during;
  };
  EXPECT_EQ(execute(std::chrono::milliseconds(10)), 1.5);
  {
    support::TickAt of_another(clock->time);
    const base::ScopedTick scope(of_another);
    const SDOPackage::Configuration_var configuration = probe->get_configuration();
    SDOPackage::ConfigurationSet values;
    values.id = "default";
    values.configuration_data.length(1);
    values.configuration_data[0].name = "gain";
    values.configuration_data[0].value <<= "4";
    configuration->set_configuration_set_values(values);
    configuration->activate_configuration_set("default");
  }
  EXPECT_EQ(execute(std::chrono::milliseconds(10)), 1.5);
  EXPECT_EQ(execute(std::chrono::milliseconds(20)), 4);
  base::set_lock_step_clock(nullptr);
}

TEST_F(ComponentTest, starts_and_stops_again_and_again) {
  for (int i = 0; i < 200; ++i) {
    std::vector<std::unique_ptr<Owned<>>> ten;
    for (int k = 0; k < 10; ++k) ten.push_back(std::make_unique<Owned<>>(nullptr, "Often" + std::to_string(k)));
    for (auto& one : ten) {
      ASSERT_EQ((*one)->initialize(), RTC::RTC_OK);
      ASSERT_EQ((*one)->activate(0), RTC::RTC_OK);
    }
  }
}

struct Hears {
  void before(RTC::UniqueId id) { heard.push_back("before " + std::to_string(id)); }
  void after(RTC::UniqueId id, RTC::ReturnCode_t code) { heard.push_back("after " + std::to_string(id) + " " + std::to_string(code)); }
  std::vector<std::string> heard;
};

TEST_F(ComponentTest, tells_listeners_before_and_after_each_callback) {
  Hears hears;
  auto* before = probe->addPreComponentActionListener(RTC::PreComponentActionListenerType::PRE_ON_STARTUP, hears, &Hears::before);
  probe->addPostComponentActionListener(RTC::POST_ON_STARTUP, hears, &Hears::after);
  probe->initialize();
  EXPECT_THAT(hears.heard, ElementsAre("before 0", "after 0 0"));
  probe->removePreComponentActionListener(RTC::PRE_ON_STARTUP, before);
  RTC::ExecutionContext_var context = first_context(*probe);
  context->stop();
  context->start();
  EXPECT_THAT(hears.heard, ElementsAre("before 0", "after 0 0", "after 0 0"));
}

}  // namespace
