#!/usr/bin/env python3
"""Prints the doubles that it receives."""
import sys
import time

import OpenRTM_aist
import RTC

doublesink_spec = ["implementation_id", "DoubleSink", "type_name", "DoubleSink", "description", "a test", "version", "1.0", "vendor", "rtm-sim", "category", "test",
    "activity_type", "DataFlowComponent", "max_instance", "10", "language", "Python", "lang_type", "script",
    ""]


class DoubleSink(OpenRTM_aist.DataFlowComponentBase):
    def onInitialize(self):
        self._data = RTC.TimedDouble(RTC.Time(0, 0), 0.0)
        self._inport = OpenRTM_aist.InPort("in", self._data)
        self.addInPort("in", self._inport)
        return RTC.RTC_OK

    def onExecute(self, ec_id):
        if self._inport.isNew():
            data = self._inport.read()
            print("received", repr(data.data), data.tm.sec > 0, flush=True)
        return RTC.RTC_OK


def DoubleSinkInit(manager):
    manager.registerFactory(OpenRTM_aist.Properties(defaults_str=doublesink_spec), DoubleSink, OpenRTM_aist.Delete)


def MyModuleInit(manager):
    DoubleSinkInit(manager)
    manager.createComponent("DoubleSink")


if __name__ == "__main__":
    mgr = OpenRTM_aist.Manager.init(sys.argv)
    mgr.setModuleInitProc(MyModuleInit)
    mgr.activateManager()
    mgr.runManager()
