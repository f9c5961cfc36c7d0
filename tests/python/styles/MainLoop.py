#!/usr/bin/env python
# -*- coding: utf-8 -*-
# -*- Python -*-
import sys, time
import RTC, OpenRTM_aist

mainloop_spec = ["implementation_id", "MainLoop", "type_name", "MainLoop", "description", "a style", "version", "1.0.0", "vendor", "rtm-sim",
            "category", "test", "activity_type", "STATIC", "max_instance", "1", "language", "Python", "lang_type", "SCRIPT",
            ""]

class MainLoop(OpenRTM_aist.DataFlowComponentBase):
    def onInitialize(self): return RTC.RTC_OK
    def onExecute(self, ec_id):
        self.x = 3
        return RTC.RTC_OK

def MainLoopInit(manager):
    profile = OpenRTM_aist.Properties(defaults_str=mainloop_spec)
    manager.registerFactory(profile, MainLoop, OpenRTM_aist.Delete)
def main():
    mgr = OpenRTM_aist.Manager.init(sys.argv)
    mgr.activateManager()
    MainLoopInit(mgr)
    comp = mgr.createComponent("MainLoop")
    mgr.runManager(True)
    comp2 = mgr.getComponent("MainLoop0")
    while not hasattr(comp2, "x"): time.sleep(0.01)
    print("OK MainLoop", mgr.getComponents(), comp is comp2)
    sys.stdout.flush()
    while True:
        time.sleep(0.1)
if __name__ == "__main__": main()
