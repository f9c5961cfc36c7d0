#!/usr/bin/env python3
"""Writes numbers by a CSP port, which waits for its reader."""
import sys
import time

import OpenRTM_aist
import RTC

channelwriter_spec = ["implementation_id", "ChannelWriter", "type_name", "ChannelWriter", "description", "a test", "version", "1.0", "vendor", "rtm-sim", "category", "test",
    "activity_type", "DataFlowComponent", "max_instance", "10", "language", "Python", "lang_type", "script",
    ""]


class ChannelWriter(OpenRTM_aist.DataFlowComponentBase):
    def onInitialize(self):
        self._data = RTC.TimedLong(RTC.Time(0, 0), 0)
        self._outport = OpenRTM_aist.CSPOutPort("out1", self._data)
        self.addOutPort("out1", self._outport)
        return RTC.RTC_OK

    def onExecute(self, ec_id):
        if self._data.data < 20 and self._outport.write():
            print("sent", self._data.data, flush=True)
            self._data.data += 1
        return RTC.RTC_OK


def ChannelWriterInit(manager):
    manager.registerFactory(OpenRTM_aist.Properties(defaults_str=channelwriter_spec), ChannelWriter, OpenRTM_aist.Delete)


def MyModuleInit(manager):
    ChannelWriterInit(manager)
    manager.createComponent("ChannelWriter")


if __name__ == "__main__":
    mgr = OpenRTM_aist.Manager.init(sys.argv)
    mgr.setModuleInitProc(MyModuleInit)
    mgr.activateManager()
    mgr.runManager()
