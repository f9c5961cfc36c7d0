#!/usr/bin/env python
# -*- coding: utf-8 -*-
# -*- Python -*-
from __future__ import annotations
import sys, enum, dataclasses
from typing import Optional
import RTC, OpenRTM_aist
class Mode(enum.Enum):
    A = 1
    B = 2
@dataclasses.dataclass
class Cfg:
    mode: Mode = Mode.A

typehints_spec = ["implementation_id", "TypeHints", "type_name", "TypeHints", "description", "a style", "version", "1.0.0", "vendor", "rtm-sim",
            "category", "test", "activity_type", "STATIC", "max_instance", "1", "language", "Python", "lang_type", "SCRIPT",
            ""]

class TypeHints(OpenRTM_aist.DataFlowComponentBase):
    out: OpenRTM_aist.OutPort
    def __init__(self, manager: OpenRTM_aist.Manager) -> None:
        super().__init__(manager)
        self.cfg = Cfg()
        self._reference = 3.0
        self._listen = 5
        self._registered = {}
        self._forget = None
        self._add_port = None
        self._ports = {}
        self._profile = "x"
        self._orb = manager.getORB()
        self._poa = manager.getPOA()
        self._read = self._write = self._thread = self._running = self._name = self._data = self._lock = self._timer = self._state = self._config = None
        self._out = self._in = self._value = self._buffer = self._client = self._socket = self._servant = self._servants = self._connectors = None
    def onInitialize(self):
        self.out = OpenRTM_aist.OutPort("out", RTC.TimedLong(RTC.Time(0, 0), 0))
        self.addOutPort("out", self.out)
        self.addPreComponentActionListener(OpenRTM_aist.PreComponentActionListenerType.PRE_ON_EXECUTE, lambda ec: None)
        return RTC.RTC_OK
    def onExecute(self, ec_id: int):
        match self.cfg.mode:
            case Mode.A: self.cfg.mode = Mode.B
            case Mode.B:
                if not hasattr(self, "said"): self.said = print(f"OK TypeHints {self.getObjRef() is not None} {self.get_component_profile().instance_name=} {self._objref is not None}")
        return RTC.RTC_OK

def TypeHintsInit(manager):
    manager.registerFactory(OpenRTM_aist.Properties(defaults_str=typehints_spec), TypeHints, OpenRTM_aist.Delete)

def MyModuleInit(manager):
    TypeHintsInit(manager)
    manager.createComponent("TypeHints")

def main():
    mgr = OpenRTM_aist.Manager.init(sys.argv)
    mgr.setModuleInitProc(MyModuleInit)
    mgr.activateManager()
    mgr.runManager()

if __name__ == "__main__":
    main()
