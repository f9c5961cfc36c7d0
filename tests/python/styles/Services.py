#!/usr/bin/env python
# -*- coding: utf-8 -*-
# -*- Python -*-
import sys, time
import RTC, OpenRTM_aist
import Lab_idl
# Import Service stub modules
import Lab, Lab__POA
class ArmI(Lab__POA.Arm):
    def __init__(self, comp): self._comp = comp; self._speed = 0.0; self._servant = 1
    def move(self, joints, how):
        if not joints: raise Lab.Refused("empty")
        return len(joints), how
    def _get_speed(self): return self._speed
    def _set_speed(self, v): self._speed = v
    def state(self): return Lab.Status(1, [Lab.Joint(0.5, "a")])
    def pose(self): return [[1.0] * 4] * 3
    def stop(self): pass

services_spec = ["implementation_id", "Services", "type_name", "Services", "description", "a style", "version", "1.0.0", "vendor", "rtm-sim",
            "category", "test", "activity_type", "STATIC", "max_instance", "1", "language", "Python", "lang_type", "SCRIPT",
            ""]

class Services(OpenRTM_aist.DataFlowComponentBase):
    def __init__(self, manager):
        OpenRTM_aist.DataFlowComponentBase.__init__(self, manager)
        self._aPort = OpenRTM_aist.CorbaPort("a")
        self._bPort = OpenRTM_aist.CorbaPort("b")
        self._arm = ArmI(self)
        self._con = OpenRTM_aist.CorbaConsumer(interfaceType=Lab.Arm)
    def onInitialize(self):
        self._aPort.registerProvider("arm", "Lab::Arm", self._arm)
        self._bPort.registerConsumer("arm", "Lab::Arm", self._con)
        self.addPort(self._aPort); self.addPort(self._bPort)
        return RTC.RTC_OK
    def onActivated(self, ec_id):
        OpenRTM_aist.connect("x", OpenRTM_aist.Properties(), self._aPort.getPortRef(), self._bPort.getPortRef())
        return RTC.RTC_OK
    def onExecute(self, ec_id):
        if hasattr(self, "said"): return RTC.RTC_OK
        a = self._con._ptr()
        ref = self._con.getObject()
        r = [a.move([1.0, 2.0], Lab.FAST), ref.move([1.0, 2.0], Lab.FAST), ref.move(range(3), Lab.SLOW)]
        try:
            ref.move([], Lab.FAST)
        except Lab.Refused as e:
            r.append((e.why, str(e)))
        ref._set_speed(3.5); r.append(ref._get_speed()); ref.speed = 4.0; r.append(ref.speed)
        r.append(ref.state()); r.append(ref.pose()); r.append(Lab.MAX)
        ref.stop()
        self.said = print("OK Services", r)
        return RTC.RTC_OK

def ServicesInit(manager):
    manager.registerFactory(OpenRTM_aist.Properties(defaults_str=services_spec), Services, OpenRTM_aist.Delete)

def MyModuleInit(manager):
    ServicesInit(manager)
    manager.createComponent("Services")

def main():
    mgr = OpenRTM_aist.Manager.init(sys.argv)
    mgr.setModuleInitProc(MyModuleInit)
    mgr.activateManager()
    mgr.runManager()

if __name__ == "__main__":
    main()
