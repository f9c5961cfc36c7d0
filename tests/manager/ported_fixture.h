// A component with a port of each kind, and a manager of this process that can make it.
#pragma once

#include <gtest/gtest.h>
#include <rtm/DataFlowComponentBase.h>
#include <rtm/Manager.h>
#include <rtm/idl/BasicDataTypeSkel.h>

#include <rtm/DataInPort.h>
#include <rtm/DataOutPort.h>

#include <string>
#include <vector>

namespace manager_test {

class Ported : public RTC::DataFlowComponentBase {
 public:
  explicit Ported(RTC::Manager* manager) : RTC::DataFlowComponentBase(manager), in_("in", value_), out_("out", value_) {}
  RTC::ReturnCode_t onInitialize() override {
    addInPort("in", in_);
    addOutPort("out", out_);
    return RTC::RTC_OK;
  }

 private:
  RTC::TimedLong value_;
  RTC::InPort<RTC::TimedLong> in_;
  RTC::OutPort<RTC::TimedLong> out_;
};

inline const char* const ported_spec[] = {
    "implementation_id", "Ported",   "type_name", "Ported",   "description", "For tests", "version", "1.0", "vendor",
    "rtm-sim",           "category", "test",      "language", "C++",         "lang_type", "compile", ""};

inline void PortedInit(RTC::Manager* manager) {
  coil::Properties profile(ported_spec);
  manager->registerFactory(profile, RTC::Create<Ported>, RTC::Delete<Ported>);
}

// A manager with these settings until the end of the test.
class Started {
 public:
  explicit Started(std::vector<std::string> settings, const std::string& file = "none.conf") {
    settings.insert(settings.begin(), {"naming.enable:NO", "manager.shutdown_on_nortcs:NO", "corba.update_master_manager.enable:NO"});
    std::vector<std::string> words{"test", "-i", "-f", file};
    for (const auto& setting : settings) words.insert(words.end(), {"-o", setting});
    std::vector<char*> argv;
    for (auto& word : words) argv.push_back(word.data());
    manager_ = RTC::Manager::init(static_cast<int>(argv.size()), argv.data());
    manager_->setModuleInitProc(PortedInit);
    EXPECT_TRUE(manager_->activateManager());
  }
  ~Started() { manager_->shutdown(); }
  Started(const Started&) = delete;
  Started& operator=(const Started&) = delete;
  RTC::Manager* operator->() const { return manager_; }
  std::string make(const std::string& argument) const {
    auto* made = manager_->createComponent(argument);
    return made != nullptr ? made->getInstanceName() : "";
  }
  RTC::RTObject_var reference(const std::string& name) const { return manager_->getComponent(name)->getObjRef(); }

 private:
  RTC::Manager* manager_;
};

}  // namespace manager_test
