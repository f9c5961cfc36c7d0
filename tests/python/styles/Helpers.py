#!/usr/bin/env python
# -*- coding: utf-8 -*-
# -*- Python -*-
import sys
import time
import OpenRTM_aist
import RTC

class Worker(OpenRTM_aist.Task):
    def __init__(self, comp):
        OpenRTM_aist.Task.__init__(self)
        self._comp = comp
        self._active = False
        self.n = 0
    def open(self, *args):
        self._active = True
        return 0
    def close(self, flags=0):
        self._active = False
        return 0
    def svc(self):
        while self._active:
            self.n += 1
            time.sleep(0.005)
        return 0

helpers_spec = ["implementation_id", "Helpers", "type_name", "Helpers", "description", "a style", "version", "1.0.0", "vendor", "rtm-sim",
            "category", "test", "activity_type", "STATIC", "max_instance", "1", "language", "Python", "lang_type", "SCRIPT",
            ""]

class Helpers(OpenRTM_aist.DataFlowComponentBase):
    def __init__(self, manager):
        OpenRTM_aist.DataFlowComponentBase.__init__(self, manager)
        self._task = Worker(self)
        self._timer = OpenRTM_aist.Timer(OpenRTM_aist.TimeValue(0,100000))
        self.t = 0
    def onInitialize(self):
        self._timer.registerListenerObj(self, Helpers.tick, OpenRTM_aist.TimeValue(0,10000))
        self._timer.start()
        return RTC.RTC_OK
    def tick(self):
        self.t += 1
    def onFinalize(self):
        self._timer.stop()
        self._task.finalize()
        self._task.wait()
        return RTC.RTC_OK
    def onActivated(self, ec_id):
        self._task.open()
        self._task.activate()
        return RTC.RTC_OK
    def onDeactivated(self, ec_id):
        self._task.close()
        self._task.wait()
        return RTC.RTC_OK
    def onExecute(self, ec_id):
        if self._task.n > 3 and self.t > 2 and not hasattr(self, "said"):
            s = ["  abc "]
            OpenRTM_aist.eraseHeadBlank(s)
            OpenRTM_aist.StringUtil.eraseTailBlank(s)
            p = OpenRTM_aist.split("a, b,c", ",")
            u = OpenRTM_aist.unique_sv(["a","a","b"])
            f = OpenRTM_aist.flatten(["a","b"])
            b = OpenRTM_aist.toBool("yes", "yes", "no", True)
            x = [1.0]
            OpenRTM_aist.stringTo(x, "3.5")
            o = OpenRTM_aist.otos(5)
            e = OpenRTM_aist.escape("a\n"), OpenRTM_aist.unescape("a\\n")
            a = OpenRTM_aist.isAbsolutePath("/x"), OpenRTM_aist.isURL("http://x"), OpenRTM_aist.includes(["a"], "A"), OpenRTM_aist.includes("a,b", "b")
            m = OpenRTM_aist.urlparam2map("X?a=1&b=2")
            tm = OpenRTM_aist.TimeMeasure()
            tm.tick(); tm.tack()
            mx, mn, me, sd = [0.0], [0.0], [0.0], [0.0]
            tm.getStatistics(mx, mn, me, sd)
            self.said = print("OK Helpers", s, p, u, f, b, x, o, e, a, m, tm.interval().toDouble() >= 0)
        return RTC.RTC_OK

def HelpersInit(manager):
    manager.registerFactory(OpenRTM_aist.Properties(defaults_str=helpers_spec), Helpers, OpenRTM_aist.Delete)

def MyModuleInit(manager):
    HelpersInit(manager)
    manager.createComponent("Helpers")

def main():
    mgr = OpenRTM_aist.Manager.init(sys.argv)
    mgr.setModuleInitProc(MyModuleInit)
    mgr.activateManager()
    mgr.runManager()

if __name__ == "__main__":
    main()
