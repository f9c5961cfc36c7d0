#include "mappings/numbers.h"

#include "mappings/mappings.h"

namespace ros2 {
namespace {

// The first message is the default; one that is named twice counts once.
template <class Timed, class... Messages>
void add_numbers() {
  (add_mapping<NumberAndNumber<Timed, Messages>>(), ...);
}
template <class Timed, class Default>
void add_any_number() {
  using namespace ros;
  add_numbers<Timed, Default, Float32, Float64, Int8, Int16, Int32, Int64, UInt8, UInt16, UInt32, UInt64>();
}

}  // namespace

void add_number_mappings() {
  add_any_number<RTC::TimedFloat, ros::Float32>();
  add_any_number<RTC::TimedDouble, ros::Float64>();
  add_any_number<RTC::TimedShort, ros::Int16>();
  add_any_number<RTC::TimedLong, ros::Int32>();
  add_any_number<RTC::TimedUShort, ros::UInt16>();
  add_any_number<RTC::TimedULong, ros::UInt32>();
  add_any_number<RTC::TimedState, ros::Int16>();
  add_numbers<RTC::TimedBoolean, ros::Bool>();
  add_numbers<RTC::TimedOctet, ros::UInt8>();
  add_numbers<RTC::TimedChar, ros::Int8>();
  add_mapping<TextAndString>();
}

}  // namespace ros2
