#!/usr/bin/env python
# -*- coding: utf-8 -*-
# -*- Python -*-
import sys, time
import RTC, OpenRTM_aist, SDOPackage
from omniORB import any, CORBA
import OpenRTM_aist.CORBA_RTCUtil
from OpenRTM_aist import CORBA_RTCUtil, NVUtil

connecting_spec = ["implementation_id", "Connecting", "type_name", "Connecting", "description", "a style", "version", "1.0.0", "vendor", "rtm-sim",
            "category", "test", "activity_type", "STATIC", "max_instance", "1", "language", "Python", "lang_type", "SCRIPT",
            ""]

class Connecting(OpenRTM_aist.DataFlowComponentBase):
    def onInitialize(self):
        self._d = OpenRTM_aist.instantiateDataType(RTC.TimedLong)
        self._in = OpenRTM_aist.InPort("in", self._d)
        self._out = OpenRTM_aist.OutPort("out", RTC.TimedLong(RTC.Time(0,0),0))
        self.addInPort("in", self._in)
        self.addOutPort("out", self._out)
        return RTC.RTC_OK
    def onExecute(self, ec_id):
        if not hasattr(self, "con"):
            mgr = OpenRTM_aist.Manager.instance()
            self.con = 1
            p = OpenRTM_aist.Properties()
            p.setProperty("dataport.interface_type", "corba_cdr")
            p.setProperty("dataport.dataflow_type", "push")
            p.setProperty("dataport.subscription_type", "new")
            prof = OpenRTM_aist.CORBA_RTCUtil.create_connector("x", p, self._in.getPortRef(), self._out.getPortRef())
            print("RC", OpenRTM_aist.CORBA_RTCUtil.connect("x", OpenRTM_aist.Properties(), self._in._objref, self._out._objref))
            nv = OpenRTM_aist.NVUtil.newNV("dataport.dataflow_type", "push")
            print(nv.name, any.from_any(nv.value), OpenRTM_aist.NVUtil.toString([nv], "dataport.dataflow_type"), OpenRTM_aist.NVUtil.isStringValue([nv], "dataport.dataflow_type", "push"))
            print(OpenRTM_aist.CORBA_RTCUtil.get_state(self.getObjRef(), 0), OpenRTM_aist.CORBA_RTCUtil.is_in_active(self.getObjRef()))
            nvs = []
            OpenRTM_aist.NVUtil.copyFromProperties(nvs, p)
            q = OpenRTM_aist.Properties()
            OpenRTM_aist.NVUtil.copyToProperties(q, nvs)
            print(q.getProperty("dataport.interface_type"), SDOPackage.NameValue("a", any.to_any("b")))
            i = OpenRTM_aist.CORBA_SeqUtil.find(nvs, lambda x: x.name == "dataport.dataflow_type")
            print(i, OpenRTM_aist.CORBA_SeqUtil.for_each(nvs, lambda x: None))
        self._out.write(RTC.TimedLong(RTC.Time(1,2), 7))
        if self._in.isNew() and not hasattr(self, "said"):
            while self._in.isNew(): d = self._in.read()
            self.said = print("OK Connecting", d.data, d.tm.sec, d, self._in.getName(), self._in.name(), self._in.getProfile().name, len(self._in.get_connector_profiles()), [(c.id() == c.profile().id, c.name()) for c in self._in.connectors()], self._out.getConnectorByName("x").id() == self._out.getConnectorIds()[0], self._in.getConnectorNames())
        return RTC.RTC_OK

def ConnectingInit(manager):
    manager.registerFactory(OpenRTM_aist.Properties(defaults_str=connecting_spec), Connecting, OpenRTM_aist.Delete)

def MyModuleInit(manager):
    ConnectingInit(manager)
    manager.createComponent("Connecting")

def main():
    mgr = OpenRTM_aist.Manager.init(sys.argv)
    mgr.setModuleInitProc(MyModuleInit)
    mgr.activateManager()
    mgr.runManager()

if __name__ == "__main__":
    main()
