#!/usr/bin/env python3
from OpenRTM_aist import *
from RTC import *
import RTC
import sys
starimport_spec = ["implementation_id", "StarImport",
		 "type_name",         "StarImport",
		 "description",       "ModuleDescription",
		 "version",           "1.0.0",
		 "vendor",            "VenderName",
		 "category",          "Category",
		 "activity_type",     "STATIC",
		 "max_instance",      "1",
		 "language",          "Python",
		 "lang_type",         "SCRIPT",

		 ""]
class StarImport(DataFlowComponentBase):
    def __init__(self, manager):
        super().__init__(manager)
    def onInitialize(self):
        self._d = instantiateDataType(TimedDouble)
        self.p = OutPort("out", self._d)
        self.addOutPort("out", self.p)
        self.svc = CorbaPort("svc")
        self.addPort(self.svc)
        return RTC_OK
    def onExecute(self, ec_id):
        setTimestamp(self._d)
        self.p.write()
        CorbaNaming
        StaticFSM
        CORBA_RTCUtil
        PeriodicExecutionContext
        get_state
        toBool("a", "b", "c")
        tv = TimeValue(1, 5)
        if not hasattr(self, "_said"):
            self._said = 1; print("OK StarImport", TimedPose2D, ACTIVE_STATE)
        return RTC.RTC_OK
def StarImportInit(manager):
    manager.registerFactory(Properties(defaults_str=starimport_spec), StarImport, Delete)
def MyModuleInit(manager):
    StarImportInit(manager)
    manager.createComponent("StarImport")
def main():
    mgr = Manager.init(sys.argv)
    mgr.setModuleInitProc(MyModuleInit)
    mgr.activateManager()
    mgr.runManager()
if __name__ == "__main__": main()
