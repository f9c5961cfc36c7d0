#!/usr/bin/env python
# -*- coding: utf-8 -*-
# -*- Python -*-
import sys
import time
import RTC
import OpenRTM_aist

nested_spec = ["implementation_id", "Nested", "type_name", "Nested", "description", "a style", "version", "1.0.0", "vendor", "rtm-sim",
            "category", "test", "activity_type", "STATIC", "max_instance", "1", "language", "Python", "lang_type", "SCRIPT",
            ""]

class Nested(OpenRTM_aist.DataFlowComponentBase):
    def onInitialize(self): return RTC.RTC_OK
    def onActivated(self, ec_id):
        mgr = OpenRTM_aist.Manager.instance()
        print(mgr.load("Template10.py", "Template10Init"))
        comp = mgr.createComponent("Template10?instance_name=child")
        print(comp.getInstanceName(), [c.getInstanceName() for c in mgr.getComponents()], mgr.getComponent("child") is comp, mgr.getComponent("nobody"))
        print([p.getProperty("implementation_id") for p in mgr.getFactoryProfiles()][-2:], len(mgr.getLoadedModules()))
        comp.getObjRef().get_owned_contexts()[0].activate_component(comp.getObjRef())
        print("OK Nested", mgr.createComponent("Nobody"))
        return RTC.RTC_OK

def NestedInit(manager):
    manager.registerFactory(OpenRTM_aist.Properties(defaults_str=nested_spec), Nested, OpenRTM_aist.Delete)

def MyModuleInit(manager):
    NestedInit(manager)
    manager.createComponent("Nested")

def main():
    mgr = OpenRTM_aist.Manager.init(sys.argv)
    mgr.setModuleInitProc(MyModuleInit)
    mgr.activateManager()
    mgr.runManager()

if __name__ == "__main__":
    main()
