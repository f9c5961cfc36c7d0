#!/usr/bin/env python
# -*- coding: utf-8 -*-
# -*- Python -*-
import sys
import time
import RTC
import OpenRTM_aist

leaver_spec = ["implementation_id", "Leaver", "type_name", "Leaver", "description", "a style", "version", "1.0.0", "vendor", "rtm-sim",
            "category", "test", "activity_type", "STATIC", "max_instance", "1", "language", "Python", "lang_type", "SCRIPT",
            ""]

class Leaver(OpenRTM_aist.DataFlowComponentBase):
    def onInitialize(self):
        return RTC.RTC_OK
    def onActivated(self, ec_id):
        print("OK Leaver", flush=True)
        async_ = OpenRTM_aist.Async_tInvoker(self, Leaver.bye, 1)
        async_.invoke()
        return RTC.RTC_OK
    def bye(self, n):
        time.sleep(0.1)
        self.exit()
    def onExecute(self, ec_id):
        return RTC.RTC_OK

def LeaverInit(manager):
    manager.registerFactory(OpenRTM_aist.Properties(defaults_str=leaver_spec), Leaver, OpenRTM_aist.Delete)

def MyModuleInit(manager):
    LeaverInit(manager)
    manager.createComponent("Leaver")

def main():
    mgr = OpenRTM_aist.Manager.init(sys.argv)
    mgr.setModuleInitProc(MyModuleInit)
    mgr.activateManager()
    mgr.runManager()

if __name__ == "__main__":
    main()
