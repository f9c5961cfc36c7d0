#!/usr/bin/env python
# -*- coding: utf-8 -*-
# -*- Python -*-
import sys
import RTC, OpenRTM_aist
import Img, JARA_ARM, JARA_ARM__POA

olddefaults_spec = ["implementation_id", "OldDefaults", "type_name", "OldDefaults", "description", "a style", "version", "1.0.0", "vendor", "rtm-sim",
            "category", "test", "activity_type", "STATIC", "max_instance", "1", "language", "Python", "lang_type", "SCRIPT",
            ""]

class OldDefaults(OpenRTM_aist.DataFlowComponentBase):
    def __init__(self, manager):
        OpenRTM_aist.DataFlowComponentBase.__init__(self, manager)
        in_arg = [None] * ((len(RTC._d_TimedLong) - 4) // 2)
        self._d_in = RTC.TimedLong(*in_arg)
        self._inIn = OpenRTM_aist.InPort("in", self._d_in)
        img_arg = [None] * int((len(RTC._d_CameraImage) - 4) / 2)
        self._d_img = RTC.CameraImage(*img_arg)
        self._imgOut = OpenRTM_aist.OutPort("img", self._d_img)
        j = [None] * ((len(Img._d_TimedCameraImage) - 4) // 2)
        self._d_timg = Img.TimedCameraImage(*j)
        self._timgOut = OpenRTM_aist.OutPort("timg", self._d_timg)
        self._arm = OpenRTM_aist.CorbaConsumer(interfaceType=JARA_ARM.ManipulatorCommonInterface_Middle)
        self._p = OpenRTM_aist.CorbaPort("arm")
        self._p.registerConsumer("m", "JARA_ARM::ManipulatorCommonInterface_Middle", self._arm)
    def onInitialize(self):
        self.addInPort("in", self._inIn)
        self.addOutPort("img", self._imgOut)
        self.addOutPort("timg", self._timgOut)
        self.addPort(self._p)
        return RTC.RTC_OK
    def onExecute(self, ec_id):
        self._d_timg = Img.TimedCameraImage(RTC.Time(0,0), Img.CameraImage(RTC.Time(0,0), Img.ImageData(1,1,Img.CF_RGB,b"abc"), Img.CameraIntrinsicParameter([1,2,3,4,5],[]), [[0.0]*4]*4), 0)
        r = self._timgOut.write(self._d_timg)
        if not hasattr(self, "said"): self.said = print("OK OldDefaults", r, self._arm._ptr(), JARA_ARM.JointPos if hasattr(JARA_ARM, "JointPos") else None)
        return RTC.RTC_OK

def OldDefaultsInit(manager):
    manager.registerFactory(OpenRTM_aist.Properties(defaults_str=olddefaults_spec), OldDefaults, OpenRTM_aist.Delete)

def MyModuleInit(manager):
    OldDefaultsInit(manager)
    manager.createComponent("OldDefaults")

def main():
    mgr = OpenRTM_aist.Manager.init(sys.argv)
    mgr.setModuleInitProc(MyModuleInit)
    mgr.activateManager()
    mgr.runManager()

if __name__ == "__main__":
    main()
