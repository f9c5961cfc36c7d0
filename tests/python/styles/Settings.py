#!/usr/bin/env python
# -*- coding: utf-8 -*-
# -*- Python -*-
import sys
import time
import RTC
import OpenRTM_aist

settings_spec = ["implementation_id", "Settings", "type_name", "Settings", "description", "a style", "version", "1.0.0", "vendor", "rtm-sim",
            "category", "test", "activity_type", "STATIC", "max_instance", "1", "language", "Python", "lang_type", "SCRIPT", "conf.default.v", "1,2,3",
"conf.default.s", "hello world",
"conf.default.b", "7","conf.default.m","a,b","conf.default.c","0x20","conf.default.d","0x21","conf.mode0.s","other",
            ""]

class Settings(OpenRTM_aist.DataFlowComponentBase):
    def onInitialize(self):
        self._v = [[0.0, 0.0]]; self._s = ["x"]; self._b = [0]; self._m = ["a"]; self._c = [0]; self._d = [0]
        self.bindParameter("v", self._v, "0.5,1.5")
        self.bindParameter("s", self._s, "text")
        self.bindParameter("b", self._b, "1")
        self.bindParameter("m", self._m, "one,two", OpenRTM_aist.stringToStrVec)
        self.bindParameter("c", self._c, "0x10", lambda var, text: var.__setitem__(0, int(text, 16)) or True)
        self.bindParameter("d", self._d, "0x11", lambda var, text: (True, int(text, 16)))
        self.bindParameter("nobody", [3], "3")
        return RTC.RTC_OK
    def onActivated(self, ec_id):
        print("OK Settings", self._v, self._s, self._b, self._m, self._c, self._d)
        return RTC.RTC_OK

def SettingsInit(manager):
    manager.registerFactory(OpenRTM_aist.Properties(defaults_str=settings_spec), Settings, OpenRTM_aist.Delete)

def MyModuleInit(manager):
    SettingsInit(manager)
    manager.createComponent("Settings")

def main():
    mgr = OpenRTM_aist.Manager.init(sys.argv)
    mgr.setModuleInitProc(MyModuleInit)
    mgr.activateManager()
    mgr.runManager()

if __name__ == "__main__":
    main()
