// The list of data types that print and inject know: every one that idl/ defines for data ports.
#include <map>

#include "rtm/ext/CameraCommonInterfaceStub.h"
#include "rtm/ext/HRPDataTypesStub.h"
#include "rtm/ext/ManipulatorCommonInterface_DataTypesStub.h"
#include "rtm/ext/PointCloudTypesStub.h"
#include "rtm/idl/InterfaceDataTypesStub.h"
#include "system/value_codec.h"

namespace tools {
namespace {

const std::map<std::string, CORBA::TypeCode_ptr>& types() {
  static const auto all = [] {
    std::map<std::string, CORBA::TypeCode_ptr> map;
    for (const auto type : {RTC::_tc_Acceleration2D,
                            RTC::_tc_Acceleration3D,
                            RTC::_tc_ActArrayActuatorCurrent,
                            RTC::_tc_ActArrayActuatorGeometry,
                            RTC::_tc_ActArrayActuatorPos,
                            RTC::_tc_ActArrayActuatorSpeed,
                            RTC::_tc_ActArrayGeometry,
                            RTC::_tc_ActArrayState,
                            RTC::_tc_Actuator,
                            RTC::_tc_AngularAcceleration3D,
                            RTC::_tc_AngularVelocity3D,
                            RTC::_tc_BumperArrayGeometry,
                            RTC::_tc_BumperGeometry,
                            RTC::_tc_CameraImage,
                            RTC::_tc_CameraInfo,
                            RTC::_tc_Carlike,
                            RTC::_tc_Covariance2D,
                            RTC::_tc_Covariance3D,
                            RTC::_tc_Features,
                            RTC::_tc_FiducialFOV,
                            RTC::_tc_FiducialInfo,
                            RTC::_tc_Fiducials,
                            RTC::_tc_GPSData,
                            RTC::_tc_GPSTime,
                            RTC::_tc_Geometry2D,
                            RTC::_tc_Geometry3D,
                            RTC::_tc_GripperGeometry,
                            RTC::_tc_GripperState,
                            RTC::_tc_Hypotheses2D,
                            RTC::_tc_Hypotheses3D,
                            RTC::_tc_Hypothesis2D,
                            RTC::_tc_Hypothesis3D,
                            RTC::_tc_INSData,
                            RTC::_tc_IntensityData,
                            RTC::_tc_LimbState,
                            RTC::_tc_LineFeature,
                            RTC::_tc_MultiCameraImages,
                            RTC::_tc_MulticameraGeometry,
                            RTC::_tc_OAP,
                            RTC::_tc_OGMapConfig,
                            RTC::_tc_OGMapTile,
                            RTC::_tc_Orientation3D,
                            RTC::_tc_PanTiltAngles,
                            RTC::_tc_PanTiltState,
                            RTC::_tc_Path2D,
                            RTC::_tc_Path3D,
                            RTC::_tc_Point2D,
                            RTC::_tc_Point3D,
                            RTC::_tc_PointCloud,
                            RTC::_tc_PointCloudPoint,
                            RTC::_tc_PointCovariance2D,
                            RTC::_tc_PointFeature,
                            RTC::_tc_Pose2D,
                            RTC::_tc_Pose3D,
                            RTC::_tc_PoseFeature,
                            RTC::_tc_PoseVel2D,
                            RTC::_tc_PoseVel3D,
                            RTC::_tc_Quaternion,
                            RTC::_tc_RGBColour,
                            RTC::_tc_RangeData,
                            RTC::_tc_RangerConfig,
                            RTC::_tc_RangerGeometry,
                            RTC::_tc_Size2D,
                            RTC::_tc_Size3D,
                            RTC::_tc_SpeedHeading2D,
                            RTC::_tc_SpeedHeading3D,
                            RTC::_tc_Time,
                            RTC::_tc_TimedAcceleration2D,
                            RTC::_tc_TimedAcceleration3D,
                            RTC::_tc_TimedAngularAcceleration3D,
                            RTC::_tc_TimedAngularVelocity3D,
                            RTC::_tc_TimedBoolean,
                            RTC::_tc_TimedBooleanSeq,
                            RTC::_tc_TimedCarlike,
                            RTC::_tc_TimedChar,
                            RTC::_tc_TimedCharSeq,
                            RTC::_tc_TimedCovariance2D,
                            RTC::_tc_TimedCovariance3D,
                            RTC::_tc_TimedDouble,
                            RTC::_tc_TimedDoubleSeq,
                            RTC::_tc_TimedFloat,
                            RTC::_tc_TimedFloatSeq,
                            RTC::_tc_TimedGeometry2D,
                            RTC::_tc_TimedGeometry3D,
                            RTC::_tc_TimedLong,
                            RTC::_tc_TimedLongSeq,
                            RTC::_tc_TimedOAP,
                            RTC::_tc_TimedOctet,
                            RTC::_tc_TimedOctetSeq,
                            RTC::_tc_TimedOrientation3D,
                            RTC::_tc_TimedPoint2D,
                            RTC::_tc_TimedPoint3D,
                            RTC::_tc_TimedPointCovariance2D,
                            RTC::_tc_TimedPose2D,
                            RTC::_tc_TimedPose3D,
                            RTC::_tc_TimedPoseVel2D,
                            RTC::_tc_TimedPoseVel3D,
                            RTC::_tc_TimedQuaternion,
                            RTC::_tc_TimedRGBColour,
                            RTC::_tc_TimedShort,
                            RTC::_tc_TimedShortSeq,
                            RTC::_tc_TimedSize2D,
                            RTC::_tc_TimedSize3D,
                            RTC::_tc_TimedSpeedHeading2D,
                            RTC::_tc_TimedSpeedHeading3D,
                            RTC::_tc_TimedState,
                            RTC::_tc_TimedString,
                            RTC::_tc_TimedStringSeq,
                            RTC::_tc_TimedULong,
                            RTC::_tc_TimedULongSeq,
                            RTC::_tc_TimedUShort,
                            RTC::_tc_TimedUShortSeq,
                            RTC::_tc_TimedVector2D,
                            RTC::_tc_TimedVector3D,
                            RTC::_tc_TimedVelocity2D,
                            RTC::_tc_TimedVelocity3D,
                            RTC::_tc_TimedWChar,
                            RTC::_tc_TimedWCharSeq,
                            RTC::_tc_TimedWString,
                            RTC::_tc_TimedWStringSeq,
                            RTC::_tc_Vector2D,
                            RTC::_tc_Vector3D,
                            RTC::_tc_Velocity2D,
                            RTC::_tc_Velocity3D,
                            RTC::_tc_Waypoint2D,
                            RTC::_tc_Waypoint3D,
                            Img::_tc_ImageData,
                            Img::_tc_CameraImage,
                            Img::_tc_TimedCameraImage,
                            Img::_tc_MultiCameraImage,
                            Img::_tc_TimedMultiCameraImage,
                            Img::_tc_CameraDeviceProfile,
                            JARA_ARM::_tc_TimedJointPos,
                            OpenHRP::_tc_TimedLongSeqSeq,
                            PointCloudTypes::_tc_PointCloud}) {
      map.emplace(type->id(), type);
    }
    return map;
  }();
  return all;
}

}  // namespace

CORBA::TypeCode_ptr type_code_of(const std::string& repository_id) {
  const auto found = types().find(repository_id);
  return found == types().end() ? CORBA::TypeCode::_nil() : found->second;
}

std::vector<std::string> known_data_types() {
  std::vector<std::string> ids;
  for (const auto& [id, type] : types()) ids.push_back(id);
  return ids;
}

}  // namespace tools
