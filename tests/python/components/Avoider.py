#!/usr/bin/env python3
"""Drives ahead, and turns where the laser sees something near."""
import random
import sys

import OpenRTM_aist
import RTC

avoider_spec = ["implementation_id", "Avoider",
                "type_name", "Avoider",
                "description", "Drives around obstacles",
                "version", "1.0.0",
                "vendor", "rtm-sim",
                "category", "navigation",
                "activity_type", "PERIODIC",
                "max_instance", "0",
                "language", "Python",
                "lang_type", "script",
                "conf.default.speed", "0.3",
                ""]


class Avoider(OpenRTM_aist.DataFlowComponentBase):
    def __init__(self, manager):
        OpenRTM_aist.DataFlowComponentBase.__init__(self, manager)

    def onInitialize(self):
        self._d_range = OpenRTM_aist.instantiateDataType(RTC.RangeData)
        self._rangeIn = OpenRTM_aist.InPort("range", self._d_range)
        self.addInPort("range", self._rangeIn)
        self._d_velocity = RTC.TimedVelocity2D(RTC.Time(0, 0), RTC.Velocity2D(0.0, 0.0, 0.0))
        self._velocityOut = OpenRTM_aist.OutPort("velocity", self._d_velocity)
        self.addOutPort("velocity", self._velocityOut)
        self._speed = [0.3]
        self.bindParameter("speed", self._speed, "0.3")
        return RTC.RTC_OK

    def onActivated(self, ec_id):
        # The order of a set of texts depends on the hash seed of the process.
        self._turns = [1.0 if name < "m" else -1.0 for name in {"left", "right", "back", "none"}]
        self._random = random.Random(1)
        return RTC.RTC_OK

    def onExecute(self, ec_id):
        if self._rangeIn.isNew():
            ranges = self._rangeIn.read().ranges
            ahead = min(ranges[len(ranges) // 3:2 * len(ranges) // 3])
            velocity = self._d_velocity.data
            velocity.vx = self._speed[0] if ahead > 0.6 else 0.0
            velocity.va = 0.0 if ahead > 0.6 else self._random.choice(self._turns)
            OpenRTM_aist.setTimestamp(self._d_velocity)
            self._velocityOut.write()
        return RTC.RTC_OK


def AvoiderInit(manager):
    manager.registerFactory(OpenRTM_aist.Properties(defaults_str=avoider_spec), Avoider, OpenRTM_aist.Delete)


def MyModuleInit(manager):
    AvoiderInit(manager)
    manager.createComponent("Avoider")


if __name__ == "__main__":
    mgr = OpenRTM_aist.Manager.init(sys.argv)
    mgr.setModuleInitProc(MyModuleInit)
    mgr.activateManager()
    mgr.runManager()
