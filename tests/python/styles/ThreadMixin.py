#!/usr/bin/env python
# -*- coding: utf-8 -*-
# -*- Python -*-
import sys, time, threading, json
import RTC, OpenRTM_aist

threadmixin_spec = ["implementation_id", "ThreadMixin", "type_name", "ThreadMixin", "description", "a style", "version", "1.0.0", "vendor", "rtm-sim",
            "category", "test", "activity_type", "STATIC", "max_instance", "1", "language", "Python", "lang_type", "SCRIPT",
            ""]

class ThreadMixin(OpenRTM_aist.DataFlowComponentBase, threading.Thread):
    def __init__(self, manager):
        OpenRTM_aist.DataFlowComponentBase.__init__(self, manager)
        threading.Thread.__init__(self)
        self.daemon = True
        self._lock = threading.RLock()
        self.count = 0
        self._d_out = RTC.TimedString(RTC.Time(0,0), "")
        self._outOut = OpenRTM_aist.OutPort("out", self._d_out)
    def onInitialize(self):
        self.addOutPort("out", self._outOut)
        return RTC.RTC_OK
    def run(self):
        while True:
            guard = OpenRTM_aist.ScopedLock(self._lock)
            self.count += 1
            del guard
            self._d_out.data = json.dumps({"count": self.count})
            self._outOut.write()
            time.sleep(0.001)
    def onActivated(self, ec_id):
        if not threading.Thread.is_alive(self):
            self.start()
        return RTC.RTC_OK
    def onExecute(self, ec_id):
        guard = OpenRTM_aist.ScopedLock(self._lock)
        if self.count > 5 and not hasattr(self, "said"): self.said = print("OK ThreadMixin", self.name)
        del guard
        return RTC.RTC_OK

def ThreadMixinInit(manager):
    manager.registerFactory(OpenRTM_aist.Properties(defaults_str=threadmixin_spec), ThreadMixin, OpenRTM_aist.Delete)

def MyModuleInit(manager):
    ThreadMixinInit(manager)
    manager.createComponent("ThreadMixin")

def main():
    mgr = OpenRTM_aist.Manager.init(sys.argv)
    mgr.setModuleInitProc(MyModuleInit)
    mgr.activateManager()
    mgr.runManager()

if __name__ == "__main__":
    main()
