#!/usr/bin/env python
# -*- coding: utf-8 -*-
# -*- Python -*-
import sys
import time
from math import *
import OpenRTM_aist
import RTC

values_spec = ["implementation_id", "Values", "type_name", "Values", "description", "a style", "version", "1.0.0", "vendor", "rtm-sim",
            "category", "test", "activity_type", "STATIC", "max_instance", "1", "language", "Python", "lang_type", "SCRIPT",
            ""]

class Values(OpenRTM_aist.DataFlowComponentBase):
    def onInitialize(self):
        rg = RTC.RangerGeometry(RTC.Geometry3D(RTC.Pose3D(RTC.Point3D(0,0,0), RTC.Orientation3D(0,0,0)), RTC.Size3D(0,0,0)), [])
        rc = RTC.RangerConfig(*[0.0]*7)
        self._d = RTC.RangeData(RTC.Time(0,0), [1.0]*10, rg, rc)
        self._o = OpenRTM_aist.OutPort("range", self._d)
        self.addOutPort("range", self._o)
        self._v = RTC.TimedVelocity3D(RTC.Time(0,0), RTC.Velocity3D(0,0,0,0,0,0))
        self._v2 = RTC.TimedPoint3D(RTC.Time(0,0), RTC.Point3D(0,0,0))
        self._p3 = RTC.TimedPose3D(RTC.Time(0,0), RTC.Pose3D(RTC.Point3D(0,0,0), RTC.Orientation3D(0,0,0)))
        self._acc = RTC.TimedAcceleration3D(RTC.Time(0,0), RTC.Acceleration3D(0,0,0)) if hasattr(RTC, "TimedAcceleration3D") else None
        self._pt = RTC.PanTiltAngles(RTC.Time(0,0), 0.0, 0.0)
        self._bt = RTC.TimedState(RTC.Time(0,0), 0)
        self._path = RTC.Path2D(RTC.Time(0,0), [])
        self._grid = OpenRTM_aist.instantiateDataType(RTC.OGMap)
        self._bump = RTC.IntensityData(RTC.Time(0,0), [], rg, rc)
        self._map = RTC.TimedRGBColour(RTC.Time(0,0), RTC.RGBColour(0,0,0))
        self._gps = OpenRTM_aist.instantiateDataType(RTC.GPSData)
        self._mul = OpenRTM_aist.instantiateDataType(RTC.MulticameraImages) if hasattr(RTC, "MulticameraImages") else OpenRTM_aist.instantiateDataType(RTC.MultiCameraImages)
        self._wp = RTC.Waypoint2D(RTC.Pose2D(RTC.Point2D(0,0),0), 0.0, 0.0, RTC.Time(0,0), RTC.Velocity2D(0,0,0))
        return RTC.RTC_OK
    def onExecute(self, ec_id):
        OpenRTM_aist.setTimestamp(self._d)
        self._d.tm.sec = int(time.time())
        r = self._o.write()
        t = OpenRTM_aist.Time()
        tv = t.getTime()
        if not hasattr(self, "said"): self.said = print("OK Values", r, t.sec, tv.tv_sec if hasattr(tv, "tv_sec") else tv.sec(), OpenRTM_aist.ClockManager.instance().getClock("system").gettime().sec())
        return RTC.RTC_OK

def ValuesInit(manager):
    manager.registerFactory(OpenRTM_aist.Properties(defaults_str=values_spec), Values, OpenRTM_aist.Delete)

def MyModuleInit(manager):
    ValuesInit(manager)
    manager.createComponent("Values")

def main():
    mgr = OpenRTM_aist.Manager.init(sys.argv)
    mgr.setModuleInitProc(MyModuleInit)
    mgr.activateManager()
    mgr.runManager()

if __name__ == "__main__":
    main()
