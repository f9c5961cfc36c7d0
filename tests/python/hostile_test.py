# Components in Python that do what nobody expects: each ends in one clear line, and nobody else stands still without a name.
import pathlib
import re
import subprocess

import pytest

from component_test import bin_dir, lib_dir, program, python, says, seen, sources, system, written  # noqa: F401: system is a fixture
from system import await_

here = pathlib.Path(__file__).resolve().parent
worlds = here.parents[1] / "worlds"
port = """
    def onInitialize(self):
        self._d = RTC.%s
        self._out = OpenRTM_aist.OutPort("out", self._d)
        self.addOutPort("out", self._out)
        return RTC.RTC_OK
"""


def ends(process, system, code=0):  # noqa: F811
    process.terminate()
    assert process.wait(60) == code, system.log(process)


@pytest.mark.parametrize("value, line", [
    ("3", "expected RTC/TimedLong, got int 3, which has no member tm"),
    ("object()", "expected RTC/TimedLong, got object, which has no member tm"),
    ("RTC.TimedDouble(RTC.Time(0, 0), 1.5)", "data: expected long, got float 1.5"),
    ("RTC.TimedLong(None, 1)", "tm: expected RTC/Time, got NoneType, which has no member sec"),
    ("RTC.TimedLong(RTC.Time(0, 1 << 40), 1)", "tm.nsec: expected unsigned long, got int 1099511627776"),
    ("Liar()", "whose member tm raised RuntimeError: no attribute today"),
])
def test_a_value_of_another_type_is_false_and_one_line(system, tmp_path, value, line):  # noqa: F811
    file = written(tmp_path, "Odd", port % "TimedLong(RTC.Time(0, 0), 0)" + f"""
    def onExecute(self, ec_id):
        if not hasattr(self, "_said"):
            self._said = self._out.write({value})
            print("written", self._said, flush=True)
        return RTC.RTC_OK
""", extra="""
class Liar:
    @property
    def tm(self):
        raise RuntimeError("no attribute today")
""")
    process = program(system, file, folder=tmp_path)
    seen(system, "Odd0")
    system.rtse("act", "Odd0")
    log = says(system, process, "written False")
    assert line in says(system, process, "cannot be written to port Odd0.out"), log
    assert "Active" in system.rtse("ls", "-l") or "active" in system.rtse("ls", "-l")
    ends(process, system)


def test_large_and_odd_arrays_of_numpy_are_written_or_refused(system, tmp_path):  # noqa: F811
    pytest.importorskip("numpy")
    file = written(tmp_path, "Arrays", port % "TimedDoubleSeq(RTC.Time(0, 0), [])" + """
    def onActivated(self, ec_id):
        for name, array in (("large", numpy.zeros(20000000)), ("empty", numpy.zeros(0)), ("flat", numpy.zeros((100, 100))[:, 0]),
                            ("reversed", numpy.arange(1000.0)[::-1]), ("two", numpy.zeros((3, 3))), ("texts", numpy.array(["a", "b"])),
                            ("objects", numpy.array([1, None])), ("complex", numpy.zeros(3, complex)), ("integers", numpy.arange(5)),
                            ("swapped", numpy.arange(5, dtype=">f8")), ("nan", numpy.array([numpy.nan, numpy.inf])), ("number", numpy.float64(3))):
            self._d.data = array
            print(name, self._out.write(), flush=True)
        return RTC.RTC_OK
""", extra="import numpy")
    process = program(system, file, folder=tmp_path)
    seen(system, "Arrays0")
    reader = system.start(f"{bin_dir}/rtse", "--ns", system.names, "print", "Arrays0:out")
    system.rtse("act", "Arrays0")
    log = says(system, process, "number ")
    said = dict(line.split() for line in log.splitlines() if re.fullmatch(r"[a-z]+ (True|False)", line))
    assert [said[name] for name in ("two", "texts", "objects", "complex", "number")] == ["False"] * 5, said
    assert "data" in log and "expected" in log
    reader.terminate()
    reader.wait(60)
    ends(process, system)


def test_threads_that_write_while_the_process_ends_do_not_keep_it(system, tmp_path):  # noqa: F811
    file = written(tmp_path, "Writers", port % "TimedLongSeq(RTC.Time(0, 0), list(range(1000)))" + """
    def onActivated(self, ec_id):
        for _ in range(8):
            threading.Thread(target=self.write_for_ever).start()
        print("writing", flush=True)
        return RTC.RTC_OK

    def write_for_ever(self):
        while True:
            self._out.write()
""", extra="import threading")
    for _ in range(3):
        process = program(system, file, folder=tmp_path)
        seen(system, "Writers0")
        printer = program(system, "Printer.py")
        seen(system, "Printer0")
        system.rtse("act", "Writers0")
        says(system, process, "writing")
        process.terminate()
        assert process.wait(60) == 0
        assert "terminate called" not in system.log(process) and "Fatal Python" not in system.log(process)
        ends(printer, system)
        await_("no names", lambda: "0" not in system.rtse("ls"))


def test_listeners_that_raise_are_logged_and_samples_go_on(system, tmp_path):  # noqa: F811
    file = written(tmp_path, "Raiser", port % "TimedLong(RTC.Time(0, 0), 0)" + """
    def onActivated(self, ec_id):
        class Data(OpenRTM_aist.ConnectorDataListenerT):
            def __call__(self, info, data):
                raise KeyError("data listener")
        class Event(OpenRTM_aist.ConnectorListener):
            def __call__(self, info):
                sys.exit(3)
        for one in range(10):
            self._out.addConnectorDataListener(one, Data())
        self._out.addConnectorListener(OpenRTM_aist.ConnectorListenerType.ON_DISCONNECT, Event())
        self.addPreComponentActionListener(OpenRTM_aist.PreComponentActionListenerType.PRE_ON_EXECUTE, lambda ec: 1 / 0)
        return RTC.RTC_OK

    def onExecute(self, ec_id):
        self._d.data += 1
        self._out.write()
        return RTC.RTC_OK
""")
    process, printer = program(system, file, folder=tmp_path), program(system, "Printer.py")
    seen(system, "Raiser0")
    seen(system, "Printer0")
    system.rtse("con", "Raiser0:out", "Printer0:number")
    system.rtse("act", "Raiser0", "Printer0")
    await_("samples", lambda: system.log(printer).count("received ") >= 5)
    log = says(system, process, "ZeroDivisionError")
    assert "KeyError: 'data listener'" in log
    assert log.count("raised: ZeroDivisionError") == 1
    assert "Raiser0: a PreComponentActionListener raised: ZeroDivisionError" in log
    system.rtse("dis", "Raiser0:out", "Printer0:number")
    says(system, process, "SystemExit: 3")
    assert process.poll() is None
    ends(process, system)


def test_a_module_that_reloads_itself_and_its_package_goes_on(system, tmp_path):  # noqa: F811
    file = written(tmp_path, "Again", port % "TimedLong(RTC.Time(0, 0), 0)" + """
    def onExecute(self, ec_id):
        if self._d.data < 3:
            importlib.reload(RTC)
            importlib.reload(OpenRTM_aist)
            self._d.data += 1
            print("reloaded", self._d.data, self._out.write(RTC.TimedLong(RTC.Time(0, 0), self._d.data)), flush=True)
        return RTC.RTC_OK
""", extra="import importlib")
    process = program(system, file, folder=tmp_path)
    printer = program(system, "Printer.py")
    seen(system, "Again0")
    seen(system, "Printer0")
    system.rtse("con", "Again0:out", "Printer0:number")
    system.rtse("act", "Again0", "Printer0")
    says(system, process, "reloaded 3 True")
    ends(process, system)


@pytest.mark.parametrize("statement, line", [
    ("sys.exit(0)", "SystemExit: 0"), ("raise KeyboardInterrupt", "KeyboardInterrupt"), ("raise GeneratorExit", "GeneratorExit"),
    ("def f(): f()\n        f()", "RecursionError"), ("raise RTC_ERROR", "NameError"), ("raise Odd()", "Odd"),
    ("del self._out\n        self._out.write()", "AttributeError"),
])
def test_what_a_callback_raises_is_the_error_state_whatever_it_is(system, tmp_path, statement, line):  # noqa: F811
    file = written(tmp_path, "Exits", port % "TimedLong(RTC.Time(0, 0), 0)" + f"""
    def onExecute(self, ec_id):
        {statement}
        return RTC.RTC_OK
""", extra="class Odd(BaseException):\n    def __str__(self):\n        raise ValueError('no text')\n")
    process = program(system, file, folder=tmp_path)
    seen(system, "Exits0")
    system.try_rtse("act", "Exits0")
    says(system, process, line)
    await_("error state", lambda: "rror" in system.rtse("ls", "-l"))
    assert process.poll() is None
    ends(process, system)


@pytest.mark.parametrize("child", ["os._exit(0)", "self._out.write(); os._exit(0)", "return RTC.RTC_OK", "sys.exit(0)",
                                   "OpenRTM_aist.Manager.instance().shutdown(); os._exit(0)"])
def test_a_child_that_a_callback_forks_does_not_take_the_component_along(system, tmp_path, child):  # noqa: F811
    file = written(tmp_path, "Forker", port % "TimedLong(RTC.Time(0, 0), 0)" + f"""
    def onActivated(self, ec_id):
        self._count = 0
        self._child = os.fork()
        if self._child == 0:
            signal.alarm(20)
            {child}
        print("forked", self._child, flush=True)
        return RTC.RTC_OK

    def onExecute(self, ec_id):
        self._count += 1
        if self._count == 20:
            print("goes on", flush=True)
        return RTC.RTC_OK
""", extra="import os, signal")
    process = program(system, file, folder=tmp_path)
    seen(system, "Forker0")
    system.try_rtse("act", "Forker0")
    says(system, process, "goes on")
    assert "Forker0" in system.rtse("ls")
    ends(process, system)


def test_objects_that_outlive_their_component_say_so(system, tmp_path):  # noqa: F811
    file = written(tmp_path, "Leaver", port % "TimedLong(RTC.Time(0, 0), 0)")
    text = (tmp_path / file).read_text().replace("    mgr.runManager()", """    import time
    component = mgr.getComponent("Leaver0")
    out, reference, configuration = component._out, component.getObjRef(), component.getConfigService()
    mgr.deleteComponent("Leaver0")
    while mgr.getComponents():
        time.sleep(0.01)
    for what, call in (("write", out.write), ("profile", out.getProfile), ("name", component.getInstanceName), ("ports", reference.get_ports),
                       ("sets", configuration.getConfigurationSets), ("add", lambda: component.addOutPort("out", out)), ("rate", lambda: component.getExecutionRate(0)),
                       ("exit", component.exit), ("manager", lambda: mgr.createComponent("Leaver").getInstanceName()), ("unknown", lambda: mgr.createComponent("Nobody")),
                       ("delete", lambda: mgr.deleteComponent("Nobody0")), ("none", lambda: mgr.createComponent(None))):
        try:
            print(what, call(), flush=True)
        except Exception as problem:
            print(what, type(problem).__name__, flush=True)
    print("through", flush=True)
    mgr.shutdown()
    for what, call in (("again", lambda: mgr.createComponent("Leaver")), ("shutdown", mgr.shutdown), ("components", mgr.getComponents), ("orb", lambda: mgr.getORB().object_to_string(reference)[:3]),
                       ("run", mgr.runManager), ("init", lambda: OpenRTM_aist.Manager.init([]))):
        try:
            print(what, call(), flush=True)
        except Exception as problem:
            print(what, type(problem).__name__, flush=True)
    print("end", flush=True)""")
    (tmp_path / file).write_text(text)
    process = program(system, file, "-o", "manager.shutdown_on_nortcs:NO", folder=tmp_path)
    assert process.wait(90) == 0, system.log(process)
    log = system.log(process)
    assert "through" in log and "end" in log.splitlines(), log
    assert "manager Leaver" in log and "unknown None" in log and "write False" in log


def hostile_run(tmp_path, statement, seconds=1, extra="import os, threading, signal"):
    import rtmsim
    written(tmp_path, "Hostile", f"""
    def onInitialize(self):
        self._in = OpenRTM_aist.InPort("range", OpenRTM_aist.instantiateDataType(RTC.RangeData))
        self.addInPort("range", self._in)
        self._out = OpenRTM_aist.OutPort("velocity", OpenRTM_aist.instantiateDataType(RTC.TimedVelocity2D))
        self.addOutPort("velocity", self._out)
        return RTC.RTC_OK

    def onExecute(self, ec_id):
        {statement}
        return RTC.RTC_OK
""", extra=extra)
    text = (worlds / "systems" / "obstacle_avoidance.xml").read_text()
    start = text.index("<rts:ConfigurationSets", text.index(":LaserObstacleAvoid:"))
    end = text.index("</rts:ConfigurationSets>", start) + len("</rts:ConfigurationSets>")
    profile = tmp_path / "hostile.xml"
    profile.write_text((text[:start] + text[end:]).replace("LaserObstacleAvoid", "Hostile"))
    return rtmsim.run(str(profile), str(worlds / "obstacle_course.sdf"), duration=seconds,
                      options=["--module-path", str(tmp_path), "--module-path", lib_dir])


@pytest.mark.parametrize("statement", ["os.kill(os.getpid(), signal.SIGSEGV)", "os.kill(os.getpid(), signal.SIGSTOP)",
                                       "OpenRTM_aist.Manager.instance().shutdown()", "self.exit()", "threading.Lock().acquire() and self._l.acquire()",
                                       "import ctypes; ctypes.string_at(0)"])
def test_a_run_names_the_component_that_dies_leaves_or_stands(tmp_path, statement):
    result = hostile_run(tmp_path, statement)
    assert not result.passed
    assert "Hostile0" in result.why


@pytest.mark.parametrize("statement", ["os.fork() or os._exit(0)", "self._out.write(3)", "threading.Thread(target=self._out.write, args=(None,)).start()",
                                       "print('x' * 100000)"])
def test_a_run_with_odd_but_harmless_components_ends_in_time(tmp_path, statement):
    result = hostile_run(tmp_path, statement)
    assert result.passed, result.why


def test_tools_read_the_ports_of_a_component_whose_callback_keeps_the_interpreter(system, tmp_path):  # noqa: F811
    file = written(tmp_path, "Hog", port % "TimedLong(RTC.Time(0, 0), 0)" + """
    def onExecute(self, ec_id):
        print("matching", flush=True)
        re.match("(a+)+$", "a" * 60 + "b")
        return RTC.RTC_OK
""", extra="import re")
    process = program(system, file, folder=tmp_path)
    seen(system, "Hog0")
    system.rtse("act", "Hog0")
    says(system, process, "matching")
    assert "out" in system.rtse("cat", "Hog0")
    ends(process, system, 1)
    assert "Hog0: onExecute has not returned for" in system.log(process)
    assert "it got as far as: naming" in system.log(process)


def test_a_component_that_closes_all_descriptors_is_ended_by_a_signal(system, tmp_path):  # noqa: F811
    file = written(tmp_path, "Closer", """
    def onActivated(self, ec_id):
        print("closing", flush=True)
        os.closerange(3, 65536)
        return RTC.RTC_OK
""", extra="import os")
    process = program(system, file, folder=tmp_path)
    seen(system, "Closer0")
    # The answer may be lost with its connection.
    subprocess.run([f"{bin_dir}/rtse", "--ns", system.names, "act", "Closer0"], timeout=60, capture_output=True)
    says(system, process, "closing")
    process.terminate()
    process.wait(60)


def test_bad_values_that_differ_are_logged_a_few_at_once(system, tmp_path):  # noqa: F811
    file = written(tmp_path, "Many", port % "TimedLong(RTC.Time(0, 0), 0)" + """
    def onActivated(self, ec_id):
        for number in range(3000):
            self._d.data = float(number)
            self._out.write()
        time.sleep(1.1)
        self._d.data = "last"
        print("written", self._out.write(), flush=True)
        return RTC.RTC_OK
""", extra="import time")
    process = program(system, file, folder=tmp_path)
    seen(system, "Many0")
    system.rtse("act", "Many0")
    log = says(system, process, "written False")
    lines = [line for line in log.splitlines() if "cannot be written to port Many0.out" in line]
    assert "data: expected long, got float 0.0" in lines[0] and 8 < len(lines) < 100, lines
    assert "other lines before this one are not in the log) a RTC/TimedLong" in lines[-1] and "got str 'last'" in lines[-1]
    ends(process, system)


def test_what_on_error_raises_in_each_cycle_is_logged_once(system, tmp_path):  # noqa: F811
    file = written(tmp_path, "Erring", """
    def onActivated(self, ec_id):
        self._cycles = 0
        return RTC.RTC_OK

    def onExecute(self, ec_id):
        raise ValueError("in onExecute")

    def onError(self, ec_id):
        self._cycles += 1
        if self._cycles == 20:
            print("cycles", self._cycles, flush=True)
        raise ValueError("in onError")
""")
    process = program(system, file, folder=tmp_path)
    seen(system, "Erring0")
    for count in (1, 2):
        system.try_rtse("act", "Erring0")
        await_("cycles", lambda: system.log(process).count("cycles 20") == count)
        log = system.log(process)
        assert log.count("onError threw: ValueError: in onError") == log.count("onExecute threw: ValueError: in onExecute") == count
        system.rtse("reset", "Erring0")
    ends(process, system)
