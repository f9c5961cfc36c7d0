// Every type of the wire contract has the repository ID, the members and the order of the contract.
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "idl/all_stubs.h"
#include "support/paths.h"

namespace {

// "IDL:omg.org/RTC/Time:1.0" -> "RTC::Time"
std::string scoped_name(const std::string& id) {
  std::string path = id.substr(4, id.rfind(':') - 4);
  if (path.find('.') < path.find('/')) path.erase(0, path.find('/') + 1);
  if (auto slash = path.find('/'); slash != std::string::npos) path.replace(slash, 1, "::");
  return path;
}

std::string type_name(CORBA::TypeCode_ptr type) {
  switch (type->kind()) {
    case CORBA::tk_short:
      return "short";
    case CORBA::tk_long:
      return "long";
    case CORBA::tk_ushort:
      return "ushort";
    case CORBA::tk_ulong:
      return "ulong";
    case CORBA::tk_ulonglong:
      return "ulonglong";
    case CORBA::tk_float:
      return "float";
    case CORBA::tk_double:
      return "double";
    case CORBA::tk_boolean:
      return "boolean";
    case CORBA::tk_char:
      return "char";
    case CORBA::tk_wchar:
      return "wchar";
    case CORBA::tk_octet:
      return "octet";
    case CORBA::tk_string:
      return "string";
    case CORBA::tk_wstring:
      return "wstring";
    case CORBA::tk_any:
      return "any";
    case CORBA::tk_TypeCode:
      return "TypeCode";
    case CORBA::tk_sequence: {
      CORBA::TypeCode_var content = type->content_type();
      return "sequence<" + type_name(content) + ">";
    }
    default:
      return scoped_name(type->id());
  }
}

// A type and its name, with the sizes of an array behind the name for members and behind the type for typedefs.
std::string declaration(CORBA::TypeCode_ptr type, const std::string& name) {
  std::string sizes;
  CORBA::TypeCode_var inner = CORBA::TypeCode::_duplicate(type);
  while (inner->kind() == CORBA::tk_array) {
    sizes += "[" + std::to_string(inner->length()) + "]";
    inner = inner->content_type();
  }
  return type_name(inner) + (name.empty() ? "" : " " + name) + sizes;
}

std::string union_label(CORBA::TypeCode_ptr type, CORBA::ULong i) {
  CORBA::TypeCode_var discriminator = type->discriminator_type();
  CORBA::Any_var label = type->member_label(i);
  cdrMemoryStream stream;
  label->NP_marshalDataOnly(stream);
  CORBA::ULong value = 0;
  value <<= stream;
  const std::string enum_name = scoped_name(discriminator->id());
  return enum_name.substr(0, enum_name.find("::") + 2) + discriminator->member_name(value);
}

std::string content(CORBA::TypeCode_ptr type) {
  std::string out;
  if (type->kind() == CORBA::tk_alias) {
    CORBA::TypeCode_var aliased = type->content_type();
    return declaration(aliased, "");
  }
  if (type->kind() == CORBA::tk_union) {
    CORBA::TypeCode_var discriminator = type->discriminator_type();
    out = "switch " + type_name(discriminator) + ": ";
  }
  for (CORBA::ULong i = 0; i < type->member_count(); ++i) {
    if (type->kind() == CORBA::tk_enum) {
      out += (i ? ", " : "") + std::string(type->member_name(i)) + "=" + std::to_string(i);
      continue;
    }
    CORBA::TypeCode_var member = type->member_type(i);
    out += i ? "; " : "";
    if (type->kind() == CORBA::tk_union) out += "[" + union_label(type, i) + "] ";
    out += declaration(member, type->member_name(i));
  }
  return out;
}

std::string kind_name(CORBA::TypeCode_ptr type) {
  switch (type->kind()) {
    case CORBA::tk_alias:
      return "typedef";
    case CORBA::tk_struct:
      return "struct";
    case CORBA::tk_enum:
      return "enum";
    case CORBA::tk_union:
      return "union";
    case CORBA::tk_except:
      return "exception";
    default:
      return "?";
  }
}

const CORBA::TypeCode_ptr types[] = {
    SDOPackage::_tc_StringList,
    SDOPackage::_tc_SDOList,
    SDOPackage::_tc_OrganizationList,
    SDOPackage::_tc_UniqueIdentifier,
    SDOPackage::_tc_NameValue,
    SDOPackage::_tc_NVList,
    SDOPackage::_tc_NumericType,
    SDOPackage::_tc_Numeric,
    SDOPackage::_tc_EnumerationType,
    SDOPackage::_tc_RangeType,
    SDOPackage::_tc_IntervalType,
    SDOPackage::_tc_ComplexDataType,
    SDOPackage::_tc_AllowedValues,
    SDOPackage::_tc_Parameter,
    SDOPackage::_tc_ParameterList,
    SDOPackage::_tc_OrganizationProperty,
    SDOPackage::_tc_DependencyType,
    SDOPackage::_tc_DeviceProfile,
    SDOPackage::_tc_ServiceProfile,
    SDOPackage::_tc_ServiceProfileList,
    SDOPackage::_tc_ConfigurationSet,
    SDOPackage::_tc_ConfigurationSetList,
    SDOPackage::_tc_NotAvailable,
    SDOPackage::_tc_InterfaceNotImplemented,
    SDOPackage::_tc_InvalidParameter,
    SDOPackage::_tc_InternalError,
    RTC::_tc_ExecutionContextHandle_t,
    RTC::_tc_UniqueIdentifier,
    RTC::_tc_NVList,
    RTC::_tc_ReturnCode_t,
    RTC::_tc_LifeCycleState,
    RTC::_tc_ExecutionContextList,
    RTC::_tc_ExecutionKind,
    RTC::_tc_PortInterfacePolarity,
    RTC::_tc_PortInterfaceProfile,
    RTC::_tc_PortInterfaceProfileList,
    RTC::_tc_PortServiceList,
    RTC::_tc_RTCList,
    RTC::_tc_ConnectorProfile,
    RTC::_tc_ConnectorProfileList,
    RTC::_tc_PortProfile,
    RTC::_tc_PortProfileList,
    RTC::_tc_ExecutionContextProfile,
    RTC::_tc_ExecutionContextProfileList,
    RTC::_tc_FsmBehaviorProfile,
    RTC::_tc_FsmBehaviorProfileList,
    RTC::_tc_FsmProfile,
    RTC::_tc_ComponentProfile,
    RTC::_tc_ComponentProfileList,
    RTC::_tc_ExecutionContextServiceList,
    OpenRTM::_tc_PortStatus,
    OpenRTM::_tc_CdrData,
    RTC::_tc_PortStatus,
    RTC::_tc_OctetSeq,
    RTM::_tc_NVList,
    RTM::_tc_ModuleProfile,
    RTM::_tc_ModuleProfileList,
    RTM::_tc_ManagerProfile,
    RTM::_tc_ManagerList,
    RTC::_tc_FsmEventProfile,
    RTC::_tc_FsmEventProfileList,
    RTC::_tc_FsmStructure,
    OpenRTM::_tc_StatusKind,
    RTC::_tc_StatusKind,
    OpenRTM::_tc_LogLevel,
    OpenRTM::_tc_LogRecord,
    RTC::_tc_Time,
    RTC::_tc_TimedState,
    RTC::_tc_TimedShort,
    RTC::_tc_TimedLong,
    RTC::_tc_TimedUShort,
    RTC::_tc_TimedULong,
    RTC::_tc_TimedFloat,
    RTC::_tc_TimedDouble,
    RTC::_tc_TimedChar,
    RTC::_tc_TimedWChar,
    RTC::_tc_TimedBoolean,
    RTC::_tc_TimedOctet,
    RTC::_tc_TimedString,
    RTC::_tc_TimedWString,
    RTC::_tc_TimedShortSeq,
    RTC::_tc_TimedLongSeq,
    RTC::_tc_TimedUShortSeq,
    RTC::_tc_TimedULongSeq,
    RTC::_tc_TimedFloatSeq,
    RTC::_tc_TimedDoubleSeq,
    RTC::_tc_TimedCharSeq,
    RTC::_tc_TimedWCharSeq,
    RTC::_tc_TimedBooleanSeq,
    RTC::_tc_TimedOctetSeq,
    RTC::_tc_TimedStringSeq,
    RTC::_tc_TimedWStringSeq,
    RTC::_tc_RGBColour,
    RTC::_tc_Point2D,
    RTC::_tc_Vector2D,
    RTC::_tc_Pose2D,
    RTC::_tc_Velocity2D,
    RTC::_tc_Acceleration2D,
    RTC::_tc_PoseVel2D,
    RTC::_tc_Size2D,
    RTC::_tc_Geometry2D,
    RTC::_tc_Covariance2D,
    RTC::_tc_PointCovariance2D,
    RTC::_tc_Carlike,
    RTC::_tc_SpeedHeading2D,
    RTC::_tc_Point3D,
    RTC::_tc_Vector3D,
    RTC::_tc_Orientation3D,
    RTC::_tc_Pose3D,
    RTC::_tc_Velocity3D,
    RTC::_tc_AngularVelocity3D,
    RTC::_tc_Acceleration3D,
    RTC::_tc_AngularAcceleration3D,
    RTC::_tc_PoseVel3D,
    RTC::_tc_Size3D,
    RTC::_tc_Geometry3D,
    RTC::_tc_Covariance3D,
    RTC::_tc_SpeedHeading3D,
    RTC::_tc_OAP,
    RTC::_tc_TimedRGBColour,
    RTC::_tc_TimedPoint2D,
    RTC::_tc_TimedVector2D,
    RTC::_tc_TimedPose2D,
    RTC::_tc_TimedVelocity2D,
    RTC::_tc_TimedAcceleration2D,
    RTC::_tc_TimedPoseVel2D,
    RTC::_tc_TimedSize2D,
    RTC::_tc_TimedGeometry2D,
    RTC::_tc_TimedCovariance2D,
    RTC::_tc_TimedPointCovariance2D,
    RTC::_tc_TimedCarlike,
    RTC::_tc_TimedSpeedHeading2D,
    RTC::_tc_TimedPoint3D,
    RTC::_tc_TimedVector3D,
    RTC::_tc_TimedOrientation3D,
    RTC::_tc_TimedPose3D,
    RTC::_tc_TimedVelocity3D,
    RTC::_tc_TimedAngularVelocity3D,
    RTC::_tc_TimedAcceleration3D,
    RTC::_tc_TimedAngularAcceleration3D,
    RTC::_tc_TimedPoseVel3D,
    RTC::_tc_TimedSize3D,
    RTC::_tc_TimedGeometry3D,
    RTC::_tc_TimedCovariance3D,
    RTC::_tc_TimedSpeedHeading3D,
    RTC::_tc_TimedOAP,
    RTC::_tc_Quaternion,
    RTC::_tc_TimedQuaternion,
    RTC::_tc_ActArrayActuatorPos,
    RTC::_tc_ActArrayActuatorSpeed,
    RTC::_tc_ActArrayActuatorCurrent,
    RTC::_tc_ActArrayActuatorStatus,
    RTC::_tc_Actuator,
    RTC::_tc_ActuatorList,
    RTC::_tc_ActArrayState,
    RTC::_tc_ActArrayActuatorType,
    RTC::_tc_ActArrayActuatorGeometry,
    RTC::_tc_ActArrayActuatorGeometryList,
    RTC::_tc_ActArrayGeometry,
    RTC::_tc_BumperGeometry,
    RTC::_tc_BumperGeometryList,
    RTC::_tc_BumperArrayGeometry,
    RTC::_tc_CameraImage,
    RTC::_tc_CameraInfo,
    RTC::_tc_FiducialInfo,
    RTC::_tc_FiducialInfoList,
    RTC::_tc_Fiducials,
    RTC::_tc_FiducialFOV,
    RTC::_tc_GPSTime,
    RTC::_tc_GPSFixType,
    RTC::_tc_GPSData,
    RTC::_tc_GripperStatus,
    RTC::_tc_GripperState,
    RTC::_tc_GripperGeometry,
    RTC::_tc_INSData,
    RTC::_tc_LimbStatus,
    RTC::_tc_LimbState,
    RTC::_tc_Hypothesis2D,
    RTC::_tc_Hypothesis2DList,
    RTC::_tc_Hypotheses2D,
    RTC::_tc_Hypothesis3D,
    RTC::_tc_Hypothesis3DList,
    RTC::_tc_Hypotheses3D,
    RTC::_tc_OGMapConfig,
    RTC::_tc_OGMapCells,
    RTC::_tc_OGMapTile,
    RTC::_tc_PointFeature,
    RTC::_tc_PointFeatureList,
    RTC::_tc_PoseFeature,
    RTC::_tc_PoseFeatureList,
    RTC::_tc_LineFeature,
    RTC::_tc_LineFeatureList,
    RTC::_tc_Features,
    RTC::_tc_MulticameraImageList,
    RTC::_tc_MultiCameraImages,
    RTC::_tc_MulticameraInfoList,
    RTC::_tc_MulticameraGeometryList,
    RTC::_tc_MulticameraGeometry,
    RTC::_tc_Waypoint2D,
    RTC::_tc_Waypoint2DList,
    RTC::_tc_Path2D,
    RTC::_tc_Waypoint3D,
    RTC::_tc_Waypoint3DList,
    RTC::_tc_Path3D,
    RTC::_tc_PointCloudPoint,
    RTC::_tc_PointCloudPointList,
    RTC::_tc_PointCloud,
    RTC::_tc_PanTiltAngles,
    RTC::_tc_PanTiltState,
    RTC::_tc_ElementGeometryList,
    RTC::_tc_RangerGeometry,
    RTC::_tc_RangerConfig,
    RTC::_tc_RangeList,
    RTC::_tc_RangeData,
    RTC::_tc_IntensityList,
    RTC::_tc_IntensityData,
    RTC::_tc_RFIDTagData,
    PointCloudTypes::_tc_DataType,
    PointCloudTypes::_tc_PointField,
    PointCloudTypes::_tc_PointCloud,
    Img::_tc_Vec3,
    Img::_tc_Mat44,
    Img::_tc_ColorFormat,
    Img::_tc_ImageData,
    Img::_tc_CameraIntrinsicParameter,
    Img::_tc_CameraImage,
    Img::_tc_TimedCameraImage,
    Img::_tc_MultiCameraImage,
    Img::_tc_TimedMultiCameraImage,
    Img::_tc_NamedValue,
    Img::_tc_NVList,
    Img::_tc_CameraDeviceProfile,
    JARA_ARM::_tc_DoubleSeq,
    JARA_ARM::_tc_JointPos,
    JARA_ARM::_tc_LimitValue,
    JARA_ARM::_tc_RETURN_ID,
    JARA_ARM::_tc_TimedJointPos,
    JARA_ARM::_tc_ULONG,
    JARA_ARM::_tc_AlarmType,
    JARA_ARM::_tc_Alarm,
    JARA_ARM::_tc_AlarmSeq,
    JARA_ARM::_tc_LimitSeq,
    JARA_ARM::_tc_ManipInfo,
    JARA_ARM::_tc_HgMatrix,
    JARA_ARM::_tc_CarPosWithElbow,
    JARA_ARM::_tc_CartesianSpeed,
};

TEST(WireTypes, every_type_has_the_id_members_and_order_of_the_contract) {
  std::ifstream golden(std::string(paths::source_dir) + "/tests/golden/wire_types.txt");
  ASSERT_TRUE(golden);
  std::string expected;
  for (CORBA::TypeCode_ptr type : types) {
    ASSERT_TRUE(std::getline(golden, expected));
    EXPECT_EQ(kind_name(type) + " " + type->id() + " " + content(type), expected);
  }
  EXPECT_FALSE(std::getline(golden, expected));
}

}  // namespace
