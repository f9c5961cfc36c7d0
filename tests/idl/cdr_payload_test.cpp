// The bytes of every data type, in both byte orders, equal those that an independent ORB has written.
#include <gtest/gtest.h>
#include <omniORB4/CORBA.h>
#include <omniORB4/codeSets.h>
#include <rtm/idl/InterfaceDataTypesSkel.h>

#include <bit>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/paths.h"

namespace {

using json = nlohmann::json;
using Bytes = std::vector<unsigned char>;

enum class Order { little, big };

// Writes a JSON value as CDR by walking the type code; remembers which bytes are padding, because nobody promises what is in them.
class Writer {
 public:
  explicit Writer(Order order) : order_(order) {}

  void write(CORBA::TypeCode_ptr type, const json& value) {
    switch (type->kind()) {
      case CORBA::tk_alias: {
        CORBA::TypeCode_var content = type->content_type();
        return write(content, value);
      }
      case CORBA::tk_struct:
        return write_struct(type, value);
      case CORBA::tk_sequence:
        return write_sequence(type, value);
      case CORBA::tk_enum:
        return write_enum(type, value);
      case CORBA::tk_short:
        return put<std::int16_t>(value.get<std::int16_t>());
      case CORBA::tk_ushort:
        return put<std::uint16_t>(value.get<std::uint16_t>());
      case CORBA::tk_long:
        return put<std::int32_t>(value.get<std::int32_t>());
      case CORBA::tk_ulong:
        return put<std::uint32_t>(value.get<std::uint32_t>());
      case CORBA::tk_float:
        return put<float>(value.get<float>());
      case CORBA::tk_double:
        return put<double>(value.get<double>());
      case CORBA::tk_boolean:
        return put<std::uint8_t>(value.get<bool>());
      case CORBA::tk_octet:
        return put<std::uint8_t>(value.get<std::uint8_t>());
      case CORBA::tk_char:
        return put<std::uint8_t>(static_cast<std::uint8_t>(value.get<std::string>().at(0)));
      case CORBA::tk_wchar:
        return write_wchar(value.get<std::string>());
      case CORBA::tk_string:
        return write_string(value.get<std::string>());
      case CORBA::tk_wstring:
        return write_wstring(value.get<std::string>());
      default:
        FAIL() << "no type of a payload: " << type->kind();
    }
  }

  // The other bytes with zeros where these have padding.
  Bytes without_padding(Bytes other) const {
    for (std::size_t i = 0; i < other.size() && i < is_padding_.size(); ++i) {
      if (is_padding_[i]) other[i] = 0;
    }
    return other;
  }

  Bytes bytes;

 private:
  template <class T>
  void put(T value) {
    while (bytes.size() % sizeof(T) != 0) put_byte(0, true);
    unsigned char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    const bool swap = (order_ == Order::little) != (std::endian::native == std::endian::little);
    for (std::size_t i = 0; i < sizeof(T); ++i) put_byte(raw[swap ? sizeof(T) - 1 - i : i], false);
  }

  void put_byte(unsigned char byte, bool is_padding) {
    bytes.push_back(byte);
    is_padding_.push_back(is_padding);
  }

  void write_struct(CORBA::TypeCode_ptr type, const json& value) {
    ASSERT_EQ(value.size(), type->member_count()) << type->id();
    for (CORBA::ULong i = 0; i < type->member_count(); ++i) {
      CORBA::TypeCode_var member = type->member_type(i);
      ASSERT_TRUE(value.contains(type->member_name(i))) << type->id() << " " << type->member_name(i);
      write(member, value.at(type->member_name(i)));
    }
  }

  void write_sequence(CORBA::TypeCode_ptr type, const json& value) {
    put<std::uint32_t>(static_cast<std::uint32_t>(value.size()));
    CORBA::TypeCode_var content = type->content_type();
    for (const json& element : value) write(content, element);
  }

  void write_enum(CORBA::TypeCode_ptr type, const json& value) {
    for (CORBA::ULong i = 0; i < type->member_count(); ++i) {
      if (value == type->member_name(i)) return put<std::uint32_t>(i);
    }
    FAIL() << value << " is not in " << type->id();
  }

  void write_string(const std::string& text) {
    put<std::uint32_t>(static_cast<std::uint32_t>(text.size() + 1));
    for (char c : text) put_byte(static_cast<unsigned char>(c), false);
    put_byte(0, false);
  }

  // One octet with the length, then big-endian UTF-16.
  void write_wchar(const std::string& text) {
    put_byte(2, false);
    put_byte(0, false);
    put_byte(static_cast<unsigned char>(text.at(0)), false);
  }

  // Length in octets, then UTF-16 in the order of the host, which a byte-order mark tells.
  void write_wstring(const std::string& text) {
    put<std::uint32_t>(static_cast<std::uint32_t>(2 * text.size() + 2));
    put_byte(0xff, false);
    put_byte(0xfe, false);
    for (char c : text) {
      put_byte(static_cast<unsigned char>(c), false);
      put_byte(0, false);
    }
  }

  Order order_;
  std::vector<bool> is_padding_;
};

void prepare(cdrMemoryStream& stream, Order order) {
  stream.setByteSwapFlag(order == Order::little);
  const GIOP::Version version{1, 2};
  stream.TCS_C(omni::omniCodeSet::getTCS_C("ISO-8859-1", version));
  stream.TCS_W(omni::omniCodeSet::getTCS_W("UTF-16", version));
}

// Decodes with the generated code from one order and encodes to the other.
template <class T>
Bytes decode_and_encode(const Bytes& bytes, Order from, Order to) {
  cdrMemoryStream in(const_cast<unsigned char*>(bytes.data()), bytes.size());
  prepare(in, from);
  T value;
  value <<= in;
  cdrMemoryStream out(0, true);
  prepare(out, to);
  value >>= out;
  const auto* start = static_cast<const unsigned char*>(out.bufPtr());
  return Bytes(start, start + out.bufSize());
}

struct Entry {
  CORBA::TypeCode_ptr type;
  Bytes (*decode_and_encode)(const Bytes&, Order, Order);
};

template <class T>
Entry entry(CORBA::TypeCode_ptr type) {
  return {type, &decode_and_encode<T>};
}

const Entry entries[] = {
    entry<RTC::Acceleration2D>(RTC::_tc_Acceleration2D),
    entry<RTC::Acceleration3D>(RTC::_tc_Acceleration3D),
    entry<RTC::ActArrayActuatorCurrent>(RTC::_tc_ActArrayActuatorCurrent),
    entry<RTC::ActArrayActuatorGeometry>(RTC::_tc_ActArrayActuatorGeometry),
    entry<RTC::ActArrayActuatorPos>(RTC::_tc_ActArrayActuatorPos),
    entry<RTC::ActArrayActuatorSpeed>(RTC::_tc_ActArrayActuatorSpeed),
    entry<RTC::ActArrayGeometry>(RTC::_tc_ActArrayGeometry),
    entry<RTC::ActArrayState>(RTC::_tc_ActArrayState),
    entry<RTC::Actuator>(RTC::_tc_Actuator),
    entry<RTC::AngularAcceleration3D>(RTC::_tc_AngularAcceleration3D),
    entry<RTC::AngularVelocity3D>(RTC::_tc_AngularVelocity3D),
    entry<RTC::BumperArrayGeometry>(RTC::_tc_BumperArrayGeometry),
    entry<RTC::BumperGeometry>(RTC::_tc_BumperGeometry),
    entry<RTC::CameraImage>(RTC::_tc_CameraImage),
    entry<RTC::CameraInfo>(RTC::_tc_CameraInfo),
    entry<RTC::Carlike>(RTC::_tc_Carlike),
    entry<RTC::Covariance2D>(RTC::_tc_Covariance2D),
    entry<RTC::Covariance3D>(RTC::_tc_Covariance3D),
    entry<RTC::Features>(RTC::_tc_Features),
    entry<RTC::FiducialFOV>(RTC::_tc_FiducialFOV),
    entry<RTC::FiducialInfo>(RTC::_tc_FiducialInfo),
    entry<RTC::Fiducials>(RTC::_tc_Fiducials),
    entry<RTC::GPSData>(RTC::_tc_GPSData),
    entry<RTC::GPSTime>(RTC::_tc_GPSTime),
    entry<RTC::Geometry2D>(RTC::_tc_Geometry2D),
    entry<RTC::Geometry3D>(RTC::_tc_Geometry3D),
    entry<RTC::GripperGeometry>(RTC::_tc_GripperGeometry),
    entry<RTC::GripperState>(RTC::_tc_GripperState),
    entry<RTC::Hypotheses2D>(RTC::_tc_Hypotheses2D),
    entry<RTC::Hypotheses3D>(RTC::_tc_Hypotheses3D),
    entry<RTC::Hypothesis2D>(RTC::_tc_Hypothesis2D),
    entry<RTC::Hypothesis3D>(RTC::_tc_Hypothesis3D),
    entry<RTC::INSData>(RTC::_tc_INSData),
    entry<RTC::IntensityData>(RTC::_tc_IntensityData),
    entry<RTC::LimbState>(RTC::_tc_LimbState),
    entry<RTC::LineFeature>(RTC::_tc_LineFeature),
    entry<RTC::MultiCameraImages>(RTC::_tc_MultiCameraImages),
    entry<RTC::MulticameraGeometry>(RTC::_tc_MulticameraGeometry),
    entry<RTC::OAP>(RTC::_tc_OAP),
    entry<RTC::OGMapConfig>(RTC::_tc_OGMapConfig),
    entry<RTC::OGMapTile>(RTC::_tc_OGMapTile),
    entry<RTC::Orientation3D>(RTC::_tc_Orientation3D),
    entry<RTC::PanTiltAngles>(RTC::_tc_PanTiltAngles),
    entry<RTC::PanTiltState>(RTC::_tc_PanTiltState),
    entry<RTC::Path2D>(RTC::_tc_Path2D),
    entry<RTC::Path3D>(RTC::_tc_Path3D),
    entry<RTC::Point2D>(RTC::_tc_Point2D),
    entry<RTC::Point3D>(RTC::_tc_Point3D),
    entry<RTC::PointCloud>(RTC::_tc_PointCloud),
    entry<RTC::PointCloudPoint>(RTC::_tc_PointCloudPoint),
    entry<RTC::PointCovariance2D>(RTC::_tc_PointCovariance2D),
    entry<RTC::PointFeature>(RTC::_tc_PointFeature),
    entry<RTC::Pose2D>(RTC::_tc_Pose2D),
    entry<RTC::Pose3D>(RTC::_tc_Pose3D),
    entry<RTC::PoseFeature>(RTC::_tc_PoseFeature),
    entry<RTC::PoseVel2D>(RTC::_tc_PoseVel2D),
    entry<RTC::PoseVel3D>(RTC::_tc_PoseVel3D),
    entry<RTC::Quaternion>(RTC::_tc_Quaternion),
    entry<RTC::RGBColour>(RTC::_tc_RGBColour),
    entry<RTC::RangeData>(RTC::_tc_RangeData),
    entry<RTC::RangerConfig>(RTC::_tc_RangerConfig),
    entry<RTC::RangerGeometry>(RTC::_tc_RangerGeometry),
    entry<RTC::Size2D>(RTC::_tc_Size2D),
    entry<RTC::Size3D>(RTC::_tc_Size3D),
    entry<RTC::SpeedHeading2D>(RTC::_tc_SpeedHeading2D),
    entry<RTC::SpeedHeading3D>(RTC::_tc_SpeedHeading3D),
    entry<RTC::Time>(RTC::_tc_Time),
    entry<RTC::TimedAcceleration2D>(RTC::_tc_TimedAcceleration2D),
    entry<RTC::TimedAcceleration3D>(RTC::_tc_TimedAcceleration3D),
    entry<RTC::TimedAngularAcceleration3D>(RTC::_tc_TimedAngularAcceleration3D),
    entry<RTC::TimedAngularVelocity3D>(RTC::_tc_TimedAngularVelocity3D),
    entry<RTC::TimedBoolean>(RTC::_tc_TimedBoolean),
    entry<RTC::TimedBooleanSeq>(RTC::_tc_TimedBooleanSeq),
    entry<RTC::TimedCarlike>(RTC::_tc_TimedCarlike),
    entry<RTC::TimedChar>(RTC::_tc_TimedChar),
    entry<RTC::TimedCharSeq>(RTC::_tc_TimedCharSeq),
    entry<RTC::TimedCovariance2D>(RTC::_tc_TimedCovariance2D),
    entry<RTC::TimedCovariance3D>(RTC::_tc_TimedCovariance3D),
    entry<RTC::TimedDouble>(RTC::_tc_TimedDouble),
    entry<RTC::TimedDoubleSeq>(RTC::_tc_TimedDoubleSeq),
    entry<RTC::TimedFloat>(RTC::_tc_TimedFloat),
    entry<RTC::TimedFloatSeq>(RTC::_tc_TimedFloatSeq),
    entry<RTC::TimedGeometry2D>(RTC::_tc_TimedGeometry2D),
    entry<RTC::TimedGeometry3D>(RTC::_tc_TimedGeometry3D),
    entry<RTC::TimedLong>(RTC::_tc_TimedLong),
    entry<RTC::TimedLongSeq>(RTC::_tc_TimedLongSeq),
    entry<RTC::TimedOAP>(RTC::_tc_TimedOAP),
    entry<RTC::TimedOctet>(RTC::_tc_TimedOctet),
    entry<RTC::TimedOctetSeq>(RTC::_tc_TimedOctetSeq),
    entry<RTC::TimedOrientation3D>(RTC::_tc_TimedOrientation3D),
    entry<RTC::TimedPoint2D>(RTC::_tc_TimedPoint2D),
    entry<RTC::TimedPoint3D>(RTC::_tc_TimedPoint3D),
    entry<RTC::TimedPointCovariance2D>(RTC::_tc_TimedPointCovariance2D),
    entry<RTC::TimedPose2D>(RTC::_tc_TimedPose2D),
    entry<RTC::TimedPose3D>(RTC::_tc_TimedPose3D),
    entry<RTC::TimedPoseVel2D>(RTC::_tc_TimedPoseVel2D),
    entry<RTC::TimedPoseVel3D>(RTC::_tc_TimedPoseVel3D),
    entry<RTC::TimedQuaternion>(RTC::_tc_TimedQuaternion),
    entry<RTC::TimedRGBColour>(RTC::_tc_TimedRGBColour),
    entry<RTC::TimedShort>(RTC::_tc_TimedShort),
    entry<RTC::TimedShortSeq>(RTC::_tc_TimedShortSeq),
    entry<RTC::TimedSize2D>(RTC::_tc_TimedSize2D),
    entry<RTC::TimedSize3D>(RTC::_tc_TimedSize3D),
    entry<RTC::TimedSpeedHeading2D>(RTC::_tc_TimedSpeedHeading2D),
    entry<RTC::TimedSpeedHeading3D>(RTC::_tc_TimedSpeedHeading3D),
    entry<RTC::TimedState>(RTC::_tc_TimedState),
    entry<RTC::TimedString>(RTC::_tc_TimedString),
    entry<RTC::TimedStringSeq>(RTC::_tc_TimedStringSeq),
    entry<RTC::TimedULong>(RTC::_tc_TimedULong),
    entry<RTC::TimedULongSeq>(RTC::_tc_TimedULongSeq),
    entry<RTC::TimedUShort>(RTC::_tc_TimedUShort),
    entry<RTC::TimedUShortSeq>(RTC::_tc_TimedUShortSeq),
    entry<RTC::TimedVector2D>(RTC::_tc_TimedVector2D),
    entry<RTC::TimedVector3D>(RTC::_tc_TimedVector3D),
    entry<RTC::TimedVelocity2D>(RTC::_tc_TimedVelocity2D),
    entry<RTC::TimedVelocity3D>(RTC::_tc_TimedVelocity3D),
    entry<RTC::TimedWChar>(RTC::_tc_TimedWChar),
    entry<RTC::TimedWCharSeq>(RTC::_tc_TimedWCharSeq),
    entry<RTC::TimedWString>(RTC::_tc_TimedWString),
    entry<RTC::TimedWStringSeq>(RTC::_tc_TimedWStringSeq),
    entry<RTC::Vector2D>(RTC::_tc_Vector2D),
    entry<RTC::Vector3D>(RTC::_tc_Vector3D),
    entry<RTC::Velocity2D>(RTC::_tc_Velocity2D),
    entry<RTC::Velocity3D>(RTC::_tc_Velocity3D),
    entry<RTC::Waypoint2D>(RTC::_tc_Waypoint2D),
    entry<RTC::Waypoint3D>(RTC::_tc_Waypoint3D),
};

Bytes from_hex(const std::string& hex) {
  Bytes out;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2) out.push_back(static_cast<unsigned char>(std::stoi(hex.substr(i, 2), nullptr, 16)));
  return out;
}

class CdrPayload : public testing::Test {
 protected:
  // The ORB sets up the code sets.
  static void SetUpTestSuite() {
    int argc = 0;
    orb = CORBA::ORB_init(argc, nullptr);
  }
  static void TearDownTestSuite() {
    orb->destroy();
    orb = CORBA::ORB::_nil();
  }
  static inline CORBA::ORB_var orb;
};

TEST_F(CdrPayload, of_every_type_equals_the_recorded_one_in_both_orders) {
  std::ifstream file(std::string(paths::source_dir) + "/tests/golden/cdr_payloads.json");
  const json golden = json::parse(file);
  ASSERT_EQ(golden.size(), std::size(entries));
  for (std::size_t i = 0; i < golden.size(); ++i) {
    const json& record = golden[i];
    const Entry& entry = entries[i];
    SCOPED_TRACE(record.at("type").get<std::string>());
    ASSERT_EQ(record.at("type"), entry.type->id());
    const Bytes recorded[] = {from_hex(record.at("little_endian")), from_hex(record.at("big_endian"))};
    for (Order from : {Order::little, Order::big}) {
      Writer writer(from);
      writer.write(entry.type, record.at("value"));
      EXPECT_EQ(writer.without_padding(recorded[static_cast<int>(from)]), writer.bytes);
      for (Order to : {Order::little, Order::big}) {
        Writer expected(to);
        expected.write(entry.type, record.at("value"));
        EXPECT_EQ(entry.decode_and_encode(recorded[static_cast<int>(from)], from, to), expected.bytes);
      }
    }
  }
}

}  // namespace
