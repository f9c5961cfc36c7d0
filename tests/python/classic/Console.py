#!/usr/bin/env python3
"""Reads numbers from standard input, sends them and prints what comes back, with all listeners."""
import sys
import time

import OpenRTM_aist
import RTC

console_spec = ["implementation_id", "Console", "type_name", "Console", "description", "a test", "version", "1.0", "vendor", "rtm-sim", "category", "test",
    "activity_type", "DataFlowComponent", "max_instance", "10", "language", "Python", "lang_type", "script",
    ""]


class DataListener(OpenRTM_aist.ConnectorDataListenerT):
    def __init__(self, name):
        self._name = name

    def __del__(self):
        print("dtor of", self._name, flush=True)

    def __call__(self, info, data):
        print("Listener:", self._name, info.name, data.data, flush=True)
        return OpenRTM_aist.ConnectorListenerStatus.NO_CHANGE, data


class ConnListener(OpenRTM_aist.ConnectorListener):
    def __init__(self, name):
        self._name = name

    def __call__(self, info):
        print("Listener:", self._name, info.name, flush=True)
        return OpenRTM_aist.ConnectorListenerStatus.NO_CHANGE


class Console(OpenRTM_aist.DataFlowComponentBase):
    def __init__(self, manager):
        OpenRTM_aist.DataFlowComponentBase.__init__(self, manager)
        return

    def onInitialize(self):
        self._data = RTC.TimedLong(RTC.Time(0, 0), 0)
        self._outport = OpenRTM_aist.OutPort("out", self._data)
        self.addOutPort("out", self._outport)
        self._inport = OpenRTM_aist.InPort("in", RTC.TimedLong(RTC.Time(0, 0), 0))
        self.addInPort("in", self._inport)
        for port in (self._outport, self._inport):
            for name in ("ON_BUFFER_WRITE", "ON_BUFFER_FULL", "ON_BUFFER_WRITE_TIMEOUT", "ON_BUFFER_OVERWRITE", "ON_BUFFER_READ", "ON_SEND",
                         "ON_RECEIVED", "ON_RECEIVER_FULL", "ON_RECEIVER_TIMEOUT", "ON_RECEIVER_ERROR"):
                port.addConnectorDataListener(getattr(OpenRTM_aist.ConnectorDataListenerType, name), DataListener(name))
            for name in ("ON_CONNECT", "ON_DISCONNECT"):
                port.addConnectorListener(getattr(OpenRTM_aist.ConnectorListenerType, name), ConnListener(name))
        return RTC.RTC_OK

    def onExecute(self, ec_id):
        print("Please input number: ", end="")
        self._data.data = int(sys.stdin.readline())
        OpenRTM_aist.setTimestamp(self._data)
        print("Sending to subscriber: ", self._data.data)
        self._outport.write()
        if self._inport.isNew():
            data = self._inport.read()
            print("Received: ", data)
            print("TimeStamp: ", data.tm.sec, "[s] ", data.tm.nsec, "[ns]", flush=True)
        return RTC.RTC_OK


def ConsoleInit(manager):
    manager.registerFactory(OpenRTM_aist.Properties(defaults_str=console_spec), Console, OpenRTM_aist.Delete)


def MyModuleInit(manager):
    ConsoleInit(manager)
    manager.createComponent("Console")


if __name__ == "__main__":
    mgr = OpenRTM_aist.Manager.init(sys.argv)
    mgr.setModuleInitProc(MyModuleInit)
    mgr.activateManager()
    mgr.runManager()
