#!/usr/bin/env python
# -*- coding: utf-8 -*-
# -*- Python -*-
import sys
import time
import RTC
import OpenRTM_aist

baremain_spec = ["implementation_id", "BareMain", "type_name", "BareMain", "description", "a style", "version", "1.0.0", "vendor", "rtm-sim",
            "category", "test", "activity_type", "STATIC", "max_instance", "1", "language", "Python", "lang_type", "SCRIPT",
            ""]

class BareMain(OpenRTM_aist.DataFlowComponentBase):
    def onInitialize(self): return RTC.RTC_OK
    def onActivated(self, ec_id):
        print("OK BareMain")
        return RTC.RTC_OK

def BareMainInit(manager):
    manager.registerFactory(OpenRTM_aist.Properties(defaults_str=baremain_spec), BareMain, OpenRTM_aist.Delete)

def MyModuleInit(manager):
    BareMainInit(manager)
    manager.createComponent("BareMain")

def main():
    mgr = OpenRTM_aist.Manager.init(sys.argv)
    mgr.setModuleInitProc(MyModuleInit)
    mgr.activateManager()
    mgr.runManager()

main()
