#!/usr/bin/env python
# -*- coding: utf-8 -*-
# -*- Python -*-
import sys
import RTC, OpenRTM_aist
from InheritedBase import InheritedBase

inherited_spec = ["implementation_id", "Inherited", "type_name", "Inherited", "description", "a style", "version", "1.0.0", "vendor", "rtm-sim",
            "category", "test", "activity_type", "STATIC", "max_instance", "1", "language", "Python", "lang_type", "SCRIPT",
            ""]

class Inherited(InheritedBase):
    def __init__(self, manager):
        InheritedBase.__init__(self, manager)
    def onInitialize(self):
        return InheritedBase.onInitialize(self)
    def onActivated(self, ec_id):
        return OpenRTM_aist.DataFlowComponentBase.onActivated(self, ec_id)
    def onExecute(self, ec_id):
        self.out.write()
        if not hasattr(self, "said"): self.said = print("OK Inherited")
        return super(Inherited, self).onExecute(ec_id)

def InheritedInit(manager):
    manager.registerFactory(OpenRTM_aist.Properties(defaults_str=inherited_spec), Inherited, OpenRTM_aist.Delete)

def MyModuleInit(manager):
    InheritedInit(manager)
    manager.createComponent("Inherited")

def main():
    mgr = OpenRTM_aist.Manager.init(sys.argv)
    mgr.setModuleInitProc(MyModuleInit)
    mgr.activateManager()
    mgr.runManager()

if __name__ == "__main__":
    main()
