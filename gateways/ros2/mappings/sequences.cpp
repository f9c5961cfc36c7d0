#include "mappings/mappings.h"
#include "mappings/numbers.h"

namespace ros2 {
namespace {

template <class Timed, class... Messages>
void add_arrays() {
  (add_mapping<SequenceAndArray<Timed, Messages>>(), ...);
}
template <class Timed, class Default>
void add_any_array() {
  using namespace ros;
  add_arrays<Timed, Default, Float32MultiArray, Float64MultiArray, Int8MultiArray, Int16MultiArray, Int32MultiArray, Int64MultiArray,
             UInt8MultiArray, UInt16MultiArray, UInt32MultiArray, UInt64MultiArray>();
}

}  // namespace

void add_sequence_mappings() {
  add_any_array<RTC::TimedFloatSeq, ros::Float32MultiArray>();
  add_any_array<RTC::TimedDoubleSeq, ros::Float64MultiArray>();
  add_any_array<RTC::TimedShortSeq, ros::Int16MultiArray>();
  add_any_array<RTC::TimedLongSeq, ros::Int32MultiArray>();
  add_any_array<RTC::TimedUShortSeq, ros::UInt16MultiArray>();
  add_any_array<RTC::TimedULongSeq, ros::UInt32MultiArray>();
  add_arrays<RTC::TimedBooleanSeq, ros::UInt8MultiArray>();
  add_arrays<RTC::TimedOctetSeq, ros::UInt8MultiArray>();
  add_arrays<RTC::TimedCharSeq, ros::Int8MultiArray>();
}

}  // namespace ros2
