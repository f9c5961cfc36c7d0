#!/usr/bin/env python3
"""Sends values of ten types at random and compares them with what comes back."""
import sys
import time

import OpenRTM_aist
import RTC

sequences_spec = ["implementation_id", "Sequences", "type_name", "Sequences", "description", "a test", "version", "1.0", "vendor", "rtm-sim", "category", "test",
    "activity_type", "DataFlowComponent", "max_instance", "10", "language", "Python", "lang_type", "script",
    ""]


NAMES = ("Octet", "Short", "Long", "Float", "Double")


class Sequences(OpenRTM_aist.DataFlowComponentBase):
    def onInitialize(self):
        import random
        random.seed(1)
        self._random = random
        self._data, self._outs, self._ins = {}, {}, {}
        for name in NAMES:
            single, many = getattr(RTC, "Timed" + name), getattr(RTC, "Timed" + name + "Seq")
            self._data[name] = single(RTC.Time(0, 0), 0)
            self._data[name + "Seq"] = many(RTC.Time(0, 0), [])
        for name, data in self._data.items():
            self._outs[name] = OpenRTM_aist.OutPort(name, data, OpenRTM_aist.RingBuffer(8))
            self._ins[name] = OpenRTM_aist.InPort(name + "In", OpenRTM_aist.instantiateDataType(type(data)), OpenRTM_aist.RingBuffer(8))
            self.addOutPort(name, self._outs[name])
            self.addInPort(name + "In", self._ins[name])
        self._rounds = 0
        return RTC.RTC_OK

    def onExecute(self, ec_id):
        for name in NAMES:
            numbers = [self._random.randint(0, 100) for _ in range(5)]
            self._data[name].data = numbers[0]
            self._data[name + "Seq"].data = bytes(numbers) if name == "Octet" else numbers
        for out in self._outs.values():
            out.write()
        for name, data in self._data.items():
            if self._ins[name].isNew() and self._ins[name].read().data != data.data:
                print("differs", name, data.data, flush=True)
        self._rounds += 1
        if self._rounds == 50:
            print("fifty rounds", flush=True)
        return RTC.RTC_OK


def SequencesInit(manager):
    manager.registerFactory(OpenRTM_aist.Properties(defaults_str=sequences_spec), Sequences, OpenRTM_aist.Delete)


def MyModuleInit(manager):
    SequencesInit(manager)
    manager.createComponent("Sequences")


if __name__ == "__main__":
    mgr = OpenRTM_aist.Manager.init(sys.argv)
    mgr.setModuleInitProc(MyModuleInit)
    mgr.activateManager()
    mgr.runManager()
