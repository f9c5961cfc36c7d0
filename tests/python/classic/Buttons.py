#!/usr/bin/env python3
"""Reads commands from standard input and sends each by the port of that name."""
from __future__ import print_function
import sys

import RTC
import OpenRTM_aist
import OpenRTM_aist.StringUtil

buttons_spec = ["implementation_id", "Buttons", "type_name", "Buttons", "description", "commands", "version", "1.0", "vendor", "rtm-sim",
                "category", "test", "activity_type", "DataFlowComponent", "max_instance", "10", "language", "Python",
                "lang_type", "script", ""]
Port = OpenRTM_aist.CSPOutPort if "channels" in sys.argv else OpenRTM_aist.OutPort


class Buttons(OpenRTM_aist.DataFlowComponentBase):
    def onInitialize(self):
        self._heat = RTC.TimedLong(RTC.Time(0, 0), 0)
        self._door = RTC.TimedLong(RTC.Time(0, 0), 0)
        self._tick = RTC.TimedLong(RTC.Time(0, 0), 0)
        self._heatOut = Port("heat", self._heat)
        self._doorOut = Port("door", self._door)
        self._tickOut = Port("tick", self._tick)
        self.addOutPort("heat", self._heatOut)
        self.addOutPort("door", self._doorOut)
        self.addOutPort("tick", self._tickOut)
        return RTC.RTC_OK

    def onExecute(self, ec_id):
        words = sys.stdin.readline().split(" ")
        OpenRTM_aist.StringUtil.eraseBlank(words)
        words[0] = words[0].replace("\n", "")
        if words[0] == "heat":
            value = [0]
            if len(words) < 2 or not OpenRTM_aist.StringUtil.stringTo(value, words[1]):
                print("heat needs a number", flush=True)
                return RTC.RTC_OK
            self._heat.data = value[0]
            self._heatOut.write()
        elif words[0] == "door":
            self._doorOut.write()
        elif words[0] == "tick":
            self._tickOut.write()
        return RTC.RTC_OK


def ButtonsInit(manager):
    manager.registerFactory(OpenRTM_aist.Properties(defaults_str=buttons_spec), Buttons, OpenRTM_aist.Delete)


def MyModuleInit(manager):
    ButtonsInit(manager)
    manager.createComponent("Buttons")


if __name__ == "__main__":
    mgr = OpenRTM_aist.Manager.init([word for word in sys.argv if word != "channels"])
    mgr.setModuleInitProc(MyModuleInit)
    mgr.activateManager()
    mgr.runManager()
