#!/usr/bin/env python
# -*- coding: utf-8 -*-
# -*- Python -*-
import sys
import RTC, OpenRTM_aist
class Rd(OpenRTM_aist.OnRead):
    def __call__(self): pass
class Wr(OpenRTM_aist.OnWrite):
    def __call__(self, v): pass
class Cv(OpenRTM_aist.OnReadConvert):
    def __call__(self, v): return v
class Cb(OpenRTM_aist.ConnectionCallback):
    def __call__(self, p): pass
class Act(OpenRTM_aist.PreComponentActionListener):
    def __call__(self, ec): print("act", ec)
class Post(OpenRTM_aist.PostComponentActionListener):
    def __call__(self, ec, ret): assert ret == RTC.RTC_OK

callbacks_spec = ["implementation_id", "Callbacks", "type_name", "Callbacks", "description", "a style", "version", "1.0.0", "vendor", "rtm-sim",
            "category", "test", "activity_type", "STATIC", "max_instance", "1", "language", "Python", "lang_type", "SCRIPT",
            ""]

class Callbacks(OpenRTM_aist.DataFlowComponentBase):
    def __init__(self, manager):
        OpenRTM_aist.DataFlowComponentBase.__init__(self, manager)
        self._d_in = OpenRTM_aist.instantiateDataType(RTC.TimedLong)
        self._in = OpenRTM_aist.InPort("in", self._d_in)
        self._out = OpenRTM_aist.OutPort("out", self._d_in)
    def onInitialize(self):
        self.addInPort("in", self._in); self.addOutPort("out", self._out)
        self._in.setOnRead(Rd()); self._in.setOnReadConvert(Cv()); self._out.setOnWrite(Wr()); self._out.setOnWriteConvert(Cv())
        self._in.setOnConnected(Cb()) ; self._out.setOnDisconnected(Cb())
        self.setReadAll(True); self.setWriteAll(True)
        self.addPreComponentActionListener(OpenRTM_aist.PreComponentActionListenerType.PRE_ON_ACTIVATED, Act())
        self.addPostComponentActionListener(OpenRTM_aist.PostComponentActionListenerType.POST_ON_EXECUTE, Post())
        self.addPortActionListener(OpenRTM_aist.PortActionListenerType.ADD_PORT, lambda p: None)
        self.addExecutionContextActionListener(OpenRTM_aist.ExecutionContextActionListenerType.EC_ATTACHED, lambda e: None)
        return RTC.RTC_OK
    def onExecute(self, ec_id):
        st = self._out.getStatusList()
        if not hasattr(self, "said"): self.said = print("OK Callbacks", st, OpenRTM_aist.DataPortStatus.PORT_OK)
        return RTC.RTC_OK

def CallbacksInit(manager):
    manager.registerFactory(OpenRTM_aist.Properties(defaults_str=callbacks_spec), Callbacks, OpenRTM_aist.Delete)

def MyModuleInit(manager):
    CallbacksInit(manager)
    manager.createComponent("Callbacks")

def main():
    mgr = OpenRTM_aist.Manager.init(sys.argv)
    mgr.setModuleInitProc(MyModuleInit)
    mgr.activateManager()
    mgr.runManager()

if __name__ == "__main__":
    main()
