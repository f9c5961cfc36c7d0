#!/usr/bin/env python3
"""A part of a composite: sends the sum of what it receives and one."""
import sys
import time

import OpenRTM_aist
import RTC

sensing_spec = ["implementation_id", "Sensing", "type_name", "Sensing", "description", "a test", "version", "1.0", "vendor", "rtm-sim", "category", "test",
    "activity_type", "DataFlowComponent", "max_instance", "10", "language", "Python", "lang_type", "script",
    ""]


class Sensing(OpenRTM_aist.DataFlowComponentBase):
    def onInitialize(self):
        self._d_in = RTC.TimedLong(RTC.Time(0, 0), 0)
        self._in = OpenRTM_aist.InPort("in", self._d_in)
        self.addInPort("in", self._in)
        self._d_out = RTC.TimedLong(RTC.Time(0, 0), 0)
        self._out = OpenRTM_aist.OutPort("out", self._d_out)
        self.addOutPort("out", self._out)
        self._gain = [1]
        self.bindParameter("gain", self._gain, "1")
        return RTC.RTC_OK

    def onExecute(self, ec_id):
        if self._in.isNew():
            self._d_in = self._in.read()
            self._d_out.data = self._d_in.data + self._gain[0]
            self._out.write()
            print(self.getInstanceName(), self._d_out.data, flush=True)
        return RTC.RTC_OK


def SensingInit(manager):
    manager.registerFactory(OpenRTM_aist.Properties(defaults_str=sensing_spec), Sensing, OpenRTM_aist.Delete)


def MyModuleInit(manager):
    SensingInit(manager)
    manager.createComponent("Sensing")


if __name__ == "__main__":
    mgr = OpenRTM_aist.Manager.init(sys.argv)
    mgr.setModuleInitProc(MyModuleInit)
    mgr.activateManager()
    mgr.runManager()
