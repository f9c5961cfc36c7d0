#!/usr/bin/env python3
"""Prints the numbers that the port `number` receives, and what its listeners hear."""
from __future__ import print_function
import sys

import OpenRTM_aist
import RTC

printer_spec = ["implementation_id", "Printer",
                "type_name", "Printer",
                "description", "Prints numbers",
                "version", "1.0",
                "vendor", "rtm-sim",
                "category", "test",
                "activity_type", "DataFlowComponent",
                "max_instance", "10",
                "language", "Python",
                "lang_type", "script",
                ""]


class OldListener(OpenRTM_aist.ConnectorDataListenerT):
    """As sources for 1.2 write it: decodes by the call of the base, returns nothing."""

    def __init__(self, name):
        self._name = name

    def __call__(self, info, cdrdata):
        data = OpenRTM_aist.ConnectorDataListenerT.__call__(self, info, cdrdata, RTC.TimedLong(RTC.Time(0, 0), 0))
        print("old listener", self._name, info.name, data.data, flush=True)


class NewListener(OpenRTM_aist.ConnectorDataListenerT):
    """As sources for 2.x write it: has the value, returns a pair."""

    def __call__(self, info, data):
        print("new listener", data.data, flush=True)
        return OpenRTM_aist.ConnectorListenerStatus.NO_CHANGE, data


class Connected(OpenRTM_aist.ConnectorListener):
    def __call__(self, info):
        print("connected", info.name, info.properties.getProperty("dataflow_type"), flush=True)
        return OpenRTM_aist.ConnectorListenerStatus.NO_CHANGE


class Printer(OpenRTM_aist.DataFlowComponentBase):
    def __init__(self, manager):
        OpenRTM_aist.DataFlowComponentBase.__init__(self, manager)
        self._d_number = RTC.TimedLong(RTC.Time(0, 0), 0)
        self._numberIn = OpenRTM_aist.InPort("number", self._d_number)

    def onInitialize(self):
        self.registerInPort("number", self._numberIn)
        types = OpenRTM_aist.ConnectorDataListenerType
        self._numberIn.addConnectorDataListener(types.ON_BUFFER_WRITE, OldListener("ON_BUFFER_WRITE"))
        self._numberIn.addConnectorDataListener(types.ON_RECEIVED, NewListener())
        self._numberIn.addConnectorListener(OpenRTM_aist.ConnectorListenerType.ON_CONNECT, Connected())
        return RTC.RTC_OK

    def onExecute(self, ec_id):
        if self._numberIn.isNew():
            data = self._numberIn.read()
            print("received", data.data, data.tm.sec > 0, flush=True)
        return RTC.RTC_OK


def PrinterInit(manager):
    profile = OpenRTM_aist.Properties(defaults_str=printer_spec)
    manager.registerFactory(profile, Printer, OpenRTM_aist.Delete)


def MyModuleInit(manager):
    PrinterInit(manager)
    manager.createComponent("Printer")


if __name__ == "__main__":
    mgr = OpenRTM_aist.Manager.init(len(sys.argv), sys.argv)
    mgr.setModuleInitProc(MyModuleInit)
    mgr.activateManager()
    mgr.runManager()
