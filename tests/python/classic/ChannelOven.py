#!/usr/bin/env python3
"""The same over a CSP port, with a manager of channels."""
import sys

import RTC
import OpenRTM_aist
import OpenRTM_aist.CSPMachine as CSPMachine
import OpenRTM_aist.CSPEventPort as CSPEventPort
import OvenStates

channeloven_spec = ["implementation_id", "ChannelOven", "type_name", "ChannelOven", "description", "states", "version", "1.0", "vendor", "rtm-sim",
             "category", "test", "activity_type", "DataFlowComponent", "max_instance", "10", "language", "Python",
             "lang_type", "script", ""]


class ChannelOven(OpenRTM_aist.DataFlowComponentBase):
    def __init__(self, manager):
        OpenRTM_aist.DataFlowComponentBase.__init__(self, manager)

    def onInitialize(self):
        self._fsm = CSPMachine.CSPMachine(OvenStates.TOP, self)
        self._cspmanager = OpenRTM_aist.CSPManager()
        self._eventIn = CSPEventPort.CSPEventPort("event", self._fsm, self._cspmanager)
        self.addInPort("event", self._eventIn)
        self._eventIn.bindEvent1("heat", OvenStates.TOP.heat, RTC.TimedLong(RTC.Time(0, 0), 0))
        self._eventIn.bindEvent0("door", OvenStates.TOP.door)
        self._eventIn.bindEvent0("tick", OvenStates.TOP.tick)
        return RTC.RTC_OK

    def onFinalize(self):
        self._fsm.shutdown()
        return RTC.RTC_OK

    def onExecute(self, ec_id):
        found, outport, inport = self._cspmanager.select(0.2)
        if found and inport:
            event = inport.readData()
            event()
        return RTC.RTC_OK


def ChannelOvenInit(manager):
    manager.registerFactory(OpenRTM_aist.Properties(defaults_str=channeloven_spec), ChannelOven, OpenRTM_aist.Delete)


def MyModuleInit(manager):
    ChannelOvenInit(manager)
    manager.createComponent("ChannelOven")


def main():
    mgr = OpenRTM_aist.Manager.init(sys.argv)
    mgr.setModuleInitProc(MyModuleInit)
    mgr.activateManager()
    mgr.runManager()


if __name__ == "__main__":
    main()
