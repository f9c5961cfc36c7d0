// Relay: sends on what it receives, or counts its own ticks when source is 1, and writes "time value" for each value to the file `journal`.
// Ticks of a chain of relays show how long data is on the way. hang_at, crash_at, exit_at, kill_at, nan_at: the tick in which it sleeps for
// ever, aborts, calls exit(3), kills its process, and sends no number on its third port (0: never). crash_active: it aborts in onActivated.
#include <rtm/DataFlowComponentBase.h>
#include <rtm/DataInPort.h>
#include <rtm/DataOutPort.h>
#include <rtm/Manager.h>
#include <rtm/idl/BasicDataTypeSkel.h>
#include <signal.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

class Relay : public RTC::DataFlowComponentBase {
 public:
  explicit Relay(RTC::Manager* manager)
      : RTC::DataFlowComponentBase(manager), in_("in", received_), out_("out", sent_), number_out_("number", number_) {}

  RTC::ReturnCode_t onInitialize() override {
    addInPort("in", in_);
    addOutPort("out", out_);
    bindParameter("source", source_, "0");
    bindParameter("journal", journal_, "");
    bindParameter("hang_at", hang_at_, "0");
    bindParameter("crash_at", crash_at_, "0");
    bindParameter("exit_at", exit_at_, "0");
    bindParameter("kill_at", kill_at_, "0");
    bindParameter("crash_active", crash_active_, "0");
    bindParameter("nan_at", nan_at_, "0");
    bindParameter("stamp", stamp_, "1");
    addOutPort("number", number_out_);
    return RTC::RTC_OK;
  }

  RTC::ReturnCode_t onActivated(RTC::UniqueId) override {
    ticks_ = 0;
    if (crash_active_ != 0) std::abort();
    RTC_INFO(("relay activated"));
    return RTC::RTC_OK;
  }

  RTC::ReturnCode_t onExecute(RTC::UniqueId) override {
    ++ticks_;
    while (hang_at_ > 0 && ticks_ == hang_at_) pause();
    if (crash_at_ > 0 && ticks_ == crash_at_) std::abort();
    if (exit_at_ > 0 && ticks_ == exit_at_) std::exit(3);  // NOLINT(concurrency-mt-unsafe): as careless authors do
    if (kill_at_ > 0 && ticks_ == kill_at_) kill(getpid(), SIGKILL);
    number_.data = ticks_ == nan_at_ ? std::nan("") : 1;
    number_out_.write();
    if (source_ != 0) {
      sent_.data = ticks_;
    } else {
      if (!in_.isNew()) return RTC::RTC_OK;
      in_.read();
      sent_.data = received_.data;
    }
    if (stamp_ != 0) {
      setTimestamp(sent_);
    } else {
      sent_.tm = received_.tm;  // as the connection has stamped it
    }
    if (!journal_.empty()) {
      char line[64];
      std::snprintf(line, sizeof line, "%u.%09u %d\n", static_cast<unsigned>(sent_.tm.sec), static_cast<unsigned>(sent_.tm.nsec),
                    static_cast<int>(sent_.data));
      std::ofstream(journal_, std::ios::app) << line;
    }
    out_.write();
    return RTC::RTC_OK;
  }

 private:
  RTC::TimedLong received_{}, sent_{};
  RTC::InPort<RTC::TimedLong> in_;
  RTC::OutPort<RTC::TimedLong> out_;
  RTC::TimedDouble number_{};
  RTC::OutPort<RTC::TimedDouble> number_out_;
  int source_ = 0, hang_at_ = 0, crash_at_ = 0, exit_at_ = 0, kill_at_ = 0, crash_active_ = 0, nan_at_ = 0, stamp_ = 1, ticks_ = 0;
  std::string journal_;
};

// clang-format off
static const char* const relay_spec[] = {
    "implementation_id", "Relay",
    "type_name", "Relay",
    "description", "Sends on what it receives and says when",
    "version", "1.0.0",
    "vendor", "rtm-sim",
    "category", "test",
    "activity_type", "PERIODIC",
    "kind", "DataFlowComponent",
    "max_instance", "0",
    "language", "C++",
    "lang_type", "compile",
    "conf.default.source", "0",
    "conf.default.journal", "",
    "conf.default.hang_at", "0",
    "conf.default.crash_at", "0",
    "conf.default.exit_at", "0",
    "conf.default.kill_at", "0",
    "conf.default.crash_active", "0",
    "conf.default.nan_at", "0",
    "conf.default.stamp", "1",
    ""};
// clang-format on

extern "C" {
void RelayInit(RTC::Manager* manager) {
  coil::Properties profile(relay_spec);
  manager->registerFactory(profile, RTC::Create<Relay>, RTC::Delete<Relay>);
}
}
