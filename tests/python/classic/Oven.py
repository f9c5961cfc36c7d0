#!/usr/bin/env python3
"""A state machine whose events come by a port, as EventPort.EventInPort binds them."""
import sys

import RTC
import OpenRTM_aist
import OpenRTM_aist.StaticFSM as StaticFSM
import OpenRTM_aist.EventPort as EventPort
import OvenStates

oven_spec = ["implementation_id", "Oven", "type_name", "Oven", "description", "states", "version", "1.0", "vendor", "rtm-sim",
             "category", "test", "activity_type", "DataFlowComponent", "max_instance", "10", "language", "Python",
             "lang_type", "script", ""]


class Oven(OpenRTM_aist.DataFlowComponentBase):
    def __init__(self, manager):
        OpenRTM_aist.DataFlowComponentBase.__init__(self, manager)

    def onInitialize(self):
        self._fsm = StaticFSM.Machine(OvenStates.TOP, self)
        self._eventIn = EventPort.EventInPort("event", self._fsm)
        self.addInPort("event", self._eventIn)
        self._eventIn.bindEvent1("heat", OvenStates.TOP.heat, RTC.TimedLong(RTC.Time(0, 0), 0))
        self._eventIn.bindEvent0("door", OvenStates.TOP.door)
        self._eventIn.bindEvent0("tick", OvenStates.TOP.tick)
        return RTC.RTC_OK

    def onFinalize(self):
        self._fsm.shutdown()
        return RTC.RTC_OK

    def onExecute(self, ec_id):
        self._fsm.run_event()
        return RTC.RTC_OK


def OvenInit(manager):
    manager.registerFactory(OpenRTM_aist.Properties(defaults_str=oven_spec), Oven, OpenRTM_aist.Delete)


def MyModuleInit(manager):
    OvenInit(manager)
    manager.createComponent("Oven")


def main():
    mgr = OpenRTM_aist.Manager.init(sys.argv)
    mgr.setModuleInitProc(MyModuleInit)
    mgr.activateManager()
    mgr.runManager()


if __name__ == "__main__":
    main()
