// TopicRelay: sends on what it receives, for each data type that is mapped to messages of ROS 2: from port TYPE_in to port TYPE_out.
#include <rtm/DataFlowComponentBase.h>
#include <rtm/DataInPort.h>
#include <rtm/DataOutPort.h>
#include <rtm/Manager.h>
#include <rtm/ext/ManipulatorCommonInterface_DataTypesSkel.h>
#include <rtm/ext/PointCloudTypesSkel.h>
#include <rtm/idl/InterfaceDataTypesSkel.h>

#include <memory>
#include <string>
#include <vector>

namespace {

class Part {
 public:
  virtual ~Part() = default;
  virtual RTC::InPortBase& in() = 0;
  virtual RTC::OutPortBase& out() = 0;
  virtual void pass() = 0;
};

template <class T>
class TypedPart final : public Part {
 public:
  explicit TypedPart(const std::string& name) : in_((name + "_in").c_str(), value_), out_((name + "_out").c_str(), value_) {}
  RTC::InPortBase& in() override { return in_; }
  RTC::OutPortBase& out() override { return out_; }
  void pass() override {
    while (in_.isNew()) {
      if (in_.read()) out_.write();
    }
  }

 private:
  T value_{};
  RTC::InPort<T> in_;
  RTC::OutPort<T> out_;
};

class TopicRelay : public RTC::DataFlowComponentBase {
 public:
  explicit TopicRelay(RTC::Manager* manager) : RTC::DataFlowComponentBase(manager) {
    add<RTC::TimedState>("State"), add<RTC::TimedShort>("Short"), add<RTC::TimedLong>("Long"), add<RTC::TimedUShort>("UShort");
    add<RTC::TimedULong>("ULong"), add<RTC::TimedFloat>("Float"), add<RTC::TimedDouble>("Double"), add<RTC::TimedBoolean>("Boolean");
    add<RTC::TimedOctet>("Octet"), add<RTC::TimedChar>("Char"), add<RTC::TimedString>("String"), add<RTC::TimedWString>("WString");
    add<RTC::TimedShortSeq>("ShortSeq"), add<RTC::TimedLongSeq>("LongSeq"), add<RTC::TimedUShortSeq>("UShortSeq");
    add<RTC::TimedULongSeq>("ULongSeq"), add<RTC::TimedFloatSeq>("FloatSeq"), add<RTC::TimedDoubleSeq>("DoubleSeq");
    add<RTC::TimedBooleanSeq>("BooleanSeq"), add<RTC::TimedOctetSeq>("OctetSeq"), add<RTC::TimedCharSeq>("CharSeq");
    add<RTC::TimedVelocity2D>("Velocity2D"), add<RTC::TimedVelocity3D>("Velocity3D"), add<RTC::TimedPose2D>("Pose2D");
    add<RTC::TimedPose3D>("Pose3D"), add<RTC::TimedPoseVel2D>("PoseVel2D"), add<RTC::TimedPoseVel3D>("PoseVel3D");
    add<RTC::TimedPoint2D>("Point2D"), add<RTC::TimedPoint3D>("Point3D"), add<RTC::TimedVector2D>("Vector2D");
    add<RTC::TimedVector3D>("Vector3D"), add<RTC::TimedQuaternion>("Quaternion"), add<RTC::TimedOrientation3D>("Orientation3D");
    add<RTC::TimedAngularVelocity3D>("AngularVelocity3D"), add<RTC::TimedAcceleration3D>("Acceleration3D");
    add<RTC::RangeData>("RangeData"), add<RTC::CameraImage>("CameraImage"), add<RTC::PointCloud>("PointCloud");
    add<PointCloudTypes::PointCloud>("Cloud"), add<RTC::ActArrayState>("ActArrayState"), add<JARA_ARM::TimedJointPos>("JointPos");
    add<RTC::GPSData>("GPSData");
  }

  RTC::ReturnCode_t onInitialize() override {
    for (auto& part : parts_) {
      const std::string in = part->in().getName(), out = part->out().getName();
      addInPort(in.c_str(), part->in());
      addOutPort(out.c_str(), part->out());
    }
    return RTC::RTC_OK;
  }
  RTC::ReturnCode_t onExecute(RTC::UniqueId) override {
    for (auto& part : parts_) part->pass();
    return RTC::RTC_OK;
  }

 private:
  template <class T>
  void add(const std::string& name) {
    parts_.push_back(std::make_unique<TypedPart<T>>(name));
  }
  std::vector<std::unique_ptr<Part>> parts_;
};

// clang-format off
const char* const topic_relay_spec[] = {
    "implementation_id", "TopicRelay", "type_name", "TopicRelay", "description", "Sends on what it receives", "version", "1.0.0",
    "vendor", "rtm-sim", "category", "test", "activity_type", "PERIODIC", "kind", "DataFlowComponent", "max_instance", "0",
    "language", "C++", "lang_type", "compile", "exec_cxt.periodic.rate", "200", ""};
// clang-format on

}  // namespace

extern "C" {
DLL_EXPORT void TopicRelayInit(RTC::Manager* manager) {
  coil::Properties profile(topic_relay_spec);
  manager->registerFactory(profile, RTC::Create<TopicRelay>, RTC::Delete<TopicRelay>);
}
}
