#!/usr/bin/env python
# -*- coding: utf-8 -*-
# -*- Python -*-
import sys
import RTC, OpenRTM_aist
import OpenRTM_aist.StaticFSM
from OpenRTM_aist import StaticFSM, EventPort
import OpenRTM_aist.EventPort

@StaticFSM.FSM_TOPSTATE
class Top(StaticFSM.Link):
    def go(self): pass
    def set(self, d): pass
    def onInit(self):
        self.set_state(StaticFSM.State(Idle))
        return RTC.RTC_OK
    class Data:
        def __init__(self): self.x = 1
@StaticFSM.FSM_SUBSTATE(Top)
class Idle(StaticFSM.Link):
    def onEntry(self): print("idle"); return RTC.RTC_OK
    def onExit(self): return RTC.RTC_OK
    def go(self): self.set_state(StaticFSM.State(Run))
@StaticFSM.FSM_SUBSTATE(Top)
class Run(StaticFSM.Link):
    pass

events_spec = ["implementation_id", "Events", "type_name", "Events", "description", "a style", "version", "1.0.0", "vendor", "rtm-sim",
            "category", "test", "activity_type", "STATIC", "max_instance", "1", "language", "Python", "lang_type", "SCRIPT",
            ""]

class Events(OpenRTM_aist.DataFlowComponentBase):
    def onInitialize(self):
        self._fsm = OpenRTM_aist.StaticFSM.Machine(Top, self)
        self._in = EventPort.EventInPort("event", self._fsm)
        self._in.bindEvent0("go", Top.go)
        self._in.bindEvent1("set", Top.set, RTC.TimedLong(RTC.Time(0,0),0))
        self.addInPort("event", self._in)
        return RTC.RTC_OK
    def onExecute(self, ec_id):
        self._fsm.run_event()
        if not hasattr(self, "said"): self.said = print("OK Events")
        return RTC.RTC_OK

def EventsInit(manager):
    manager.registerFactory(OpenRTM_aist.Properties(defaults_str=events_spec), Events, OpenRTM_aist.Delete)

def MyModuleInit(manager):
    EventsInit(manager)
    manager.createComponent("Events")

def main():
    mgr = OpenRTM_aist.Manager.init(sys.argv)
    mgr.setModuleInitProc(MyModuleInit)
    mgr.activateManager()
    mgr.runManager()

if __name__ == "__main__":
    main()
