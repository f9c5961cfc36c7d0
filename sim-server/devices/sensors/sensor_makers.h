// Table of the device for each kind of sensor: one row for each kind that is in a link or joint alone. Cameras and sonars, which make
// several ifaces of a sensor or one of several, are in camera.h and sonar.h. A maker fails when the iface cannot be made.
#pragma once

#include <array>

#include "devices/sensors/sensor.h"

namespace sim {

MadeDevice make_laser(const SensorSite& site);
MadeDevice make_imu(const SensorSite& site);
MadeDevice make_gps(const SensorSite& site);
MadeDevice make_bumper(const SensorSite& site);
MadeDevice make_force_torque(const SensorSite& site);
MadeDevice make_altimeter(const SensorSite& site);
MadeDevice make_magnetometer(const SensorSite& site);
MadeDevice make_air_pressure(const SensorSite& site);
MadeDevice make_dvl(const SensorSite& site);
MadeDevice make_air_speed(const SensorSite& site);
MadeDevice make_ins(const SensorSite& site);
MadeDevice make_rfid(const SensorSite& site);
MadeDevice make_wireless(const SensorSite& site);
MadeDevice make_wheels(const SensorSite& site);
MadeDevice make_localization(const SensorSite& site);

// A joint that the sensor names and the model does not have, or that turns about no single axis; empty: none. Of wheel encoders.
std::string missing_wheel(const ModelDef& model, const SensorDef& sensor);
MadeDevice make_logical_camera(const SensorSite& site);
MadeDevice make_fiducial(const SensorSite& site);

struct SensorMaker {
  SensorKind kind;
  MadeDevice (*make)(const SensorSite& site);
  bool stands_in_joint = false;  // what it measures is a joint's
};

inline constexpr std::array sensor_makers{
    SensorMaker{SensorKind::ray, make_laser},
    SensorMaker{SensorKind::imu, make_imu},
    SensorMaker{SensorKind::gps, make_gps},
    SensorMaker{SensorKind::contact, make_bumper},
    SensorMaker{SensorKind::force_torque, make_force_torque, true},
    SensorMaker{SensorKind::altimeter, make_altimeter},
    SensorMaker{SensorKind::magnetometer, make_magnetometer},
    SensorMaker{SensorKind::air_pressure, make_air_pressure},
    SensorMaker{SensorKind::dvl, make_dvl},
    SensorMaker{SensorKind::air_speed, make_air_speed},
    SensorMaker{SensorKind::ins, make_ins},
    SensorMaker{SensorKind::rfid, make_rfid},
    SensorMaker{SensorKind::wireless_receiver, make_wireless},
    SensorMaker{SensorKind::wheels, make_wheels},
    SensorMaker{SensorKind::localization, make_localization},
    SensorMaker{SensorKind::logical_camera, make_logical_camera},
    SensorMaker{SensorKind::fiducial, make_fiducial},
};

}  // namespace sim
