// Processes whose components have callbacks that never return, ended as users and tools end them. The program is hanging_program.
#include <gtest/gtest.h>
#include <rtm/idl/OpenRTMStub.h>

#include "support/naming_service.h"
#include "support/orb_environment.h"
#include "support/paths.h"
#include "support/process.h"

namespace {

using namespace std::chrono_literals;

constexpr double callback_timeout = 0.3;  // [s]

class HangingProcessTest : public testing::Test {
 protected:
  void start(const std::string& components, const std::string& active, const std::vector<std::string>& further = {}) {
    port_ = support::free_port();
    std::vector<std::string> words{std::string(paths::bin_dir) + "/hanging_program", "-i", "-f", "none.conf", "-p", std::to_string(port_)};
    std::vector<std::string> settings{"naming.enable:NO",
                                      "logger.file_name:stderr",
                                      "manager.components.precreate:" + components,
                                      "exec_cxt.callback_timeout:" + std::to_string(callback_timeout),
                                      "exec_cxt.sync_transition:NO",
                                      "exec_cxt.periodic.rate:100",
                                      "manager.components.preactivation:" + active};
    settings.insert(settings.end(), further.begin(), further.end());
    for (const std::string& setting : settings) words.insert(words.end(), {"-o", setting});
    process_ = std::make_unique<support::Process>(words);
  }
  // `count` components that hang in the callback, numbered from 0.
  static std::string several(int count, const std::string& callback) {
    std::string list;
    for (int i = 0; i < count; ++i) list += (i ? "," : "") + std::string("Hanging?conf.default.hang=") + callback;
    return list;
  }
  static std::string names(int count) {
    std::string list;
    for (int i = 0; i < count; ++i) list += (i ? ",Hanging" : "Hanging") + std::to_string(i);
    return list;
  }
  RTC::RTObject_var component(const std::string& name) {
    int argc = 0;
    const CORBA::ORB_var orb = CORBA::ORB_init(argc, nullptr);
    const CORBA::Object_var object = orb->string_to_object(("corbaloc:iiop:127.0.0.1:" + std::to_string(port_) + "/test." + name).c_str());
    return RTC::RTObject::_narrow(object);
  }
  RTC::ExecutionContext_var context_of(RTC::RTObject_ptr owner) {
    RTC::ExecutionContextList_var contexts = owner->get_owned_contexts();
    return RTC::ExecutionContext::_duplicate(contexts[0u]);
  }
  // One after the other they would take count times the time-out.
  void expect_bounded_end(int count) {
    const auto began = std::chrono::steady_clock::now();
    EXPECT_EQ(process_->stop(), EXIT_FAILURE) << process_->output();
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
    EXPECT_LT(took.count(), count * callback_timeout / 2) << process_->output();
  }
  void expect_line(const std::string& text) {
    EXPECT_NE(process_->output().find(text), std::string::npos) << text << "\n" << process_->output();
  }

  int port_ = 0;
  std::unique_ptr<support::Process> process_;
};

TEST_F(HangingProcessTest, without_one_that_hangs_it_ends_well) {
  start("Hanging,Hanging", "Hanging0,Hanging1");
  ASSERT_TRUE(process_->wait_for_output("ready\n"));
  EXPECT_EQ(process_->stop(), EXIT_SUCCESS) << process_->output();
}

TEST_F(HangingProcessTest, ends_in_time_however_many_hang_and_names_them_all) {
  constexpr int count = 40;
  start(several(count, "onExecute") + ",Hanging", names(count + 1));
  for (int i = 0; i < count; ++i)
    ASSERT_TRUE(process_->wait_for_output("Hanging" + std::to_string(i) + " stands in onExecute")) << process_->output();
  ASSERT_TRUE(process_->wait_for_output("ready\n"));
  expect_bounded_end(count);
  for (int i = 0; i < count; ++i) expect_line("Hanging" + std::to_string(i) + ": onExecute has not returned");
  EXPECT_EQ(process_->output().find("Hanging40:"), std::string::npos) << "one that does not hang";
}

// Containers are killed 10 s after the signal.
TEST_F(HangingProcessTest, a_signal_ends_it_within_seconds_however_patient_it_is_otherwise) {
  start(several(1, "onExecute"), names(1), {"exec_cxt.callback_timeout:60"});
  ASSERT_TRUE(process_->wait_for_output("Hanging0 stands in onExecute"));
  ASSERT_TRUE(process_->wait_for_output("ready\n"));
  const auto began = std::chrono::steady_clock::now();
  EXPECT_EQ(process_->stop(), EXIT_FAILURE) << process_->output();
  EXPECT_LT(std::chrono::steady_clock::now() - began, 10s) << process_->output();
  expect_line("Hanging0: onExecute has not returned");
}

TEST_F(HangingProcessTest, ends_in_time_when_all_hang_in_deactivation) {
  constexpr int count = 40;
  start(several(count, "onDeactivated"), names(count));
  ASSERT_TRUE(process_->wait_for_output("ready\n"));
  expect_bounded_end(count);
  for (int i = 0; i < count; ++i) expect_line("Hanging" + std::to_string(i) + ": onDeactivated has not returned");
}

TEST_F(HangingProcessTest, ends_in_time_when_what_the_end_calls_hangs) {
  for (const char* callback : {"onFinalize", "onShutdown"}) {
    start(several(2, callback), "");
    ASSERT_TRUE(process_->wait_for_output("ready\n"));
    EXPECT_EQ(process_->stop(), EXIT_FAILURE) << process_->output();
    expect_line(std::string("Hanging1: ") + callback + " has not returned");
  }
}

TEST_F(HangingProcessTest, ends_in_time_when_it_hangs_at_its_beginning) {
  for (const char* callback : {"onInitialize", "onStartup"}) {
    start(several(1, callback), "");
    ASSERT_TRUE(process_->wait_for_output(std::string("stands in ") + callback));
    EXPECT_EQ(process_->stop(), EXIT_FAILURE) << process_->output();
    expect_line(std::string("Hanging0: ") + callback + " has not returned");
  }
}

TEST_F(HangingProcessTest, exit_over_the_wire_returns_and_the_process_lives_on) {
  start(several(1, "onExecute") + ",Hanging", names(2));
  ASSERT_TRUE(process_->wait_for_output("stands in onExecute"));
  ASSERT_TRUE(process_->wait_for_output("ready\n"));
  EXPECT_EQ(component("Hanging0")->exit(), RTC::RTC_OK);
  ASSERT_TRUE(process_->wait_for_output("Hanging0: onExecute has not returned"));
  RTC::RTObject_var other = component("Hanging1");
  EXPECT_EQ(context_of(other)->get_component_state(other), RTC::ACTIVE_STATE);
  EXPECT_EQ(process_->stop(), EXIT_FAILURE) << process_->output();
}

TEST_F(HangingProcessTest, a_guest_that_hangs_leaves_over_the_wire_in_time_and_is_never_freed) {
  for (const bool exits : {false, true}) {
    start("Hanging,Hanging?conf.default.hang=onExecute&conf.default.where=others", "Hanging0");
    ASSERT_TRUE(process_->wait_for_output("ready\n"));
    RTC::RTObject_var host = component("Hanging0");
    RTC::RTObject_var guest = component("Hanging1");
    RTC::ExecutionContext_var context = context_of(host);
    ASSERT_EQ(context->add_component(guest), RTC::RTC_OK);
    ASSERT_EQ(context->activate_component(guest), RTC::RTC_OK);
    ASSERT_TRUE(process_->wait_for_output("Hanging1 stands in onExecute"));
    if (!exits) {
      EXPECT_EQ(context->remove_component(guest), RTC::RTC_OK);
      ASSERT_TRUE(process_->wait_for_output("Hanging1 in onExecute, and does not return"));
      EXPECT_EQ(guest->get_context_handle(context), -1);
    }
    EXPECT_EQ(guest->exit(), RTC::RTC_OK);
    ASSERT_TRUE(process_->wait_for_output("Hanging1: onExecute has not returned"));
    EXPECT_EQ(host->exit(), RTC::RTC_OK);
    EXPECT_EQ(process_->wait(), EXIT_FAILURE) << "the last component has gone\n" << process_->output();
  }
}

}  // namespace
