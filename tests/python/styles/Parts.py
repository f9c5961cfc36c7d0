#!/usr/bin/env python
# -*- coding: utf-8 -*-
# -*- Python -*-
import sys
import RTC, OpenRTM_aist
class SetL(OpenRTM_aist.ConfigurationSetListener):
    def __call__(self, config_set): print(config_set)
class NameL(OpenRTM_aist.ConfigurationSetNameListener):
    def __call__(self, name): print("name", name)

parts_spec = ["implementation_id", "Parts", "type_name", "Parts", "description", "a style", "version", "1.0.0", "vendor", "rtm-sim",
            "category", "test", "activity_type", "STATIC", "max_instance", "1", "language", "Python", "lang_type", "SCRIPT", "conf.default.ports", "3",
"exec_cxt.periodic.rate", "100",
            ""]

class Parts(OpenRTM_aist.DataFlowComponentBase):
    def __init__(self, manager):
        OpenRTM_aist.DataFlowComponentBase.__init__(self, manager)
        self._ports = []
    def onInitialize(self):
        prop = self.getProperties()
        n = int(prop.getProperty("conf.default.ports"))
        self._ports = []
        for i in range(n):
            d = RTC.TimedLong(RTC.Time(0,0), 0)
            p = OpenRTM_aist.InPort("in%d" % i, d)
            p.appendProperty("description", "x")
            p.addProperty("a", "b")
            self.addInPort("in%d" % i, p)
            self._ports.append([d, p])
        print(self._properties.getNode("conf").getNode("default").getProperty("ports"), prop.findNode("nothing"), prop.hasKey("conf") is not None)
        self._rtcout.RTC_INFO("ports %d", n)
        self._rtcout.RTC_DEBUG("ports %d %s", (n, "x"))
        self._rtcout.RTC_WARN("ports")
        self._log = OpenRTM_aist.Manager.instance().getLogbuf("mine")
        self._log.RTC_ERROR("x" + str(3))
        self.addConfigurationSetListener(OpenRTM_aist.ConfigurationSetListenerType.ON_SET_CONFIG_SET, SetL())
        self.addConfigurationSetNameListener(OpenRTM_aist.ConfigurationSetNameListenerType.ON_ACTIVATE_CONFIG_SET, NameL())
        self._x = [0]
        self.bindParameter("ports", self._x, "3")
        self._configsets.update("default", "ports")
        self._configsets.isChanged()
        self._configsets.getActiveId()
        return RTC.RTC_OK
    def onActivated(self, ec_id):
        for d, p in self._ports[1:]:
            self.removePort(p)
        self._ports = self._ports[:1]
        ec = self.get_owned_contexts()[0]
        print(ec.get_rate(), ec.get_profile().kind, ec.is_running(), ec.get_component_state(self.getObjRef()))
        print(self.getExecutionRate(ec_id), self.setExecutionRate(ec_id, 50.0), self.get_context(ec_id), self.getExecutionContext(ec_id))
        return RTC.RTC_OK
    def onRateChanged(self, ec_id):
        print("rate", self.getExecutionContext(0).get_rate())
        return RTC.RTC_OK
    def onExecute(self, ec_id):
        if not hasattr(self, "said"):
            ec = self.get_context(ec_id)
            assert ec.get_component_state(self.getObjRef()) == RTC.ACTIVE_STATE
            assert ec.get_component_state(self._this()) == RTC.LifeCycleState._item(2)
            self.said = print("OK Parts", self.get_sdo_id(), self.getNamingNames(), self.getCategory(), self.get_component_profile().port_profiles[0].name)
        return RTC.RTC_OK
    def onDeactivated(self, ec_id):
        return RTC.RTC_OK

def PartsInit(manager):
    manager.registerFactory(OpenRTM_aist.Properties(defaults_str=parts_spec), Parts, OpenRTM_aist.Delete)

def MyModuleInit(manager):
    PartsInit(manager)
    manager.createComponent("Parts")

def main():
    mgr = OpenRTM_aist.Manager.init(sys.argv)
    mgr.setModuleInitProc(MyModuleInit)
    mgr.activateManager()
    mgr.runManager()

if __name__ == "__main__":
    main()
