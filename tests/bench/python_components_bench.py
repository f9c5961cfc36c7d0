# What a cycle of a component in Python costs: empty, with one sample in and one out, and with long sequences. Prints one row per case:
# microseconds of CPU time per cycle of a context that never waits. Run: PYTHONPATH=build/release/python python3 tests/bench/python_components_bench.py
import os
import resource
import subprocess
import sys
import time
import timeit

import OpenRTM_aist
import RTC
from OpenRTM_aist import CORBA_RTCUtil

spec = ["implementation_id", "Bench", "type_name", "Bench", "description", "a benchmark", "version", "1.0", "vendor", "rtm-sim", "category", "test",
        "language", "Python", "lang_type", "script", "max_instance", "0", "exec_cxt.periodic.rate", "0", ""]


class Bench(OpenRTM_aist.DataFlowComponentBase):
    cycles = 0
    value = None

    def onInitialize(self):
        if self.value is not None:
            self._out = OpenRTM_aist.OutPort("out", self.value)
            self._in = OpenRTM_aist.InPort("in", self.value)
            self.addOutPort("out", self._out)
            self.addInPort("in", self._in)
        return RTC.RTC_OK


# Longer than the shortest period of a context: it would sleep otherwise. Its own time is taken off.
def busy(self, ec_id):
    self.cycles += 1
    for _ in range(400):
        pass
    return RTC.RTC_OK


def own_time():
    subject = type("Subject", (), {"cycles": 0})()
    return min(timeit.repeat(lambda: busy(subject, 0), number=5000, repeat=20, timer=time.process_time)) / 5000


def exchange(self, ec_id):
    self.cycles += 1
    self._out.write()
    if self._in.isNew():
        self._in.read()
    return RTC.RTC_OK


# CPU time, because other programs take some of the wall's.
def round_of(component, seconds):
    begin, count = time.process_time(), component.cycles
    time.sleep(seconds)
    return (time.process_time() - begin) / max(component.cycles - count, 1)


def measure(manager, name, execute, value, seconds=2.0):
    cls = type(name, (Bench,), {"onExecute": execute, "value": value})
    words = list(spec)
    words[1] = words[3] = name
    manager.registerFactory(OpenRTM_aist.Properties(defaults_str=words), cls, OpenRTM_aist.Delete)
    component = manager.createComponent(name)
    if value is not None:
        reference = component.getObjRef()
        CORBA_RTCUtil.connect_by_name("c", OpenRTM_aist.Properties(), reference, "in", reference, "out")
    component.activate(0)
    while component.cycles < 10:
        time.sleep(0.01)
    took = min(round_of(component, seconds / 8) for _ in range(8))
    component.deactivate(0)
    print("%-28s %8.2f us/cycle" % (name, took * 1e6), flush=True)
    return took


def imports():
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}

    def best(code):
        times = []
        for _ in range(5):
            begin = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
            subprocess.run([sys.executable, "-c", code], check=True, env=environment)
            times.append(resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - begin)
        return min(times)
    print("%-28s %8.1f ms above python3" % ("import OpenRTM_aist", (best("import OpenRTM_aist") - best("pass")) * 1e3))


def main():
    imports()
    manager = OpenRTM_aist.Manager.init(["bench", "-o", "naming.enable:NO", "-o", "manager.shutdown_auto:NO"])
    manager.activateManager()
    stamp = RTC.Time(0, 0)
    took = measure(manager, "Busy", busy, None)
    print("%-28s %8.2f us/cycle" % ("Empty", (took - own_time()) * 1e6), flush=True)
    measure(manager, "OneInOneOut", exchange, RTC.TimedLong(stamp, 1))
    measure(manager, "Doubles683", exchange, RTC.TimedDoubleSeq(stamp, [1.5] * 683))
    measure(manager, "Octets300k", exchange, RTC.TimedOctetSeq(stamp, bytes(300000)))
    manager.shutdown()


if __name__ == "__main__":
    main()
