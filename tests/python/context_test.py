# Execution contexts whose classes are written in Python.
import pytest

from component_test import program, says, seen, system, written  # noqa: F401: system is a fixture
from system import await_

body = """
    def onActivated(self, ec_id):
        print("activated", flush=True)
        self._count = 0
        return RTC.RTC_OK

    def onExecute(self, ec_id):
        self._count += 1
        if self._count == 5:
            print("five cycles", flush=True)
        return RTC.RTC_OK
"""
loop = """
class Own(OpenRTM_aist.PeriodicExecutionContext):
    def __init__(self):
        OpenRTM_aist.PeriodicExecutionContext.__init__(self)
        self.seen = []
    def onStarted(self):
        print("started", flush=True)
        return OpenRTM_aist.PeriodicExecutionContext.onStarted(self)
    def onWaitingActivated(self, comp, count):
        print("waiting", comp.isNextState(RTC.ACTIVE_STATE), comp.getRTObject() is not None, flush=True)
        return RTC.RTC_OK
    def onSettingRate(self, rate):
        return min(rate, 50)
    def svc(self):
        print("loop at %g" % self.getRate(), self.getKind(), self.getPeriod(), flush=True)
        while self.threadRunning():
            self.invokeWorkerPreDo()
            self.invokeWorkerDo()
            self.invokeWorkerPostDo()
            time.sleep(self.getPeriod().toDouble())
        print("loop ended", flush=True)
        return 0
"""
threaded = """
class Own(OpenRTM_aist.ExecutionContextBase, RTC__POA.ExecutionContextService, OpenRTM_aist.Task):
    def __init__(self):
        OpenRTM_aist.ExecutionContextBase.__init__(self, "own")
        OpenRTM_aist.Task.__init__(self)
        self.setObjRef(self._this())
        self.setKind(RTC.PERIODIC)
        self.goes = True
    def init(self, props):
        OpenRTM_aist.ExecutionContextBase.init(self, props)
        print("options", props.getProperty("rate"), flush=True)
    def onStarted(self):
        OpenRTM_aist.Task.activate(self)
        return RTC.RTC_OK
    def onStopping(self):
        self.goes = False
        self.wait()
        return RTC.RTC_OK
    def onWaitingActivated(self, comp, count):
        print("waiting", flush=True)
        return RTC.RTC_OK
    def svc(self):
        while self.goes:
            self.invokeWorker()
            time.sleep(0.01)
        print("loop ended", flush=True)
        return 0
"""
ticked = """
class Own(OpenRTM_aist.ExtTrigExecutionContext):
    def tick(self):
        print("tick", flush=True)
        OpenRTM_aist.ExtTrigExecutionContext.tick(self)
"""


def made(tmp_path, context):
    file = written(tmp_path, "Run", body, extra="import time\nimport RTC__POA\n" + context)
    text = (tmp_path / file).read_text().replace("    mgr.activateManager()", """    print("registered", mgr.registerECFactory("Own", Own, OpenRTM_aist.ECDelete),
        mgr.registerECFactory("Own", Own, OpenRTM_aist.ECDelete), flush=True)
    mgr.activateManager()""")
    (tmp_path / file).write_text(text)
    return file


@pytest.mark.parametrize("context", [loop, threaded], ids=["periodic", "of the author"])
def test_a_component_runs_in_a_context_whose_loop_is_python(system, tmp_path, context):  # noqa: F811
    process = program(system, made(tmp_path, context), "-o", "exec_cxt.periodic.type:Own", "-o", "exec_cxt.periodic.rate:200", folder=tmp_path)
    seen(system, "Run0")
    system.rtse("act", "Run0")
    log = says(system, process, "five cycles")
    assert "registered True False" in log and "waiting" in log
    if context is loop:
        assert "loop at 50 PERIODIC 0.020000" in log and "started" in log and "waiting True True" in log
    else:
        assert "options 200" in log
    system.rtse("deact", "Run0")
    await_("inactive", lambda: "nactive" in system.rtse("ls", "-l"))
    process.terminate()
    assert process.wait(60) == 0
    assert "loop ended" in system.log(process)


def test_a_context_of_python_hears_its_ticks(system, tmp_path):  # noqa: F811
    process = program(system, made(tmp_path, ticked), "-o", "exec_cxt.periodic.type:Own", folder=tmp_path)
    seen(system, "Run0")
    system.rtse("act", "Run0")
    says(system, process, "activated")
    from component_test import python
    tick = ("import sys, OpenRTM_aist, OpenRTM, RTC\nfrom omniORB import CORBA\n"
            "rtc = OpenRTM_aist.CorbaNaming(CORBA.ORB_init(), sys.argv[1]).resolve('Run0.rtc')._narrow(RTC.RTObject)\n"
            "context = rtc.get_owned_contexts()[0]._narrow(OpenRTM.ExtTrigExecutionContextService)\n"
            "for i in range(6): context.tick()")
    system.call(python, "-B", "-c", tick, system.names)
    log = says(system, process, "five cycles")
    assert log.count("tick") >= 5


@pytest.mark.parametrize("context, line", [
    ("class Own(OpenRTM_aist.PeriodicExecutionContext):\n    def __init__(self):\n        raise ValueError('no context today')\n", "ValueError: no context today"),
    ("class Own:\n    pass\n", "got the class Own"),
    ("class Own(OpenRTM_aist.PeriodicExecutionContext):\n    def __init__(self):\n        pass\n", "creating an execution context of type Own failed"),
    ("class Own(OpenRTM_aist.PeriodicExecutionContext):\n    def onStarting(self):\n        return None\n", "onStarting() of an execution context failed; it counts as RTC_ERROR: it returned None"),
    ("class Own(OpenRTM_aist.PeriodicExecutionContext):\n    def svc(self):\n        raise ValueError('the loop is broken')\n", "its components stand still"),
], ids=["init", "class", "base", "hook", "loop"])
def test_a_context_that_fails_is_one_clear_line(system, tmp_path, context, line):  # noqa: F811
    process = program(system, made(tmp_path, context), "-o", "exec_cxt.periodic.type:Own", folder=tmp_path)
    log = says(system, process, line)
    assert "Fatal" not in log
    process.terminate()
    assert process.wait(60) == 0


@pytest.mark.parametrize("end", ["return 0", "raise ValueError('over')"])
def test_a_component_rests_in_a_context_whose_loop_has_returned(system, tmp_path, end):  # noqa: F811
    context = f"""
class Own(OpenRTM_aist.PeriodicExecutionContext):
    def svc(self):
        while not Run.seen:
            self.invokeWorkerPreDo()
            self.invokeWorkerDo()
            time.sleep(0.001)
        {end}
"""
    file = made(tmp_path, context)
    text = (tmp_path / file).read_text().replace("    def onExecute", """    seen = False
    def onDeactivated(self, ec_id):
        print("deactivated", flush=True)
        return RTC.RTC_OK

    def onExecute""").replace('        if self._count == 5:', '        Run.seen = self._count == 5\n        if self._count == 5:')
    (tmp_path / file).write_text(text)
    process = program(system, file, "-o", "exec_cxt.periodic.type:Own", "-o", "exec_cxt.callback_timeout:3600", folder=tmp_path)
    seen(system, "Run0")
    system.rtse("act", "Run0")
    log = says(system, process, "its components stand still")
    assert "Own.svc() of an execution context" in log
    system.rtse("exit", "Run0")
    says(system, process, "deactivated")
    await_("the component has left", lambda: "Run0" not in system.rtse("ls"))


@pytest.mark.parametrize("wrong", ["None", "3", "'Own'", "int", "dict"])
def test_a_context_that_nobody_can_make_is_one_line(system, tmp_path, wrong):  # noqa: F811
    file = made(tmp_path, ticked)
    (tmp_path / file).write_text((tmp_path / file).read_text().replace('registerECFactory("Own", Own,', f'registerECFactory("Own", {wrong},'))
    process = program(system, file, folder=tmp_path)
    log = says(system, process, "registered False False")
    assert "registerECFactory('Own'): expected a class of an execution context or a function that makes one, got " in log
    process.terminate()
    assert process.wait(60) == 0
