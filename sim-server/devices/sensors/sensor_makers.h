// Which kind of sensor becomes which device: one row for each kind that stands in a link or joint alone. Cameras and sonars, which make
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
    SensorMaker{SensorKind::logical_camera, make_logical_camera},
    SensorMaker{SensorKind::fiducial, make_fiducial},
};

}  // namespace sim
