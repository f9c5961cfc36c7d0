#!/usr/bin/env python
# -*- coding: utf-8 -*-
# -*- Python -*-
import sys, os, configparser, atexit, signal, threading, pickle, copy
import RTC, OpenRTM_aist
here = os.path.dirname(os.path.abspath(__file__))
cfg = configparser.ConfigParser(); cfg.read(os.path.join(here, "Files.ini"))
class Thing: pass
def bye(): print("bye")
atexit.register(bye)

files_spec = ["implementation_id", "Files", "type_name", "Files", "description", "a style", "version", "1.0.0", "vendor", "rtm-sim",
            "category", "test", "activity_type", "STATIC", "max_instance", "1", "language", "Python", "lang_type", "SCRIPT",
            ""]

class Files(OpenRTM_aist.DataFlowComponentBase):
    def onInitialize(self):
        print("cfg", cfg.get("a", "b"), here)
        return RTC.RTC_OK
    def onExecute(self, ec_id):
        if not hasattr(self, "said"):
            self.said = print("OK Files", threading.current_thread().name, os.path.basename(__file__), __name__)
            pickle.dumps(Thing()); copy.deepcopy(Thing()); copy.deepcopy(RTC.TimedLong(RTC.Time(0,0),1)); copy.copy(RTC.TimedLong(RTC.Time(0,0),1)); pickle.loads(pickle.dumps(RTC.TimedLong(RTC.Time(0,0),1)))
        return RTC.RTC_OK

def FilesInit(manager):
    manager.registerFactory(OpenRTM_aist.Properties(defaults_str=files_spec), Files, OpenRTM_aist.Delete)

def MyModuleInit(manager):
    FilesInit(manager)
    manager.createComponent("Files")

def main():
    mgr = OpenRTM_aist.Manager.init(sys.argv)
    mgr.setModuleInitProc(MyModuleInit)
    mgr.activateManager()
    mgr.runManager()

if __name__ == "__main__":
    main()
