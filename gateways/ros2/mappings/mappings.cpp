#include "mappings/mappings.h"

#include "mappings/geometry.h"
#include "mappings/sensors.h"

namespace ros2 {

// The first mapping of a data type is its default.
void add_mappings() {
  add_number_mappings();
  add_sequence_mappings();

  add_mapping<VelocityAndTwist<RTC::TimedVelocity2D>>();
  add_mapping<VelocityAndStampedTwist<RTC::TimedVelocity2D>>();
  add_mapping<VelocityAndTwist<RTC::TimedVelocity3D>>();
  add_mapping<VelocityAndStampedTwist<RTC::TimedVelocity3D>>();
  add_mapping<PoseAndOdometry<RTC::TimedPose2D>>();
  add_mapping<PoseAndPose<RTC::TimedPose2D>>();
  add_mapping<PoseAndPose<RTC::TimedPose3D>>();
  add_mapping<PoseAndOdometry<RTC::TimedPose3D>>();
  add_mapping<PoseAndOdometry<RTC::TimedPoseVel2D>>();
  add_mapping<PoseAndOdometry<RTC::TimedPoseVel3D>>();
  add_mapping<PointAndPoint<RTC::TimedPoint2D>>();
  add_mapping<PointAndPoint<RTC::TimedPoint3D>>();
  add_mapping<VectorAndVector<RTC::TimedVector2D>>();
  add_mapping<VectorAndVector<RTC::TimedVector3D>>();
  add_mapping<OrientationAndQuaternion<RTC::TimedQuaternion>>();
  add_mapping<OrientationAndQuaternion<RTC::TimedOrientation3D>>();
  add_mapping<OrientationAndImu>();
  add_mapping<VectorAndVector<RTC::TimedAngularVelocity3D>>();
  add_mapping<AngularVelocityAndImu>();
  add_mapping<VectorAndVector<RTC::TimedAcceleration3D>>();
  add_mapping<AccelerationAndImu>();

  add_mapping<RangesAndScan>();
  add_mapping<ImageAndImage>();
  add_mapping<ImageAndCompressedImage>();
  add_mapping<PointsAndCloud>();
  add_mapping<CloudAndCloud>();
  add_mapping<ActuatorsAndJoints>();
  add_mapping<NumbersAndJoints>();
  add_mapping<JointPosAndJoints>();
  add_mapping<GpsAndFix>();
}

}  // namespace ros2
