#!/usr/bin/env python
# -*- coding: utf-8 -*-
# -*- Python -*-
import sys
import numpy as np
import RTC, OpenRTM_aist

arrays_spec = ["implementation_id", "Arrays", "type_name", "Arrays", "description", "a style", "version", "1.0.0", "vendor", "rtm-sim",
            "category", "test", "activity_type", "STATIC", "max_instance", "1", "language", "Python", "lang_type", "SCRIPT",
            ""]

class Arrays(OpenRTM_aist.DataFlowComponentBase):
    def __init__(self, manager):
        OpenRTM_aist.DataFlowComponentBase.__init__(self, manager)
    def onInitialize(self):
        self._d = RTC.TimedDoubleSeq(RTC.Time(0,0), [])
        self._f = RTC.TimedFloatSeq(RTC.Time(0,0), [])
        self._l = RTC.TimedLongSeq(RTC.Time(0,0), [])
        self._b = RTC.TimedBooleanSeq(RTC.Time(0,0), [])
        self._o = RTC.TimedOctetSeq(RTC.Time(0,0), None)
        self._c = RTC.CameraImage(RTC.Time(0,0), 0, 0, 0, "", 0.0, b"")
        self._s = RTC.TimedStringSeq(RTC.Time(0,0), [])
        self._w = RTC.TimedWString(RTC.Time(0,0), "")
        self._oc = RTC.TimedOctet(RTC.Time(0,0), 0)
        self._ch = RTC.TimedChar(RTC.Time(0,0), "a")
        for n in "d f l b o c s w oc ch".split():
            p = OpenRTM_aist.OutPort(n, getattr(self, "_" + n))
            setattr(self, "p_" + n, p)
            self.addOutPort(n, p)
        return RTC.RTC_OK
    def onExecute(self, ec_id):
        a = np.arange(12, dtype=np.float32).reshape(3,4)
        r = []
        self._d.data = a.flatten(); r.append(self.p_d.write())
        self._d.data = list(a.flatten()); r.append(self.p_d.write())
        self._f.data = a[0]; r.append(self.p_f.write())
        self._f.data = [np.float64(3), np.int32(3), True]; r.append(self.p_f.write())
        self._l.data = np.array([1,2,3]); r.append(self.p_l.write())
        self._l.data = np.array([True, False]); r.append(self.p_l.write())
        self._b.data = np.array([True, False]); r.append(self.p_b.write())
        self._o.data = np.zeros((2,2,3), np.uint8).tobytes(); r.append(self.p_o.write())
        self._o.data = np.zeros(12, np.uint8); r.append(self.p_o.write())
        self._o.data = np.zeros((2,2,3), np.uint8); r.append(self.p_o.write())
        self._o.data = [1,2,3]; r.append(self.p_o.write())
        self._o.data = bytearray(b"abc"); r.append(self.p_o.write())
        self._o.data = "abc"; r.append(self.p_o.write())
        im = np.zeros((2,2,3), np.uint8)
        h, w, ch = im.shape
        self._c.width = w; self._c.height = h; self._c.bpp = ch * 8; self._c.format = "RGB"
        self._c.pixels = im.tobytes(); r.append(self.p_c.write())
        self._c.pixels = im; r.append(self.p_c.write())
        self._c.pixels = im.tostring() if hasattr(im, "tostring") else b""; r.append(self.p_c.write())
        self._c.fDiv = np.float32(3); r.append(self.p_c.write())
        self._s.data = ["a", u"\u65e5"]; r.append(self.p_s.write())
        self._s.data = np.array(["a"]); r.append(self.p_s.write())
        self._w.data = u"\u65e5\u672c"; r.append(self.p_w.write())
        self._w.data = ""; r.append(self.p_w.write())
        self._oc.data = np.uint8(5); r.append(self.p_oc.write())
        self._oc.data = b"a"; r.append(self.p_oc.write())
        self._oc.data = "a"; r.append(self.p_oc.write())
        self._ch.data = "b"; r.append(self.p_ch.write())
        self._ch.data = b"b"; r.append(self.p_ch.write())
        self._ch.data = 65; r.append(self.p_ch.write())
        if not hasattr(self, "said"): self.said = print("OK Arrays", r)
        return RTC.RTC_OK

def ArraysInit(manager):
    manager.registerFactory(OpenRTM_aist.Properties(defaults_str=arrays_spec), Arrays, OpenRTM_aist.Delete)

def MyModuleInit(manager):
    ArraysInit(manager)
    manager.createComponent("Arrays")

def main():
    mgr = OpenRTM_aist.Manager.init(sys.argv)
    mgr.setModuleInitProc(MyModuleInit)
    mgr.activateManager()
    mgr.runManager()

if __name__ == "__main__":
    main()
