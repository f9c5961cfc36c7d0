#include "recording/logger_service.h"

#include <utility>

#include "base/guarded.h"
#include "base/id.h"
#include "system/remote.h"

namespace recorder {

namespace {

constexpr const char* logger_type = "IDL:OpenRTM/Logger:1.0";

}  // namespace

// Lives as long as somebody may call it.
class LoggerService::Servant final : public POA_OpenRTM::Logger {
 public:
  explicit Servant(Take take) : take_(std::move(take)) {}
  void publish(const OpenRTM::LogRecord& record) override {
    const auto mine = turn_.take();
    if (take_) take_(record);
  }
  void close() override {}
  void stop() {
    const auto mine = turn_.take();
    take_ = nullptr;
  }

 private:
  base::Turn<> turn_;
  Take take_;
};

LoggerService::LoggerService(const tools::ComponentView& component, Take take)
    : component_(RTC::RTObject::_duplicate(component.object)), id_(base::make_uuid()), servant_(new Servant(std::move(take))) {}

std::unique_ptr<LoggerService> LoggerService::attach(const tools::ComponentView& component, const char* type,
                                                     const tools::Properties& properties, Take take) {
  std::unique_ptr<LoggerService> service(new LoggerService(component, std::move(take)));
  try {
    const OpenRTM::Logger_var reference = service->servant_->_this();
    SDOPackage::ServiceProfile profile;
    profile.id = service->id_.c_str();
    profile.interface_type = type;
    profile.properties = tools::to_nv_list(properties);
    profile.service = SDOPackage::SDOService::_duplicate(reference);
    const SDOPackage::Configuration_var configuration = tools::configuration_of(service->component_);
    configuration->add_service_profile(profile);
  } catch (const CORBA::Exception&) {
    return nullptr;
  }
  return service;
}

std::unique_ptr<LoggerService> LoggerService::of_log(const tools::ComponentView& component, Take take) {
  return attach(component, logger_type,
                {{"logger.log_level", "INFO"}, {"logger.filter", component.instance}, {"logger.clock", "simulated"}}, std::move(take));
}

LoggerService::~LoggerService() {
  try {
    const SDOPackage::Configuration_var configuration = tools::configuration_of(component_);
    configuration->remove_service_profile(id_.c_str());
  } catch (const CORBA::Exception&) {
    // It has gone, or never knew it.
  }
  servant_->stop();
  try {
    const PortableServer::POA_var poa = servant_->_default_POA();
    const PortableServer::ObjectId_var id = poa->servant_to_id(servant_.in());
    poa->deactivate_object(id);
  } catch (const CORBA::Exception&) {
    // The ORB is shutting down.
  }
}

}  // namespace recorder
