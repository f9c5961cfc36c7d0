#!/usr/bin/env python3
"""Sends sequences that grow, hears them arrive and leaves by itself."""
import sys
import time

import OpenRTM_aist
import RTC

throughput_spec = ["implementation_id", "Throughput", "type_name", "Throughput", "description", "a test", "version", "1.0", "vendor", "rtm-sim", "category", "test",
    "activity_type", "DataFlowComponent", "max_instance", "10", "language", "Python", "lang_type", "script",
    "conf.default.maxsize", "1000",
    ""]


class DataListener(OpenRTM_aist.ConnectorDataListenerT):
    def __init__(self, comp, data):
        self._comp = comp
        self._data = data

    def __call__(self, info, cdrdata):
        data = OpenRTM_aist.ConnectorDataListenerT.__call__(self, info, cdrdata, self._data, OpenRTM_aist.PortType.InPortType)
        self._comp.received(data.tm, len(data.data))
        return OpenRTM_aist.ConnectorListenerStatus.NO_CHANGE, data


class ConnListener(OpenRTM_aist.ConnectorListener):
    def __init__(self, comp):
        self._comp = comp

    def __call__(self, info):
        print("connected", info.properties.getProperty("interface_type"), len(str(info.properties).split("\n")) > 3, flush=True)
        return OpenRTM_aist.ConnectorListenerStatus.NO_CHANGE


class Throughput(OpenRTM_aist.DataFlowComponentBase):
    def onInitialize(self):
        self._maxsize = [1000]
        self.bindParameter("maxsize", self._maxsize, "1000")
        self._d_in = RTC.TimedDoubleSeq(RTC.Time(0, 0), [])
        self._d_out = RTC.TimedDoubleSeq(RTC.Time(0, 0), [])
        self._inIn = OpenRTM_aist.InPort("in", self._d_in)
        self.addInPort("in", self._inIn)
        self._outOut = OpenRTM_aist.OutPort("out", self._d_out)
        self.addOutPort("out", self._outOut)
        self._inIn.addConnectorDataListener(OpenRTM_aist.ConnectorDataListenerType.ON_BUFFER_WRITE, DataListener(self, self._d_in))
        self._inIn.addConnectorListener(OpenRTM_aist.ConnectorListenerType.ON_CONNECT, ConnListener(self))
        self._latencies = []
        return RTC.RTC_OK

    def onActivated(self, ec_id):
        self._size = 1
        return RTC.RTC_OK

    def onDeactivated(self, ec_id):
        print("connections", len(self._inIn.get_connector_profiles()), "received", len(self._latencies), min(self._latencies) >= 0, flush=True)
        async_ = OpenRTM_aist.Async_tInvoker(self, Throughput.exit)
        async_.invoke()
        return RTC.RTC_OK

    def onExecute(self, ec_id):
        self._d_out.data = [0] * self._size
        OpenRTM_aist.setTimestamp(self._d_out)
        self._outOut.write()
        self._size *= 2
        if self._size > self._maxsize[0]:
            self.deactivate(ec_id)
        return RTC.RTC_OK

    def received(self, tm, length):
        latency = OpenRTM_aist.Time().getTime() - OpenRTM_aist.TimeValue(tm.sec, tm.nsec / 1000)
        self._latencies.append(latency.toDouble())


def ThroughputInit(manager):
    manager.registerFactory(OpenRTM_aist.Properties(defaults_str=throughput_spec), Throughput, OpenRTM_aist.Delete)


def MyModuleInit(manager):
    ThroughputInit(manager)
    manager.createComponent("Throughput")


if __name__ == "__main__":
    mgr = OpenRTM_aist.Manager.init(sys.argv)
    mgr.setModuleInitProc(MyModuleInit)
    mgr.activateManager()
    mgr.runManager()
