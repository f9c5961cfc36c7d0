// FrameSource: sends the image in a file to the OutPort `image` each time the configuration `frame` names another file, or with `repeat` 1
// in each cycle. The file: a line
// "WIDTH HEIGHT BPP FORMAT" (FORMAT may be missing), then the octets.
#include <rtm/DataFlowComponentBase.h>
#include <rtm/DataOutPort.h>
#include <rtm/Manager.h>
#include <rtm/idl/InterfaceDataTypesSkel.h>

#include <fstream>
#include <iterator>
#include <sstream>
#include <string>

// clang-format off
static const char* const framesource_spec[] = {
    "implementation_id", "FrameSource",
    "type_name", "FrameSource",
    "description", "Sends images from files",
    "version", "1.0.0",
    "vendor", "rtm-sim",
    "category", "test",
    "activity_type", "PERIODIC",
    "kind", "DataFlowComponent",
    "max_instance", "0",
    "language", "C++",
    "lang_type", "compile",
    "conf.default.frame", "",
    "conf.default.repeat", "0",
    ""};
// clang-format on

class FrameSource : public RTC::DataFlowComponentBase {
 public:
  explicit FrameSource(RTC::Manager* manager) : RTC::DataFlowComponentBase(manager), image_out_("image", image_) {}
  RTC::ReturnCode_t onInitialize() override {
    addOutPort("image", image_out_);
    bindParameter("frame", frame_, "");
    bindParameter("repeat", repeat_, "0");
    return RTC::RTC_OK;
  }
  RTC::ReturnCode_t onExecute(RTC::UniqueId) override {
    if (frame_ == sent_) {
      if (repeat_ != 0) image_out_.write();
      return RTC::RTC_OK;
    }
    sent_ = frame_;
    std::ifstream file(frame_, std::ios::binary);
    std::string line, format;
    std::getline(file, line);
    std::istringstream words(line);
    words >> image_.width >> image_.height >> image_.bpp >> format;
    image_.format = CORBA::string_dup(format.c_str());
    const std::string octets((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    image_.pixels.length(static_cast<CORBA::ULong>(octets.size()));
    for (CORBA::ULong i = 0; i < octets.size(); ++i) image_.pixels[i] = static_cast<CORBA::Octet>(octets[i]);
    setTimestamp(image_);
    image_out_.write();
    return RTC::RTC_OK;
  }

 private:
  std::string frame_, sent_;
  int repeat_ = 0;
  RTC::CameraImage image_;
  RTC::OutPort<RTC::CameraImage> image_out_;
};

extern "C" {
DLL_EXPORT void FrameSourceInit(RTC::Manager* manager) {
  coil::Properties profile(framesource_spec);
  manager->registerFactory(profile, RTC::Create<FrameSource>, RTC::Delete<FrameSource>);
}
}
