// A component that writes down its callbacks and fails as its configuration says (parameter fail: names of callbacks; parameter how: error,
// exception or other). The trace is the type of its device profile, so that another process can read it.
#pragma once

#include <coil/stringutil.h>
#include <rtm/DataFlowComponentBase.h>

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace support {

class ProbeComponent : public RTC::DataFlowComponentBase {
 public:
  explicit ProbeComponent(RTC::Manager* manager = nullptr, const std::string& name = "Probe0") : RTC::DataFlowComponentBase(manager) {
    static const char* const spec[] = {"implementation_id",
                                       "Probe",
                                       "type_name",
                                       "Probe",
                                       "description",
                                       "a component to look into",
                                       "version",
                                       "1.2.3",
                                       "vendor",
                                       "nobody",
                                       "category",
                                       "test",
                                       "activity_type",
                                       "PERIODIC",
                                       "kind",
                                       "DataFlowComponent",
                                       "max_instance",
                                       "0",
                                       "language",
                                       "C++",
                                       "lang_type",
                                       "compile",
                                       "conf.default.fail",
                                       "",
                                       "conf.default.how",
                                       "error",
                                       "conf.default.gain",
                                       "1.5",
                                       "conf.fast.gain",
                                       "9",
                                       "conf.__widget__.gain",
                                       "slider",
                                       ""};
    setProperties(coil::Properties(spec));
    setInstanceName(name.c_str());
  }

  RTC::ReturnCode_t onInitialize() override {
    bindParameter("fail", fail, "");
    bindParameter("how", how, "error");
    bindParameter("gain", gain, "0.5");
    return happened("onInitialize");
  }
  RTC::ReturnCode_t onFinalize() override { return happened("onFinalize"); }
  RTC::ReturnCode_t onStartup(RTC::UniqueId) override { return happened("onStartup"); }
  RTC::ReturnCode_t onShutdown(RTC::UniqueId) override { return happened("onShutdown"); }
  RTC::ReturnCode_t onActivated(RTC::UniqueId) override { return happened("onActivated"); }
  RTC::ReturnCode_t onDeactivated(RTC::UniqueId) override { return happened("onDeactivated"); }
  RTC::ReturnCode_t onExecute(RTC::UniqueId) override { return happened("onExecute"); }
  RTC::ReturnCode_t onAborting(RTC::UniqueId) override { return happened("onAborting"); }
  RTC::ReturnCode_t onError(RTC::UniqueId) override { return happened("onError"); }
  RTC::ReturnCode_t onReset(RTC::UniqueId) override { return happened("onReset"); }
  RTC::ReturnCode_t onStateUpdate(RTC::UniqueId) override { return happened("onStateUpdate"); }
  RTC::ReturnCode_t onRateChanged(RTC::UniqueId) override { return happened("onRateChanged"); }

  // Callbacks in order; one that follows itself, and onExecute-onStateUpdate pairs, are written once.
  std::vector<std::string> trace() const {
    std::lock_guard lock(mutex_);
    return trace_;
  }
  void forget() {
    std::lock_guard lock(mutex_);
    trace_.clear();
  }
  std::thread::id thread_of(const std::string& callback) const {
    std::lock_guard lock(mutex_);
    const auto it = std::find_if(threads_.begin(), threads_.end(), [&](const auto& entry) { return entry.first == callback; });
    return it == threads_.end() ? std::thread::id() : it->second;
  }
  // Waits until the callback has happened that often.
  bool wait_for(const std::string& callback, int times = 1) {
    std::unique_lock lock(mutex_);
    return condition_.wait_for(lock, std::chrono::seconds(60), [&] { return std::count(all_.begin(), all_.end(), callback) >= times; });
  }
  int count(const std::string& callback) const {
    std::lock_guard lock(mutex_);
    return static_cast<int>(std::count(all_.begin(), all_.end(), callback));
  }

  std::string fail, how;
  double gain = 0;
  std::function<void(const std::string&)> during;

 private:
  RTC::ReturnCode_t happened(const std::string& callback) {
    std::string text;
    {
      std::lock_guard lock(mutex_);
      const bool pair =
          callback == "onExecute" && trace_.size() >= 2 && trace_.back() == "onStateUpdate" && trace_[trace_.size() - 2] == "onExecute";
      const bool second = callback == "onStateUpdate" && pair_;
      if (!pair && !second && (trace_.empty() || trace_.back() != callback)) trace_.push_back(callback);
      pair_ = pair;
      all_.push_back(callback);
      if (all_.size() > 100000) all_.erase(all_.begin(), all_.begin() + 50000);
      threads_.emplace_back(callback, std::this_thread::get_id());
      if (threads_.size() > 1000) threads_.erase(threads_.begin(), threads_.begin() + 500);
      text = coil::flatten(trace_, ",");
    }
    condition_.notify_all();
    SDOPackage::DeviceProfile profile;
    profile.device_type = text.c_str();
    setDeviceProfile(profile);
    if (during) during(callback);
    if (!coil::includes(fail, callback)) return RTC::RTC_OK;
    if (how == "exception") throw std::runtime_error("no milk today");
    if (how == "other") throw 42;
    return RTC::RTC_ERROR;
  }

  mutable std::mutex mutex_;
  std::condition_variable condition_;
  std::vector<std::string> trace_, all_;
  std::vector<std::pair<std::string, std::thread::id>> threads_;
  bool pair_ = false;
};

}  // namespace support
