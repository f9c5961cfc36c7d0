#!/usr/bin/env python3
"""Receives by three CSP ports, by the one that has a value."""
import sys
import time

import OpenRTM_aist
import RTC

channelin_spec = ["implementation_id", "ChannelIn", "type_name", "ChannelIn", "description", "a test", "version", "1.0", "vendor", "rtm-sim", "category", "test",
    "activity_type", "DataFlowComponent", "max_instance", "10", "language", "Python", "lang_type", "script",
    ""]


class ChannelIn(OpenRTM_aist.DataFlowComponentBase):
    def onInitialize(self):
        self._cspmanager = OpenRTM_aist.CSPManager()
        self._ins = []
        for number in range(3):
            value = RTC.TimedLong(RTC.Time(0, 0), 0)
            self._ins.append(OpenRTM_aist.CSPInPort("in%d" % (number + 1), value, self._cspmanager))
            self.addInPort("in%d" % (number + 1), self._ins[number])
        return RTC.RTC_OK

    def onExecute(self, ec_id):
        found, outport, inport = self._cspmanager.select(2)
        if found and inport:
            print("got", inport.readData().data, inport.name(), flush=True)
        return RTC.RTC_OK


def ChannelInInit(manager):
    manager.registerFactory(OpenRTM_aist.Properties(defaults_str=channelin_spec), ChannelIn, OpenRTM_aist.Delete)


def MyModuleInit(manager):
    ChannelInInit(manager)
    manager.createComponent("ChannelIn" + "".join(word for word in sys.argv if word.startswith("?")))


if __name__ == "__main__":
    mgr = OpenRTM_aist.Manager.init([word for word in sys.argv if not word.startswith("?")])
    mgr.setModuleInitProc(MyModuleInit)
    mgr.activateManager()
    mgr.runManager()
