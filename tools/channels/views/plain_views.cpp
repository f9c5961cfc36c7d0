// Batteries, sound, radio, wheels and fused estimates as channels.
#include "channels/views/view_parts.h"
#include "ros/from_device.h"

namespace channels {
namespace {

// Of a device that is nowhere in particular: without a frame of its own.
template <class Message, class Info, class Say>
IfaceView placeless_view(const shm::Iface& iface, Say say) {
  IfaceView view;
  view.channels = {channel<Message>(iface)};
  view.rate = iface.info<Info>().rate;
  view.tell = [say](shm::Iface& from, const shm::HeldFrame*, Said& said) {
    if (from.sample<shm::Stamp>().valid != 0) said.add(0, say(from));
  };
  return view;
}

// Only while the velocity is known.
IfaceView dvl_view(const shm::Iface& iface) {
  IfaceView view;
  view.channels = {channel<ros::TwistWithCovarianceStamped>(iface)};
  place<shm::DvlInfo>(view, iface);
  view.tell = [](shm::Iface& from, const shm::HeldFrame*, Said& said) {
    if (from.sample<shm::Stamp>().valid == 0) return;
    if (const auto message = ros::dvl_message(from, from.name())) said.add(0, *message);
  };
  return view;
}

IfaceView ins_view(const shm::Iface& iface) {
  IfaceView view;
  view.channels = {channel<ros::NavSatFix>(iface, "/fix"), channel<ros::Imu>(iface, "/orientation"),
                   channel<ros::TwistStamped>(iface, "/velocity")};
  place<shm::InsInfo>(view, iface);
  view.tell = [](shm::Iface& from, const shm::HeldFrame*, Said& said) {
    if (from.sample<shm::Stamp>().valid == 0) return;
    said.add(0, ros::ins_fix(from, from.name()));
    said.add(1, ros::ins_orientation(from, from.name()));
    said.add(2, ros::ins_velocity(from, from.name()));
  };
  return view;
}

IfaceView localization_view(const shm::Iface& iface) {
  IfaceView view;
  view.channels = {channel<ros::PoseWithCovarianceStamped>(iface)};
  view.rate = iface.info<shm::LocalizationInfo>().rate;
  view.tell = [](shm::Iface& from, const shm::HeldFrame*, Said& said) {
    if (from.sample<shm::Stamp>().valid == 0) return;
    if (const auto message = ros::localization_message(from, world_frame)) said.add(0, *message);
  };
  return view;
}

}  // namespace

std::optional<IfaceView> plain_view(const shm::Iface& iface) {
  switch (iface.type()) {
    case shm::IfaceType::battery:
      return placeless_view<ros::BatteryState, shm::BatteryInfo>(
          iface, [](const shm::Iface& from) { return ros::battery_message(from, text_of(from.info<shm::BatteryInfo>().model)); });
    case shm::IfaceType::dvl:
      return dvl_view(iface);
    case shm::IfaceType::air_speed:
      return simple_view<ros::FluidPressure, shm::MeterInfo>(iface, ros::air_speed_message);
    case shm::IfaceType::ins:
      return ins_view(iface);
    case shm::IfaceType::rfid:
      return simple_view<ros::Text, shm::RfidInfo>(iface, ros::rfid_message);
    case shm::IfaceType::wireless:
      return simple_view<ros::Text, shm::WirelessInfo>(iface, ros::wireless_message);
    case shm::IfaceType::wheels:
      return placeless_view<ros::JointState, shm::WheelsInfo>(
          iface, [](const shm::Iface& from) { return ros::wheels_message(from, from.name()); });
    case shm::IfaceType::localization:
      return localization_view(iface);
    default:
      return std::nullopt;
  }
}

}  // namespace channels
