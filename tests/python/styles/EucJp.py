#!/usr/bin/env python
# -*- coding: euc-jp -*-
# -*- Python -*-
import sys
import time
import RTC
import OpenRTM_aist

eucjp_spec = ["implementation_id", "EucJp", "type_name", "EucJp", "description", "日本", "version", "1.0.0", "vendor", "rtm-sim",
            "category", "test", "activity_type", "STATIC", "max_instance", "1", "language", "Python", "lang_type", "SCRIPT",
            ""]

class EucJp(OpenRTM_aist.DataFlowComponentBase):
    def onInitialize(self):
        print('日本'); self._rtcout.RTC_WARN('日本 %s', '語'); return RTC.RTC_OK
    def onActivated(self, ec_id):
        mgr = OpenRTM_aist.Manager.instance()
        print(mgr.load("Template10.py", "Template10Init"))
        comp = mgr.createComponent("Template10?instance_name=child24")
        print(comp.getInstanceName(), [c.getInstanceName() for c in mgr.getComponents()], mgr.getComponent("child24") is comp, mgr.getComponent("nobody"))
        print([p.getProperty("implementation_id") for p in mgr.getFactoryProfiles()][-2:], len(mgr.getLoadedModules()))
        comp.getObjRef().get_owned_contexts()[0].activate_component(comp.getObjRef())
        print("OK EucJp", mgr.createComponent("Nobody"))
        return RTC.RTC_OK

def EucJpInit(manager):
    manager.registerFactory(OpenRTM_aist.Properties(defaults_str=eucjp_spec), EucJp, OpenRTM_aist.Delete)

def MyModuleInit(manager):
    EucJpInit(manager)
    manager.createComponent("EucJp")

def main():
    mgr = OpenRTM_aist.Manager.init(sys.argv)
    mgr.setModuleInitProc(MyModuleInit)
    mgr.activateManager()
    mgr.runManager()

if __name__ == "__main__":
    main()
