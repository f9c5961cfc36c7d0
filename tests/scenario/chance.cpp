// Chance: each tick it takes in whatever has come, in its order, and sends what it knows; every difference of delivery shows in what it
// sends. `race` plants something that a run must not depend on: `thread` sends from a thread of its own, `clock` sends the time of the
// machine, `address` sends where an object lies in memory.
#include <rtm/DataFlowComponentBase.h>
#include <rtm/DataInPort.h>
#include <rtm/DataOutPort.h>
#include <rtm/Manager.h>
#include <rtm/idl/BasicDataTypeSkel.h>
#include <rtm/idl/InterfaceDataTypesSkel.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>

class Chance : public RTC::DataFlowComponentBase {
 public:
  explicit Chance(RTC::Manager* manager)
      : RTC::DataFlowComponentBase(manager),
        in_("in", received_),
        picture_in_("picture", picture_),
        out_("out", sent_),
        loose_("loose", loose_value_) {}

  RTC::ReturnCode_t onInitialize() override {
    addInPort("in", in_);
    addInPort("picture", picture_in_);
    addOutPort("out", out_);
    addOutPort("loose", loose_);
    bindParameter("start", start_, "1");
    bindParameter("race", race_, "");
    return RTC::RTC_OK;
  }

  RTC::ReturnCode_t onActivated(RTC::UniqueId) override {
    known_ = static_cast<std::uint32_t>(start_);
    if (race_ != "thread") return RTC::RTC_OK;
    ends_ = false;
    thread_ = std::thread([this] {
      while (!ends_) {
        ++loose_value_.data;
        loose_.write();
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
    });
    return RTC::RTC_OK;
  }

  RTC::ReturnCode_t onDeactivated(RTC::UniqueId) override {
    ends_ = true;
    if (thread_.joinable()) thread_.join();
    return RTC::RTC_OK;
  }

  RTC::ReturnCode_t onExecute(RTC::UniqueId) override {
    for (int i = 0; i < 8 && in_.isNew(); ++i) {
      in_.read();
      known_ = known_ * 31 + static_cast<std::uint32_t>(received_.data);
    }
    if (picture_in_.isNew()) {
      picture_in_.read();
      for (CORBA::ULong i = 0; i < picture_.pixels.length(); i += 97) known_ = known_ * 31 + picture_.pixels[i];
    }
    known_ = known_ * 17 + 1;
    if (race_ == "clock") known_ += static_cast<std::uint32_t>(std::chrono::system_clock::now().time_since_epoch().count());
    const auto object = std::make_unique<int>();
    if (race_ == "address") known_ += static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(object.get()) >> 12U);
    sent_.data = static_cast<CORBA::Long>(known_ & 0x7fffffffU);
    setTimestamp(sent_);
    out_.write();
    if (race_ == "thread") return RTC::RTC_OK;
    loose_value_.data = sent_.data / 2;
    loose_.write();
    return RTC::RTC_OK;
  }

 private:
  RTC::TimedLong received_{}, sent_{}, loose_value_{};
  RTC::InPort<RTC::TimedLong> in_;
  RTC::CameraImage picture_{};
  RTC::InPort<RTC::CameraImage> picture_in_;
  RTC::OutPort<RTC::TimedLong> out_, loose_;
  int start_ = 1;
  std::string race_;
  std::uint32_t known_ = 1;
  std::atomic<bool> ends_{false};
  std::thread thread_;
};

// clang-format off
static const char* const chance_spec[] = {
    "implementation_id", "Chance",
    "type_name", "Chance",
    "description", "Shows every difference of delivery",
    "version", "1.0.0",
    "vendor", "rtm-sim",
    "category", "test",
    "activity_type", "PERIODIC",
    "kind", "DataFlowComponent",
    "max_instance", "0",
    "language", "C++",
    "lang_type", "compile",
    "conf.default.start", "1",
    "conf.default.race", "",
    ""};
// clang-format on

extern "C" {
void ChanceInit(RTC::Manager* manager) {
  coil::Properties profile(chance_spec);
  manager->registerFactory(profile, RTC::Create<Chance>, RTC::Delete<Chance>);
}
}
