#!/usr/bin/env python3
"""Sends the numbers 0, 1, 2, ... by the port `number`."""
import sys

import RTC
import OpenRTM_aist

counter_spec = ["implementation_id", "Counter",
                "type_name", "Counter",
                "description", "Sends numbers",
                "version", "1.0",
                "vendor", "rtm-sim",
                "category", "test",
                "activity_type", "DataFlowComponent",
                "max_instance", "10",
                "language", "Python",
                "lang_type", "script",
                "conf.default.step", "1",
                "conf.default.offsets", "0.5,1.5",
                "conf.default.name", "counter",
                "exec_cxt.periodic.rate", "100.0",
                ""]


class Counter(OpenRTM_aist.DataFlowComponentBase):
    def __init__(self, manager):
        OpenRTM_aist.DataFlowComponentBase.__init__(self, manager)
        self._step = [1]
        self._offsets = [[0.0]]
        self._name = ["none"]

    def onInitialize(self):
        self._d_number = RTC.TimedLong(RTC.Time(0, 0), 0)
        self._numberOut = OpenRTM_aist.OutPort("number", self._d_number)
        self.addOutPort("number", self._numberOut)
        self.bindParameter("step", self._step, "1")
        self.bindParameter("offsets", self._offsets, "0.5,1.5")
        self.bindParameter("name", self._name, "counter")
        self._count = 0
        return RTC.RTC_OK

    def onActivated(self, ec_id):
        self._rtcout.RTC_INFO("parameters: %s %s %s", (self._step, self._offsets, self._name))
        return RTC.RTC_OK

    def onExecute(self, ec_id):
        self._d_number.data = self._count
        OpenRTM_aist.setTimestamp(self._d_number)
        self._numberOut.write()
        self._count += self._step[0]
        return RTC.RTC_OK


def CounterInit(manager):
    profile = OpenRTM_aist.Properties(defaults_str=counter_spec)
    manager.registerFactory(profile, Counter, OpenRTM_aist.Delete)


def MyModuleInit(manager):
    CounterInit(manager)
    manager.createComponent("Counter")


def main():
    mgr = OpenRTM_aist.Manager.init(sys.argv)
    mgr.setModuleInitProc(MyModuleInit)
    mgr.activateManager()
    mgr.runManager()


if __name__ == "__main__":
    main()
