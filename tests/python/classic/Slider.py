#!/usr/bin/env python3
"""A window in the main thread beside the manager; two forgotten commas leave an odd specification."""
import sys
import time
sys.path.append(".")

import RTC
import OpenRTM_aist

import window

mod_spec = ["implementation_id", "Slider",
            "type_name", "Slider",
            "description", "slider component",
            "version", "1.0",
            "vendor", "rtm-sim",
            "category", "Generic",
            "activity_type", "DataFlowComponent",
            "max_instance", "10",
            "language", "Python",
            "lang_type" "SCRIPT",
            ""]

sl = window.Window()


class Slider(OpenRTM_aist.DataFlowComponentBase):
    def onInitialize(self):
        self._sl_data = RTC.TimedFloatSeq(RTC.Time(0, 0), [])
        self._slOut = OpenRTM_aist.OutPort("slider", self._sl_data)
        self.addOutPort("slider", self._slOut)
        self._angleIn = OpenRTM_aist.InPort("angle", RTC.TimedFloatSeq(RTC.Time(0, 0), []))
        self.addInPort("angle", self._angleIn)
        return RTC.RTC_OK

    def onExecute(self, ec_id):
        self._sl_data.data = sl.get()
        self._slOut.write()
        if self._angleIn.isNew():
            sl.after(self._angleIn.read().data)
        time.sleep(0.01)
        return RTC.RTC_OK

    def onShutdown(self, ec_id):
        sl.quit()
        return RTC.RTC_OK

    def moved(self, position):
        print("moved", position, flush=True)


def main():
    mgr = OpenRTM_aist.Manager.init(sys.argv)
    mgr.activateManager()
    profile = OpenRTM_aist.Properties(defaults_str=mod_spec)
    mgr.registerFactory(profile, Slider, OpenRTM_aist.Delete)
    comp = mgr.createComponent("Slider")
    sl.set_on_update(comp.moved)
    mgr.runManager(True)
    sl.mainloop()
    print("window closed", flush=True)


if __name__ == "__main__":
    main()
