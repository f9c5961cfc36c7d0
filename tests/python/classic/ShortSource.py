#!/usr/bin/env python3
"""Reads numbers from standard input and sends them as shorts."""
import sys
import time

import OpenRTM_aist
import RTC

shortsource_spec = ["implementation_id", "ShortSource", "type_name", "ShortSource", "description", "a test", "version", "1.0", "vendor", "rtm-sim", "category", "test",
    "activity_type", "DataFlowComponent", "max_instance", "10", "language", "Python", "lang_type", "script",
    ""]


class ShortSource(OpenRTM_aist.DataFlowComponentBase):
    def onInitialize(self):
        self._data = RTC.TimedShort(RTC.Time(0, 0), 0)
        self._outport = OpenRTM_aist.OutPort("out", self._data)
        self.addOutPort("out", self._outport)
        return RTC.RTC_OK

    def onExecute(self, ec_id):
        self._data.data = int(sys.stdin.readline())
        OpenRTM_aist.setTimestamp(self._data)
        print("written", self._outport.write(), flush=True)
        return RTC.RTC_OK


def ShortSourceInit(manager):
    manager.registerFactory(OpenRTM_aist.Properties(defaults_str=shortsource_spec), ShortSource, OpenRTM_aist.Delete)


def MyModuleInit(manager):
    ShortSourceInit(manager)
    manager.createComponent("ShortSource")


if __name__ == "__main__":
    mgr = OpenRTM_aist.Manager.init(sys.argv)
    mgr.setModuleInitProc(MyModuleInit)
    mgr.activateManager()
    mgr.runManager()
