#!/usr/bin/env python
# -*- coding: utf-8 -*-
# -*- Python -*-
import sys
import time
import RTC
import OpenRTM_aist

whole_spec = ["implementation_id", "Whole", "type_name", "Whole", "description", "a style", "version", "1.0.0", "vendor", "rtm-sim",
            "category", "test", "activity_type", "STATIC", "max_instance", "1", "language", "Python", "lang_type", "SCRIPT", "conf.default.members", "Inherited0",
"conf.default.exported_ports", "Inherited0.out",
            ""]

class Whole(OpenRTM_aist.PeriodicECSharedComposite):
    def __init__(self, manager):
        OpenRTM_aist.PeriodicECSharedComposite.__init__(self, manager)
    def onInitialize(self):
        r = OpenRTM_aist.PeriodicECSharedComposite.onInitialize(self)
        return r
    def onActivated(self, ec_id):
        print("OK Whole", self._members, [p.get_port_profile().name for p in self.get_ports()])
        return OpenRTM_aist.PeriodicECSharedComposite.onActivated(self, ec_id)

import Inherited
def WholeInit(manager):
    Inherited.InheritedInit(manager)
    manager.createComponent("Inherited")
    manager.registerFactory(OpenRTM_aist.Properties(defaults_str=whole_spec), Whole, OpenRTM_aist.Delete)
def MyModuleInit(manager):
    WholeInit(manager)
    manager.createComponent("Whole")
def main():
    mgr = OpenRTM_aist.Manager.init(sys.argv)
    mgr.setModuleInitProc(MyModuleInit)
    mgr.activateManager()
    mgr.runManager()
if __name__ == "__main__": main()
