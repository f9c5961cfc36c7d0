#!/usr/bin/env python
# -*- coding: utf-8 -*-
# -*- Python -*-
import sys
import time
sys.path.append(".")
import RTC
import OpenRTM_aist
from omniORB import CORBA, PortableServer
import _GlobalIDL, _GlobalIDL__POA
from Greet_idl_example import *

globalstubs_spec = ["implementation_id", "GlobalStubs", "type_name", "GlobalStubs", "description", "a style", "version", "1.0.0", "vendor", "rtm-sim",
            "category", "test", "activity_type", "STATIC", "max_instance", "1", "language", "Python", "lang_type", "SCRIPT",
            ""]

class GlobalStubs(OpenRTM_aist.DataFlowComponentBase):
    def __init__(self, manager):
        OpenRTM_aist.DataFlowComponentBase.__init__(self, manager)
        """
        """
        self._svcPort = OpenRTM_aist.CorbaPort("svc")
        self._reqPort = OpenRTM_aist.CorbaPort("req")
        self._svc = Greet_i()
        self._req = OpenRTM_aist.CorbaConsumer(interfaceType=_GlobalIDL.Greet)
    def onInitialize(self):
        # Set service provider to Ports
        self._svcPort.registerProvider("svc", "Greet", self._svc)
        # Set service consumers to Ports
        self._reqPort.registerConsumer("svc", "Greet", self._req)
        self.addPort(self._svcPort)
        self.addPort(self._reqPort)
        return RTC.RTC_OK
    def onExecute(self, ec_id):
        if self._req._ptr():
            try:
                x = self._req._ptr().hello("x", _GlobalIDL.Mood(1, "happy"))
                if not hasattr(self, "said"): self.said = print("OK GlobalStubs", x)
            except CORBA.SystemException as e:
                print(e)
        elif not hasattr(self, "con"):
            self.con = 1
            ref = self.getObjRef()
            ports = ref.get_ports()
            prof = RTC.ConnectorProfile("c", "", [ports[0], ports[1]], [])
            print(ports[0].connect(prof))
        return RTC.RTC_OK

def GlobalStubsInit(manager):
    manager.registerFactory(OpenRTM_aist.Properties(defaults_str=globalstubs_spec), GlobalStubs, OpenRTM_aist.Delete)

def MyModuleInit(manager):
    GlobalStubsInit(manager)
    manager.createComponent("GlobalStubs")

def main():
    mgr = OpenRTM_aist.Manager.init(sys.argv)
    mgr.setModuleInitProc(MyModuleInit)
    mgr.activateManager()
    mgr.runManager()

if __name__ == "__main__":
    main()
