// ConfigDemo: parameters of several types in three sets, with hints for editors; prints them whenever a set becomes active.
#include <coil/stringutil.h>
#include <rtm/DataFlowComponentBase.h>
#include <rtm/Manager.h>

#include <iostream>
#include <sstream>
#include <string>
#include <vector>

// "1,2,3" -> the numbers. OpenRTM-aist converts parameters of a list only with a function like this one.
bool to_numbers(std::vector<double>& numbers, const char* text) {
  std::vector<double> found;
  for (const auto& part : coil::split(text, ",")) {
    double number = 0;
    if (!coil::stringTo(number, part.c_str())) return false;
    found.push_back(number);
  }
  numbers = found;
  return true;
}

class ConfigDemo : public RTC::DataFlowComponentBase {
 public:
  explicit ConfigDemo(RTC::Manager* manager) : RTC::DataFlowComponentBase(manager) {}

  RTC::ReturnCode_t onInitialize() override {
    bindParameter("count", count_, "1");
    bindParameter("gain", gain_, "0.5");
    bindParameter("mode", mode_, "follow");
    bindParameter("enabled", enabled_, "1");
    bindParameter("weights", weights_, "1,2,3", to_numbers);
    addConfigurationSetNameListener(RTC::ConfigurationSetNameListenerType::ON_ACTIVATE_CONFIG_SET, *this, &ConfigDemo::note_set);
    return RTC::RTC_OK;
  }

  RTC::ReturnCode_t onExecute(RTC::UniqueId) override {
    const std::string text = parameters();
    if (text == printed_) return RTC::RTC_OK;
    printed_ = text;
    std::cout << text << std::endl;
    return RTC::RTC_OK;
  }

 private:
  void note_set(const char* name) { RTC_INFO(("configuration set %s is active", name)); }

  std::string parameters() const {
    std::ostringstream out;
    out << "count " << count_ << " gain " << gain_ << " mode " << mode_ << " enabled " << enabled_ << " weights";
    for (double weight : weights_) out << ' ' << weight;
    return out.str();
  }

  int count_ = 1;
  double gain_ = 0.5;
  std::string mode_;
  bool enabled_ = true;
  std::vector<double> weights_;
  std::string printed_;
};

// clang-format off
static const char* const configdemo_spec[] = {
    "implementation_id", "ConfigDemo",
    "type_name", "ConfigDemo",
    "description", "Prints its configuration when it changes",
    "version", "1.0.0",
    "vendor", "rtm-sim",
    "category", "example",
    "activity_type", "PERIODIC",
    "kind", "DataFlowComponent",
    "max_instance", "0",
    "language", "C++",
    "lang_type", "compile",
    "exec_cxt.periodic.rate", "50",
    "conf.default.count", "1",
    "conf.default.gain", "0.5",
    "conf.default.mode", "follow",
    "conf.default.enabled", "1",
    "conf.default.weights", "1,2,3",
    "conf.fast.count", "10",
    "conf.fast.gain", "2.0",
    "conf.fast.mode", "lead",
    "conf.fast.enabled", "1",
    "conf.fast.weights", "4,5",
    "conf.off.count", "0",
    "conf.off.gain", "0.0",
    "conf.off.mode", "rest",
    "conf.off.enabled", "0",
    "conf.off.weights", "0",
    "conf.__widget__.count", "spin",
    "conf.__widget__.gain", "slider.0.1",
    "conf.__widget__.mode", "radio",
    "conf.__widget__.enabled", "checkbox",
    "conf.__widget__.weights", "text",
    "conf.__constraints__.count", "0<=x<=100",
    "conf.__constraints__.gain", "0.0<=x<=10.0",
    "conf.__constraints__.mode", "(follow,lead,rest)",
    "conf.__constraints__.enabled", "(0,1)",
    "conf.__type__.count", "int",
    "conf.__type__.gain", "double",
    "conf.__type__.mode", "string",
    "conf.__type__.enabled", "int",
    "conf.__type__.weights", "vector<double>",
    ""};
// clang-format on

extern "C" {
DLL_EXPORT void ConfigDemoInit(RTC::Manager* manager) {
  coil::Properties profile(configdemo_spec);
  manager->registerFactory(profile, RTC::Create<ConfigDemo>, RTC::Delete<ConfigDemo>);
}
}
