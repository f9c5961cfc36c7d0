#include "component/log_consumer.h"
#include <rtm/NVUtil.h>
#include <rtm/RTObject.h>
#include <rtm/SystemLogger.h>
#include <rtm/idl/LoggerSkel.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "base/text.h"
#include "corba/members/courier.h"
#include "corba/orb/orb.h"

namespace RTC {

namespace {

constexpr const char* logger_id = "IDL:OpenRTM/Logger:1.0";

OpenRTM::LogLevel to_wire(int level) {
  switch (level) {
    case Logger::RTL_FATAL:
    case Logger::RTL_ERROR:
      return OpenRTM::RTM_ERROR;
    case Logger::RTL_WARN:
      return OpenRTM::RTM_WARN;
    case Logger::RTL_INFO:
      return OpenRTM::RTM_INFO;
    case Logger::RTL_DEBUG:
      return OpenRTM::RTM_DEBUG;
    case Logger::RTL_TRACE:
      return OpenRTM::RTM_TRACE;
    case Logger::RTL_VERBOSE:
      return OpenRTM::RTM_VERBOSE;
    case Logger::RTL_PARANOID:
      return OpenRTM::RTM_PARANOID;
    default:
      return OpenRTM::RTM_SILENT;
  }
}

class LoggerConsumer final : public SdoServiceConsumerBase {
 public:
  ~LoggerConsumer() override { LoggerConsumer::finalize(); }

  bool init(RTObject_impl&, const SDOPackage::ServiceProfile& profile) override { return start(profile); }

  bool reinit(const SDOPackage::ServiceProfile& profile) override {
    finalize();
    return start(profile);
  }

  const SDOPackage::ServiceProfile& getProfile() const override { return profile_; }

  void finalize() override {
    if (sink_) removeLogSink(*std::exchange(sink_, std::nullopt));
    if (courier_) courier_->finish();
    courier_.reset();
  }

 private:
  bool start(const SDOPackage::ServiceProfile& profile) {
    OpenRTM::Logger_var logger;
    try {
      corba::set_call_timeout(profile.service, std::chrono::seconds(1));
      logger = OpenRTM::Logger::_narrow(profile.service);
    } catch (const CORBA::Exception&) {
      return false;
    }
    if (CORBA::is_nil(logger)) return false;
    corba::set_call_timeout(logger, std::chrono::seconds(1));
    profile_ = profile;
    const auto level = Logger::parseLevel(NVUtil::toString(profile.properties, "logger.log_level"));
    std::vector<std::string> filter = base::split_list(NVUtil::toString(profile.properties, "logger.filter"));
    // rtvlog without a filter sends the letters of ALL one by one.
    const bool is_spelled = base::equal_ignoring_case(base::join(filter, ""), "ALL");
    if (is_spelled || std::ranges::any_of(filter, [](const std::string& name) { return base::equal_ignoring_case(name, "ALL"); }))
      filter.clear();
    const bool is_simulated = base::equal_ignoring_case(NVUtil::toString(profile.properties, "logger.clock"), "simulated");
    const auto courier = std::make_shared<corba::Courier>("logger service");
    courier_ = courier;
    // Log lines of the asynchronous notifier itself would come back here without end.
    sink_ = addLogSink(level.value_or(Logger::RTL_INFO), [courier, logger, filter, is_simulated](const LogRecord& record) {
      if (!filter.empty() && std::find(filter.begin(), filter.end(), record.name) == filter.end()) return;
      OpenRTM::LogRecord wire;
      const auto time = is_simulated ? record.simulated.value_or(record.time) : record.time;
      wire.time.sec = static_cast<CORBA::ULong>(time.count() / 1'000'000'000);
      wire.time.nsec = static_cast<CORBA::ULong>(time.count() % 1'000'000'000);
      wire.loggername = std::string(record.name).c_str();
      wire.level = to_wire(record.level);
      wire.message = std::string(record.message).c_str();
      courier->send([logger, wire] { OpenRTM::Logger_var(logger)->publish(wire); });
    });
    return true;
  }

  SDOPackage::ServiceProfile profile_;
  std::optional<LogSinkId> sink_;
  std::shared_ptr<corba::Courier> courier_;
};

}  // namespace

void registerLoggerConsumer() {
  SdoServiceConsumerFactory::instance().addFactory(logger_id, coil::Creator<SdoServiceConsumerBase, LoggerConsumer>,
                                                   coil::Destructor<SdoServiceConsumerBase, LoggerConsumer>);
}

}  // namespace RTC
