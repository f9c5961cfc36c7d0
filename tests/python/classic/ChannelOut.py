#!/usr/bin/env python3
"""Sends numbers by three CSP ports, by the one that can."""
import sys
import time

import OpenRTM_aist
import RTC

channelout_spec = ["implementation_id", "ChannelOut", "type_name", "ChannelOut", "description", "a test", "version", "1.0", "vendor", "rtm-sim", "category", "test",
    "activity_type", "DataFlowComponent", "max_instance", "10", "language", "Python", "lang_type", "script",
    ""]


class ChannelOut(OpenRTM_aist.DataFlowComponentBase):
    def onInitialize(self):
        self._cspmanager = OpenRTM_aist.CSPManager()
        self._data = [RTC.TimedLong(RTC.Time(0, 0), 0) for _ in range(3)]
        self._outs = []
        for number in range(3):
            self._outs.append(OpenRTM_aist.CSPOutPort("out%d" % (number + 1), self._data[number], self._cspmanager))
            self.addOutPort("out%d" % (number + 1), self._outs[number])
        self._count = 0
        return RTC.RTC_OK

    def onExecute(self, ec_id):
        if self._count == 20:
            return RTC.RTC_OK
        for data in self._data:
            data.data = self._count
        found, outport, inport = self._cspmanager.select(2)
        if found and outport:
            outport.writeData()
            print("sent", self._count, outport.name(), flush=True)
            self._count += 1
        return RTC.RTC_OK


def ChannelOutInit(manager):
    manager.registerFactory(OpenRTM_aist.Properties(defaults_str=channelout_spec), ChannelOut, OpenRTM_aist.Delete)


def MyModuleInit(manager):
    ChannelOutInit(manager)
    manager.createComponent("ChannelOut")


if __name__ == "__main__":
    mgr = OpenRTM_aist.Manager.init(sys.argv)
    mgr.setModuleInitProc(MyModuleInit)
    mgr.activateManager()
    mgr.runManager()
