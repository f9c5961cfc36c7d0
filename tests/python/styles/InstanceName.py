#!/usr/bin/env python
# -*- coding: utf-8 -*-
# -*- Python -*-
import sys
import time
import RTC
import OpenRTM_aist

instancename_spec = ["implementation_id", "InstanceName", "type_name", "InstanceName", "description", "a style", "version", "1.0.0", "vendor", "rtm-sim",
            "category", "test", "activity_type", "STATIC", "max_instance", "1", "language", "Python", "lang_type", "SCRIPT", "conf.default.param", "0,1",
"conf.__widget__.param", "text", "conf.__type__.param", "string",
            ""]

class InstanceName(OpenRTM_aist.DataFlowComponentBase):
    def __init__(self, manager):
        OpenRTM_aist.DataFlowComponentBase.__init__(self, manager)

        self._d_in = OpenRTM_aist.instantiateDataType(RTC.TimedVelocity2D)
        self._inIn = OpenRTM_aist.InPort("in", self._d_in)
        self._d_pose = RTC.TimedPose2D(RTC.Time(0,0), RTC.Pose2D(RTC.Point2D(0.0,0.0),0.0))
        self._poseOut = OpenRTM_aist.OutPort("pose", self._d_pose)
        self._param = ['0,1']
    def onInitialize(self):
        self.bindParameter("param", self._param, "0,1")
        self.addInPort("in",self._inIn)
        self.addOutPort("pose",self._poseOut)
        return RTC.RTC_OK
    def onFinalize(self):
        return RTC.RTC_OK
    def onStartup(self, ec_id):
        return RTC.RTC_OK
    def onShutdown(self, ec_id):
        return RTC.RTC_OK
    def onActivated(self, ec_id):
        print("OK InstanceName", self.getInstanceName(), self._param)
        return RTC.RTC_OK
    def onDeactivated(self, ec_id):
        return RTC.RTC_OK
    def onExecute(self, ec_id):
        if self._inIn.isNew():
            v = self._inIn.read()
            self._d_pose.data.position.x += v.data.vx
        self._d_pose.tm = RTC.Time(0,0)
        self._poseOut.write()
        return RTC.RTC_OK

def InstanceNameInit(manager):
    profile = OpenRTM_aist.Properties(defaults_str=instancename_spec)
    manager.registerFactory(profile, InstanceName, OpenRTM_aist.Delete)

def MyModuleInit(manager):
    InstanceNameInit(manager)

    # create instance_name option for createComponent()
    instance_name = [i for i in sys.argv if "--instance_name=" in i]
    if instance_name:
        args = instance_name[0].replace("--", "?")
    else:
        args = ""

    # Create a component
    comp = manager.createComponent("InstanceName" + args)

def main():
    # remove --instance_name= option
    argv = [i for i in sys.argv if not "--instance_name=" in i]
    # Initialize manager
    mgr = OpenRTM_aist.Manager.init(sys.argv)
    mgr.setModuleInitProc(MyModuleInit)
    mgr.activateManager()
    mgr.runManager()

if __name__ == "__main__":
    main()
