#!/usr/bin/env python3
"""Counts its cycles, and prints the counts that come back."""
import sys
import time

import OpenRTM_aist
import RTC

ticked_spec = ["implementation_id", "Ticked", "type_name", "Ticked", "description", "a test", "version", "1.0", "vendor", "rtm-sim", "category", "test",
    "activity_type", "DataFlowComponent", "max_instance", "10", "language", "Python", "lang_type", "script",
    ""]


class Ticked(OpenRTM_aist.DataFlowComponentBase):
    def onInitialize(self):
        self._data = RTC.TimedLong(RTC.Time(0, 0), 0)
        self._outport = OpenRTM_aist.OutPort("out", self._data)
        self.addOutPort("out", self._outport)
        self._inport = OpenRTM_aist.InPort("in", RTC.TimedLong(RTC.Time(0, 0), 0))
        self.addInPort("in", self._inport)
        return RTC.RTC_OK

    def onExecute(self, ec_id):
        self._data.data += 1
        self._outport.write()
        print("cycle", self._data.data, self._inport.read().data, flush=True)
        return RTC.RTC_OK


def TickedInit(manager):
    manager.registerFactory(OpenRTM_aist.Properties(defaults_str=ticked_spec), Ticked, OpenRTM_aist.Delete)


def MyModuleInit(manager):
    TickedInit(manager)
    manager.createComponent("Ticked")


if __name__ == "__main__":
    mgr = OpenRTM_aist.Manager.init(sys.argv)
    mgr.setModuleInitProc(MyModuleInit)
    mgr.activateManager()
    mgr.runManager()
