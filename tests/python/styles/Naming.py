#!/usr/bin/env python
# -*- coding: utf-8 -*-
# -*- Python -*-
import sys
import omniORB
from omniORB import CORBA, PortableServer, any, URI
import omniORB.URI
import CosNaming
import RTC, OpenRTM, OpenRTM_aist, SDOPackage
import RTM, RTC__POA, OpenRTM__POA
def orb_uri():
    orb = CORBA.ORB_init(sys.argv, CORBA.ORB_ID)
    poa = orb.resolve_initial_references("RootPOA")
    poa._get_the_POAManager().activate()
    return orb is not None

naming_spec = ["implementation_id", "Naming", "type_name", "Naming", "description", "a style", "version", "1.0.0", "vendor", "rtm-sim",
            "category", "test", "activity_type", "STATIC", "max_instance", "1", "language", "Python", "lang_type", "SCRIPT", "conf.default.a", "1",
            ""]

class Naming(OpenRTM_aist.DataFlowComponentBase):
    def onInitialize(self):
        n = CosNaming.NameComponent("a", "b")
        orb = self._manager.getORB()
        self.naming = OpenRTM_aist.CorbaNaming(orb, self._manager.getConfig().getProperty("corba.nameservers"))
        return RTC.RTC_OK
    def onExecute(self, ec_id):
        if not hasattr(self, "said"):
            obj = self.naming.resolve("Naming0.rtc")
            rt = obj._narrow(RTC.RTObject)
            bl = []; bi = [None]
            c = OpenRTM_aist.CorbaConsumer()
            c.setObject(obj)
            root = self.naming.getRootContext()
            lst, it = root.list(10)
            for b in lst: print(b.binding_name[0].id, b.binding_type == CosNaming.nobject, b.binding_type == CosNaming.ncontext)
            try:
                self.naming.resolve("nope.rtc")
            except CosNaming.NamingContext.NotFound as e:
                print("nf", e.why)
            try:
                rt._narrow(RTC.DataFlowComponent)
            except CORBA.Exception: raise
            con = OpenRTM_aist.CorbaConsumer(interfaceType=OpenRTM.DataFlowComponent)
            con.setObject(obj)
            rtc = con.getObject()
            ec = OpenRTM_aist.CorbaConsumer(interfaceType=RTC.ExecutionContextService if hasattr(RTC, "ExecutionContextService") else OpenRTM.ExtTrigExecutionContextService)
            ecs = rtc.get_owned_contexts()
            con._ptr().get_component_profile()
            print(orb_uri(), con._ptr()._non_existent(), URI.nameToString([CosNaming.NameComponent("x","y")]), URI.stringToName("x.y"))
            conf = rt.get_configuration()
            cs = conf.get_configuration_sets()
            cs[0].configuration_data
            conf.set_configuration_set_values(cs[0])
            conf.activate_configuration_set("default")
            self.said = print("OK Naming", rt.get_component_profile().instance_name)
        return RTC.RTC_OK

def NamingInit(manager):
    manager.registerFactory(OpenRTM_aist.Properties(defaults_str=naming_spec), Naming, OpenRTM_aist.Delete)

def MyModuleInit(manager):
    NamingInit(manager)
    manager.createComponent("Naming")

def main():
    mgr = OpenRTM_aist.Manager.init(sys.argv)
    mgr.setModuleInitProc(MyModuleInit)
    mgr.activateManager()
    mgr.runManager()

if __name__ == "__main__":
    main()
