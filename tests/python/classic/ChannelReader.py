#!/usr/bin/env python3
"""Reads numbers by a CSP port, which waits for its writer."""
import sys
import time

import OpenRTM_aist
import RTC

channelreader_spec = ["implementation_id", "ChannelReader", "type_name", "ChannelReader", "description", "a test", "version", "1.0", "vendor", "rtm-sim", "category", "test",
    "activity_type", "DataFlowComponent", "max_instance", "10", "language", "Python", "lang_type", "script",
    ""]


class ChannelReader(OpenRTM_aist.DataFlowComponentBase):
    def onInitialize(self):
        self._inport = OpenRTM_aist.CSPInPort("in1", RTC.TimedLong(RTC.Time(0, 0), 0))
        self.addInPort("in1", self._inport)
        return RTC.RTC_OK

    def onExecute(self, ec_id):
        data = self._inport.read()
        if data is not None:
            print("got", data.data, flush=True)
            time.sleep(0.002)
        return RTC.RTC_OK


def ChannelReaderInit(manager):
    manager.registerFactory(OpenRTM_aist.Properties(defaults_str=channelreader_spec), ChannelReader, OpenRTM_aist.Delete)


def MyModuleInit(manager):
    ChannelReaderInit(manager)
    manager.createComponent("ChannelReader" + "".join(word for word in sys.argv if word.startswith("?")))


if __name__ == "__main__":
    mgr = OpenRTM_aist.Manager.init([word for word in sys.argv if not word.startswith("?")])
    mgr.setModuleInitProc(MyModuleInit)
    mgr.activateManager()
    mgr.runManager()
