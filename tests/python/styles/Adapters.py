#!/usr/bin/env python
# -*- coding: utf-8 -*-
# -*- Python -*-
import sys
import RTC, OpenRTM_aist, omniORB
from omniORB import CORBA, PortableServer
import _GlobalIDL
from Greet_idl_example import Greet_i

adapters_spec = ["implementation_id", "Adapters", "type_name", "Adapters", "description", "a style", "version", "1.0.0", "vendor", "rtm-sim",
            "category", "test", "activity_type", "STATIC", "max_instance", "1", "language", "Python", "lang_type", "SCRIPT",
            ""]

class Adapters(OpenRTM_aist.DataFlowComponentBase):
    def onInitialize(self):
        ps = PortableServer
        root = self._manager.getPOA()
        pol = [root.create_lifespan_policy(ps.PERSISTENT), root.create_id_assignment_policy(ps.USER_ID), root.create_implicit_activation_policy(ps.NO_IMPLICIT_ACTIVATION)]
        self.child = root.create_POA("child", root._get_the_POAManager(), pol)
        self.bell = Greet_i()
        self.child.activate_object_with_id("bell", self.bell)
        ref = self.child.id_to_reference("bell")
        print(ref._narrow(_GlobalIDL.Greet).hello("a", _GlobalIDL.Mood(1, "b")), self.bell._this()._is_equivalent(ref), self.child.the_name, self.child._get_the_parent() is root)
        print(self.child.reference_to_servant(ref) is self.bell, self.child.servant_to_id(self.bell))
        for f in (lambda: root.create_POA("child", None, []), lambda: root.find_POA("nobody", False), lambda: self.child.activate_object(Greet_i()), lambda: self.child.deactivate_object("x"), lambda: self.child.activate_object_with_id("bell", Greet_i())):
            try: print("no", f())
            except CORBA.UserException as e: print(type(e).__name__)
        own = root.create_POA("own", None, [])
        s = Greet_i(); own.activate_object(s)
        print(own.the_POAManager.get_state()); own._get_the_POAManager().activate(); print(own.the_POAManager.get_state(), s._this().hello("c", _GlobalIDL.Mood(1, "d")))
        own.destroy(True, True)
        return RTC.RTC_OK
    def onActivated(self, ec_id):
        print("OK Adapters", omniORB.TRANSIENT_ConnectFailed == omniORB.minorCodes.TRANSIENT_ConnectFailed, hex(omniORB.OBJECT_NOT_EXIST_NoMatch))
        return RTC.RTC_OK

def AdaptersInit(manager):
    manager.registerFactory(OpenRTM_aist.Properties(defaults_str=adapters_spec), Adapters, OpenRTM_aist.Delete)

def MyModuleInit(manager):
    AdaptersInit(manager)
    manager.createComponent("Adapters")

def main():
    mgr = OpenRTM_aist.Manager.init(sys.argv)
    mgr.setModuleInitProc(MyModuleInit)
    mgr.activateManager()
    mgr.runManager()

if __name__ == "__main__":
    main()
